#include "halflight/scene/procedural/office_palette.h"

#include "halflight/scene/procedural/assembly.h"

namespace halflight {

OfficePalette add_office_palette(Scene& scene) {
  OfficePalette p;
  p.wood = add_material(scene, "birch", {0.66f, 0.5f, 0.32f});
  p.dark_wood = add_material(scene, "walnut", {0.3f, 0.17f, 0.09f});
  p.steel = add_material(scene, "steel", Rgb(0.5f));
  p.black_plastic = add_material(scene, "black plastic", Rgb(0.05f));
  p.white_plastic = add_material(scene, "white plastic", Rgb(0.72f));
  p.fabric = add_material(scene, "blue fabric", {0.08f, 0.17f, 0.3f});
  p.divider = add_material(scene, "divider felt", {0.3f, 0.42f, 0.38f});
  p.ceramic = add_material(scene, "ceramic", {0.7f, 0.3f, 0.2f});
  p.whiteboard = add_material(scene, "whiteboard", Rgb(0.82f));
  p.lamp_shade = add_material(scene, "lamp shade", {0.65f, 0.12f, 0.08f});
  p.tube = add_emitter(scene, "tube light", {22.f, 21.f, 19.f}, Rgb(0.6f));
  p.lamp = add_emitter(scene, "lamp bulb", {130.f, 95.f, 58.f}, Rgb(0.6f));
  p.screen = add_emitter(scene, "screen", {1.6f, 1.9f, 2.3f}, Rgb(0.05f));
  p.daylight = add_emitter(scene, "daylight", {6.f, 7.4f, 9.4f}, Rgb(0.1f));
  return p;
}

}  // namespace halflight
