#include "halflight/scene/procedural/furnace.h"

#include "halflight/scene/procedural/assembly.h"
#include "halflight/scene/procedural/random.h"

namespace halflight {
namespace {

// One cube in the middle of each cell of a regular grid, so that none meets another.
void add_cubes(Scene& scene, const FurnaceParameters& p, MaterialId glowing) {
  const int cells = static_cast<int>(std::ceil(std::cbrt(static_cast<double>(p.boxes))));
  const float pitch = p.side / static_cast<float>(cells);
  // Half the diagonal of a turned cube, edge / sqrt(2), stays within the cell.
  const float edge = 0.45f * pitch;
  MeshParts parts;
  append_box(parts[glowing], {Vec3(-0.5f * edge), Vec3(0.5f * edge)});
  const MeshId cube = add_mesh(scene, "cube", std::move(parts));
  Random random(hash(static_cast<std::uint64_t>(p.seed), 0));
  for (int i = 0; i < p.boxes; ++i) {
    const int column = i % cells, row = i / cells % cells, layer = i / (cells * cells);
    const Vec3 cell(static_cast<float>(column), static_cast<float>(row), static_cast<float>(layer));
    const Vec3 center = (cell + 0.5f) * pitch - Vec3(0.5f * p.side, 0.f, 0.5f * p.side);
    add_node(scene, "cube " + std::to_string(i + 1), cube, placed_at(center, random.angle()));
  }
}

}  // namespace

Knobs knobs(FurnaceParameters& p) {
  return {{"radiance", "radiance L of every surface, W/(m2 sr)", &p.radiance, 0, 1e6},
          {"reflectance", "reflectance of every surface", &p.reflectance, 0, 0.99},
          {"boxes", "cubes that float in the box", &p.boxes, 0, 1e6},
          {"side", "inner side of the box, metres", &p.side, 0.01, 1e4},
          {"seed", "how the cubes are turned", &p.seed, 0, 1e9}};
}

Scene furnace_scene(const FurnaceParameters& p) {
  Scene scene;
  const MaterialId glowing = add_emitter(scene, "furnace", Rgb(p.radiance), Rgb(p.reflectance));
  const float half = 0.5f * p.side;
  add_room(scene, {{-half, 0.f, -half}, {half, p.side, half}}, {glowing, glowing, glowing});
  if (p.boxes > 0) add_cubes(scene, p, glowing);
  add_camera(scene, "corner", {-0.9f * half, 0.9f * p.side, -0.9f * half}, {0.f, half, 0.f}, 1.2f);
  return scene;
}

}  // namespace halflight
