#include "halflight/scene/procedural/potted_plant.h"

#include <vector>

#include "halflight/scene/procedural/assembly.h"
#include "halflight/scene/procedural/random.h"

namespace halflight {
namespace {

constexpr int kStems = 9;
constexpr int kStemPieces = 4;
constexpr float kTuft = 0.09f;  // leaves stand within this distance of their stem, metres

struct Stem {
  Vec3 foot, reach;  // reach: from the foot to the tip

  // Rises first and leans out later.
  Vec3 at(float t) const { return foot + Vec3(t * t * reach.x, t * reach.y, t * t * reach.z); }
};

std::vector<Stem> grow_stems(const PlantShape& shape, Random& random) {
  std::vector<Stem> stems;
  for (int i = 0; i < kStems; ++i) {
    const float phi = 2.f * kPi * (static_cast<float>(i) + random.uniform()) / kStems;
    const Vec3 outwards(std::cos(phi), 0.f, std::sin(phi));
    const float rise = (shape.height - shape.pot_height - kTuft) * random.uniform(0.6f, 1.f);
    const Vec3 foot = 0.03f * outwards + Vec3(0.f, 0.9f * shape.pot_height, 0.f);
    stems.push_back(
        {foot, shape.spread * random.uniform(0.3f, 1.f) * outwards + Vec3(0.f, rise, 0.f)});
  }
  return stems;
}

// A leaf folded along its middle rib, from its stalk at `from` along `along` (unit).
void append_leaf(Primitive& to, const Vec3& from, const Vec3& along, float length, float turn) {
  const Frame frame = Frame::from_normal(along);
  const Vec3 across = std::cos(turn) * frame.tangent + std::sin(turn) * frame.bitangent;
  const Vec3 up = glm::cross(across, along);
  const Vec3 middle = from + 0.45f * length * along + 0.06f * length * up;
  const Vec3 tip = from + length * along;
  append_triangle(to, from, tip, middle + 0.26f * length * across);
  append_triangle(to, from, middle - 0.26f * length * across, tip);
}

}  // namespace

PlantMaterials add_plant_materials(Scene& scene) {
  PlantMaterials materials;
  materials.pot = add_material(scene, "terracotta", {0.52f, 0.24f, 0.14f});
  materials.soil = add_material(scene, "soil", {0.08f, 0.06f, 0.045f});
  materials.stem = add_material(scene, "stem", {0.2f, 0.22f, 0.08f});
  materials.young_leaf = add_sheet_material(scene, "young leaf", {0.2f, 0.42f, 0.08f});
  materials.old_leaf = add_sheet_material(scene, "old leaf", {0.07f, 0.25f, 0.06f});
  return materials;
}

MeshId add_plant(Scene& scene, const PlantMaterials& materials, const PlantShape& shape,
                 std::uint64_t seed) {
  Random random(hash(seed, 0));
  MeshParts parts;
  const float radius = 0.5f * shape.pot_height;
  append_vessel(parts[materials.pot], Vec3(0.f), {0.7f * radius, radius, shape.pot_height, 0.01f},
                16);
  const float soil = 0.9f * shape.pot_height;
  const std::array<Vec2, 2> surface{Vec2(0.93f * radius, 0.f), {0.f, 0.f}};
  append_revolution(parts[materials.soil], {0.f, soil, 0.f}, {0.f, 1.f, 0.f}, surface, 16);

  const std::vector<Stem> stems = grow_stems(shape, random);
  for (const Stem& stem : stems) {
    for (int i = 0; i < kStemPieces; ++i) {
      const float t = static_cast<float>(i) / kStemPieces;
      append_rod(parts[materials.stem], stem.at(t), stem.at(t + 1.f / kStemPieces), 0.004f, 5);
    }
  }
  for (int i = 0; i < shape.leaves; ++i) {
    const Stem& stem = stems[random.below(kStems)];
    const float t = std::sqrt(random.uniform(0.05f, 1.f));
    const Vec3 away = random.direction();
    const Vec3 from = stem.at(t) + kTuft * std::cbrt(random.uniform()) * away;
    const Vec3 along = glm::normalize(away + 0.6f * random.direction() + Vec3(0.f, 0.3f, 0.f));
    const MaterialId material = random.uniform() < t ? materials.young_leaf : materials.old_leaf;
    append_leaf(parts[material], from, along, random.uniform(0.01f, 0.04f), random.angle());
  }
  return add_mesh(scene, "potted plant", std::move(parts));
}

}  // namespace halflight
