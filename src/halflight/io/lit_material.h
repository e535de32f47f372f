// How a lit surface is shown by an unlit material: shown = base colour factor x texture x COLOR_0.
#pragma once

#include <nlohmann/json.hpp>

#include "halflight/io/gltf_parts.h"
#include "halflight/scene/scene.h"

namespace halflight {

// COLOR_0 = clamp(exposure (irradiance_weight E / pi + emission)), by channel.
struct LitMaterial {
  nlohmann::json json;
  Rgb irradiance_weight{1.f};
  Rgb emission{0.f};
};

// `emits` is false for the dark back of a one-sided emitter.
LitMaterial lit_material(const Material& material, bool emits, float exposure,
                         TextureWriter& textures);

}  // namespace halflight
