#include "halflight/scene/procedural/plants.h"

#include "halflight/scene/procedural/assembly.h"
#include "halflight/scene/procedural/potted_plant.h"
#include "halflight/scene/procedural/small_objects.h"

namespace halflight {
namespace {

constexpr Bounds3f kRoom{{-5.f, 0.f, -5.f}, {5.f, 3.f, 5.f}};
constexpr float kMargin = 0.7f;           // between walls and the outermost plants
constexpr int kTrianglesPerPlant = 4000;  // aimed at until the floor is full
constexpr int kMostPlants = 18 * 18;
constexpr int kVariants = 8;  // different plants; the rest are instances of these
constexpr int kBookTriangles = 50;
constexpr int kFixedPlantTriangles = 864;  // pot, soil, stems
constexpr float kBookShare = 0.1f;         // of the triangles

struct Census {
  int plants = 1;
  int leaves_per_plant = 0;
  int books = 0;
};
Census take_census(int triangles) {
  Census census;
  census.plants = std::clamp(triangles / kTrianglesPerPlant, 1, kMostPlants);
  census.books = static_cast<int>(kBookShare * static_cast<float>(triangles)) / kBookTriangles;
  const int left = triangles - census.books * kBookTriangles;
  census.leaves_per_plant = std::max(0, (left / census.plants - kFixedPlantTriangles) / 2);
  return census;
}

// Cells of a square grid over the floor; every plant and its books have one.
struct Cells {
  int across;
  float pitch;
  explicit Cells(int n)
      : across(static_cast<int>(std::ceil(std::sqrt(static_cast<double>(n))))),
        pitch((kRoom.extent().x - 2.f * kMargin) / static_cast<float>(across)) {}
  Vec3 center(int i) const {
    const int column = i % across, row = i / across;
    const Vec3 cell(static_cast<float>(column) + 0.5f, 0.f, static_cast<float>(row) + 0.5f);
    return kRoom.lower + Vec3(kMargin, 0.f, kMargin) + pitch * cell;
  }
};

void add_plants(Scene& scene, const Census& census, std::uint64_t seed) {
  const PlantMaterials materials = add_plant_materials(scene);
  Random random(hash(seed, 1));
  std::vector<MeshId> variants;
  for (int i = 0; i < std::min(kVariants, census.plants); ++i) {
    PlantShape shape;
    shape.leaves = census.leaves_per_plant;
    shape.height = random.uniform(0.9f, 1.5f);
    shape.spread = random.uniform(0.2f, 0.34f);
    variants.push_back(add_plant(scene, materials, shape, hash(seed, 2, i)));
  }
  const Cells cells(census.plants);
  for (int i = 0; i < census.plants; ++i) {
    const float play = std::max(0.f, 0.5f * cells.pitch - 0.35f);
    const Vec3 off(random.uniform(-play, play), kContactGap, random.uniform(-play, play));
    const MeshId mesh = variants[static_cast<std::size_t>(i) % variants.size()];
    add_node(scene, "plant " + std::to_string(i + 1), mesh,
             placed_at(cells.center(i) + off, random.angle()));
  }
}

// Stacks at the corners between cells, as high as needed.
void add_stacks(Scene& scene, const Census& census, std::uint64_t seed) {
  const std::vector<MeshId> books = add_books(scene);
  Random random(hash(seed, 3));
  const Cells cells(census.plants);
  const int stacks = census.plants;
  for (int stack = 0; stack < stacks; ++stack) {
    const int first = static_cast<int>(static_cast<long>(census.books) * stack / stacks);
    const int last = static_cast<int>(static_cast<long>(census.books) * (stack + 1) / stacks);
    Vec3 at = cells.center(stack) + 0.5f * cells.pitch * Vec3(1.f, 0.f, 1.f);
    for (int i = first; i < last; ++i) {
      const Vec3 size = random_book_size(random);
      at.y += kContactGap;
      const MeshId book = books[random.below(static_cast<int>(books.size()))];
      add_node(scene, "book " + std::to_string(i + 1), book,
               lying_book(at, size, random.uniform(-0.4f, 0.4f)));
      at.y += size.x;
    }
  }
}

}  // namespace

Knobs knobs(PlantsParameters& p) {
  return {{"count", "triangles in all, about", &p.count, 2000, 8e6},
          {"seed", "shapes and places", &p.seed, 0, 1e9}};
}

Scene plants_scene(const PlantsParameters& p) {
  Scene scene;
  const RoomMaterials room =
      add_room_materials(scene, {0.36f, 0.3f, 0.24f}, {0.74f, 0.72f, 0.68f}, Rgb(0.8f));
  add_room(scene, kRoom, room);
  const std::uint64_t seed = static_cast<std::uint64_t>(p.seed);
  const Census census = take_census(p.count);
  add_plants(scene, census, seed);
  add_stacks(scene, census, seed);
  const MaterialId light = add_emitter(scene, "light", {20.f, 18.5f, 16.f}, Rgb(0.5f));
  const MeshId panel = add_light_panel(scene, {1.5f, 1.5f, 0.05f}, light, room.ceiling);
  for (const Vec2 at : {Vec2(-2.5f), Vec2(2.5f, -2.5f), Vec2(-2.5f, 2.5f), Vec2(2.5f)})
    add_node(scene, "ceiling light", panel, placed_at({at.x, 2.85f, at.y}));
  add_camera(scene, "corner", {4.7f, 2.2f, 4.7f}, {0.f, 0.5f, 0.f}, 1.f);
  return scene;
}

}  // namespace halflight
