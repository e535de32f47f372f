#include "halflight/scene/procedural/cornell_box.h"

#include "halflight/scene/procedural/assembly.h"

namespace halflight {
namespace {

using Quad = std::array<Vec3, 4>;  // millimetres

// Corners in the order of the measured data; red is x = 556, green x = 0, the camera is at -z.
constexpr Quad kFloor{
    {{552.8f, 0.f, 0.f}, {0.f, 0.f, 0.f}, {0.f, 0.f, 559.2f}, {549.6f, 0.f, 559.2f}}};
constexpr Quad kBackWall{
    {{549.6f, 0.f, 559.2f}, {0.f, 0.f, 559.2f}, {0.f, 548.8f, 559.2f}, {556.f, 548.8f, 559.2f}}};
constexpr Quad kGreenWall{
    {{0.f, 0.f, 559.2f}, {0.f, 0.f, 0.f}, {0.f, 548.8f, 0.f}, {0.f, 548.8f, 559.2f}}};
constexpr Quad kRedWall{
    {{552.8f, 0.f, 0.f}, {549.6f, 0.f, 559.2f}, {556.f, 548.8f, 559.2f}, {556.f, 548.8f, 0.f}}};
constexpr Quad kCeiling{
    {{556.f, 548.8f, 0.f}, {556.f, 548.8f, 559.2f}, {0.f, 548.8f, 559.2f}, {0.f, 548.8f, 0.f}}};
constexpr Quad kLamp{{{343.f, 548.8f, 227.f},
                      {343.f, 548.8f, 332.f},
                      {213.f, 548.8f, 332.f},
                      {213.f, 548.8f, 227.f}}};
constexpr Quad kShortBlockTop{
    {{130.f, 165.f, 65.f}, {82.f, 165.f, 225.f}, {240.f, 165.f, 272.f}, {290.f, 165.f, 114.f}}};
constexpr Quad kTallBlockTop{
    {{423.f, 330.f, 247.f}, {265.f, 330.f, 296.f}, {314.f, 330.f, 456.f}, {472.f, 330.f, 406.f}}};

void append_millimetres(Primitive& to, Quad quad) {
  for (Vec3& corner : quad) corner *= 0.001f;
  append_quad(to, quad);
}

// The ceiling around the lamp's hole: one quad along each edge.
Primitive ceiling() {
  Primitive around;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4;
    append_millimetres(around, {kCeiling[i], kCeiling[next], kLamp[next], kLamp[i]});
  }
  return around;
}

// Top and sides of a block that stands on the floor.
Primitive block(const Quad& top) {
  Primitive sides;
  append_millimetres(sides, top);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 a = top[i], b = top[(i + 1) % 4];
    append_millimetres(sides, {a, {a.x, 0.f, a.z}, {b.x, 0.f, b.z}, b});
  }
  return sides;
}

void add_part(Scene& scene, const std::string& name, MaterialId material, Primitive primitive) {
  MeshParts parts;
  parts[material] = std::move(primitive);
  add_node(scene, name, add_mesh(scene, name, std::move(parts)));
}

Primitive single(const Quad& quad) {
  Primitive primitive;
  append_millimetres(primitive, quad);
  return primitive;
}

}  // namespace

Knobs knobs(CornellBoxParameters& p) {
  return {{"light", "factor on the lamp's radiance", &p.light, 0, 1e6}};
}

Scene cornell_box_scene(const CornellBoxParameters& p) {
  Scene scene;
  const Rgb white_paint(0.725f, 0.71f, 0.68f);
  const MaterialId white = add_material(scene, "white", white_paint);
  const MaterialId red = add_material(scene, "red", {0.63f, 0.065f, 0.05f});
  const MaterialId green = add_material(scene, "green", {0.14f, 0.45f, 0.091f});
  const MaterialId lamp = add_emitter(scene, "lamp", p.light * Rgb(17.f, 12.f, 4.f), white_paint);
  add_part(scene, "floor", white, single(kFloor));
  add_part(scene, "ceiling", white, ceiling());
  add_part(scene, "back wall", white, single(kBackWall));
  add_part(scene, "green wall", green, single(kGreenWall));
  add_part(scene, "red wall", red, single(kRedWall));
  add_part(scene, "short block", white, block(kShortBlockTop));
  add_part(scene, "tall block", white, block(kTallBlockTop));
  add_part(scene, "lamp", lamp, single(kLamp));
  // Focal length 35 mm, film 25 x 25 mm.
  add_camera(scene, "front", {0.278f, 0.273f, -0.8f}, {0.278f, 0.273f, 0.f},
             2.f * std::atan(12.5f / 35.f));
  return scene;
}

}  // namespace halflight
