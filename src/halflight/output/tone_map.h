// From radiance to what a display shows: exposure and tone mapping.
#pragma once

#include "halflight/base/image.h"
#include "halflight/base/vec.h"

namespace halflight {

enum class ToneMap {
  none,     // clamped
  filmic,   // fit of the ACES curve, channel by channel: Narkowicz 2015
  agx,      // AgX, base look: Sobotka 2022
  neutral,  // Khronos PBR Neutral 2024: keeps base colours, compresses highlights only
};

// Linear light in [0, 1] from exposed radiance (1 is display white before mapping).
Rgb tone_mapped(ToneMap map, const Rgb& exposed);

// Every pixel times 2^ev, then mapped.
Image developed(const Image& radiance, float ev, ToneMap map);

// EV that brings the log-average luminance to 0.18 (Reinhard et al. 2002). Black pixels are left
// out; 0 when all are.
float automatic_ev(const Image& radiance);

}  // namespace halflight
