#include "halflight/scene/procedural/cube_groups.h"

#include "halflight/scene/procedural/assembly.h"
#include "halflight/scene/procedural/random.h"

namespace halflight {
namespace {

constexpr float kUnit = 0.01f;  // metres in one unit of the report's scene
constexpr std::array kShadowWidths{11.f, 16.5f, 22.f, 31.f};
constexpr float kWall = 200.f, kField = 160.f;
constexpr float kSlabLow = 30.f, kSlabHigh = 80.f, kSlabMiddle = 55.f;
constexpr int kMostTries = 200000;

// Corners nearest the origin of cubes of edge a, in units, centred on x = y = 0.
std::vector<Vec3> scatter_cubes(float a, Random& random) {
  const int wanted = static_cast<int>(std::lround(0.8f * kField * kField / (a * a)));
  const Bounds3f corners{{-0.5f * kField, -0.5f * kField, kSlabLow},
                         {0.5f * kField - a, 0.5f * kField - a, kSlabHigh - a}};
  std::vector<Vec3> cubes;
  for (int tries = 0; tries < kMostTries && static_cast<int>(cubes.size()) < wanted; ++tries) {
    const Vec3 at = random.point_in(corners);
    const bool apart = std::all_of(cubes.begin(), cubes.end(), [&](const Vec3& other) {
      return max_component(glm::abs(at - other)) > a;
    });
    if (apart) cubes.push_back(at);
  }
  return cubes;
}

MeshId add_unit_cube(Scene& scene, MaterialId material) {
  MeshParts parts;
  append_box(parts[material], {Vec3(0.f), Vec3(1.f)});
  return add_mesh(scene, "cube", std::move(parts));
}

void add_cube_group(Scene& scene, int group, float center_x, float light_distance, MeshId cube,
                    int seed) {
  const float edge = kShadowWidths[group - 1] * (light_distance - kSlabMiddle) / light_distance;
  Random random(hash(static_cast<std::uint64_t>(seed), group));
  const std::string name = "group " + std::to_string(group);
  const NodeId parent = add_group(scene, name);
  for (const Vec3& corner : scatter_cubes(edge, random)) {
    const Vec3 at = kUnit * (corner + Vec3(center_x, 0.f, 0.f));
    add_node(scene, name + " cube", cube, placed_at(at, 0.f, Vec3(kUnit * edge)), parent);
  }
}

// A rectangle centred on the z axis that faces along it, forwards or backwards.
void add_rectangle(Scene& scene, const std::string& name, MaterialId material, Vec2 size, float z,
                   bool forwards) {
  const Vec3 half = 0.5f * kUnit * Vec3(size, 0.f), at(0.f, 0.f, kUnit * z);
  MeshParts parts;
  append_quad(parts[material],
              side_of({at - half, at + half}, forwards ? Side::z_high : Side::z_low));
  add_node(scene, name, add_mesh(scene, name, std::move(parts)));
}

}  // namespace

Knobs knobs(CubeGroupsParameters& p) {
  return {{"group", "1 to 4 for one group, 0 for all side by side", &p.group, 0, 4},
          {"reflectance", "reflectance of the cubes", &p.reflectance, 0, 0.99},
          {"seed", "where the cubes are", &p.seed, 0, 1e9}};
}

Scene cube_groups_scene(const CubeGroupsParameters& p) {
  Scene scene;
  const bool all = p.group == 0;
  const float width = all ? 4.f * kWall : kWall;
  const float light_distance = all ? 600.f : 300.f;
  const MaterialId wall = add_material(scene, "wall", Rgb(0.7f));
  const MaterialId cubes = add_material(scene, "cubes", Rgb(p.reflectance));
  const MaterialId light = add_emitter(scene, "light", Rgb(1e4f), Rgb(0.f));
  add_rectangle(scene, "wall", wall, {width, kWall}, 0.f, true);
  add_rectangle(scene, "light", light, {4.f, 4.f}, light_distance, false);
  const MeshId cube = add_unit_cube(scene, cubes);
  for (int group = 1; group <= 4; ++group) {
    const float center = all ? kWall * (static_cast<float>(group) - 2.5f) : 0.f;
    if (all || group == p.group) add_cube_group(scene, group, center, light_distance, cube, p.seed);
  }
  const Vec3 side = kUnit * Vec3(0.7f * width, 0.f, 1.f * width);
  add_camera(scene, "side", side, Vec3(0.f), 0.6f);
  // Between cubes and light, as far as the wall fills the picture's height at 45 degrees.
  add_camera(scene, "front", kUnit * Vec3(0.f, 0.f, 241.f), Vec3(0.f), 0.25f * kPi);
  return scene;
}

}  // namespace halflight
