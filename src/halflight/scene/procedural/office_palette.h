// The paints, woods and plastics of the office.
#pragma once

#include "halflight/scene/scene.h"

namespace halflight {

struct OfficePalette {
  MaterialId wood, dark_wood, steel, black_plastic, white_plastic, fabric, divider, ceramic;
  MaterialId whiteboard, lamp_shade, tube, lamp, screen, daylight;  // the last four emit
};
OfficePalette add_office_palette(Scene& scene);

}  // namespace halflight
