// The Cornell box as measured by the Cornell University Program of Computer Graphics (1998 data):
// geometry in millimetres from its page, here in metres. The box is open towards the camera. The
// measured spectra of the paints and the lamp are given as RGB the way the McGuire archive's
// CornellBox-Original does: white .725 .71 .68, red .63 .065 .05, green .14 .45 .091, lamp radiance
// 17 12 4 W/(m2 sr) over 130 x 105 mm.
#pragma once

#include "halflight/scene/procedural/knob.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct CornellBoxParameters {
  float light = 1.f;  // factor on the lamp's radiance
};

Knobs knobs(CornellBoxParameters& p);
Scene cornell_box_scene(const CornellBoxParameters& p = {});

}  // namespace halflight
