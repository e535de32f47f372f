// Clusters as media: extinction of known bodies, and what a ray keeps of its light in random ones.
#include <gtest/gtest.h>

#include <functional>

#include "clustered_world.h"
#include "halflight/base/parallel.h"
#include "halflight/visibility/extinction.h"
#include "halflight/visibility/multires_tree.h"
#include "quad_scene.h"

namespace halflight {
namespace {

using testing::ClusteredWorld;
using testing::Dice;
using testing::QuadScene;
using testing::ShapeScene;

float total_blocking_area(const Scene& scene) {
  const World world(scene);
  const Surfaces surfaces = build_surfaces(world.geometry);
  float sum = 0.f;
  for (const float area : blocking_areas(world.scene, world.geometry, surfaces.bodies)) sum += area;
  return sum;
}

float total_blocking_area(ShapeScene& shapes) {
  shapes.end_mesh();
  return total_blocking_area(shapes.scene);
}

const Frame kStraight{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

TEST(Extinction, ClosedBodiesBlockAQuarterOfTheirAreaAndSheetsHalf) {
  ShapeScene cube, sheet;
  cube.cube(Vec3(0.f), kStraight, 2.f);
  EXPECT_NEAR(total_blocking_area(cube), 24.f / 4.f, 1e-5f);
  sheet.quad(Vec3(0.f), Vec3(1, 0, 0), Vec3(0, 1, 0));
  EXPECT_NEAR(total_blocking_area(sheet), 4.f / 2.f, 1e-5f);
}

TEST(Extinction, ABoxThatLacksASideIsSheets) {
  ShapeScene open;
  for (const Side side : kAllSides)
    if (side != Side::y_high) append_quad(open.shapes, side_of({Vec3(0.f), Vec3(1.f)}, side));
  EXPECT_NEAR(total_blocking_area(open), 5.f / 2.f, 1e-5f);
}

TEST(Extinction, TranslucentSurfacesBlockTheirShare) {
  ShapeScene sheet, glass;
  for (ShapeScene* shapes : {&sheet, &glass}) {
    shapes->material().alpha_mode = AlphaMode::blend;
    shapes->material().alpha = 0.3f;
  }
  sheet.quad(Vec3(0.f), Vec3(1, 0, 0), Vec3(0, 1, 0));
  EXPECT_NEAR(total_blocking_area(sheet), 0.3f * 2.f, 1e-5f);
  // Both walls of a glass cube together stop 1 - 0.7^2 of a ray.
  glass.cube(Vec3(0.f), kStraight, 2.f);
  EXPECT_NEAR(total_blocking_area(glass), (1.f - 0.49f) * 6.f, 1e-5f);
}

// A leaf cut out of a sheet by a texture, of which a quarter is there.
TEST(Extinction, SheetsWithHolesBlockWhatIsLeftOfThem) {
  QuadScene leaf;
  Texture quarter;
  quarter.width = quarter.height = 2;
  quarter.texels = {
      {255, 255, 255, 255}, {255, 255, 255, 0}, {255, 255, 255, 0}, {255, 255, 255, 0}};
  const MaterialId material = leaf.material(0.5f);
  leaf.scene.materials[material].alpha_mode = AlphaMode::mask;
  leaf.scene.materials[material].reflectance_texture.texture =
      leaf.scene.textures.push_back(quarter);
  leaf.quad(Vec3(0.f), Vec3(2, 0, 0), Vec3(0, 2, 0), material);
  EXPECT_NEAR(total_blocking_area(leaf.scene), 0.25f * 4.f / 2.f, 0.1f);
}

// Bodies spread evenly through a slab, and rays through its middle. All numbers are means over the
// rays.
struct Slab {
  double exact = 0.0;
  double formula = 0.0;  // exp(-kappa l), kappa of the whole slab
  double medium = 0.0;   // the tree, with clusters of any size as media
  double leaves = 0.0;   // the tree, extinction of the last clusters
};

const Bounds3f kFilled{Vec3(-0.2f), Vec3(1.2f)};

Slab shoot_through(ShapeScene& shapes) {
  const ClusteredWorld c = testing::cluster(shapes);
  const MultiresTree tree(c.world.scene, c.world.geometry, c.surfaces, c.clusters);
  float area = 0.f;
  for (const float a : blocking_areas(c.world.scene, c.world.geometry, c.surfaces.bodies))
    area += a;
  const float kappa = extinction(area, kFilled);
  constexpr int kRays = 20000;
  const auto mean_of = [&](const std::function<double(const Vec3&, const Vec3&)>& f) {
    return parallel_sum(kRays, 1000, 0.0, [&](std::size_t i) {
      Dice dice(hash(i, 77));
      const Vec3 shift(0.f, 0.f, 3.f), from = dice.point(), to = dice.point();
      return f(Vec3(from.x, from.y, -0.2f) - shift, Vec3(to.x, to.y, 1.2f) + shift) / kRays;
    });
  };
  const auto inside = [](const Vec3& a, const Vec3& b) {
    return glm::length(b - a) * kFilled.extent().z / (b.z - a.z);
  };
  Slab slab;
  slab.exact =
      mean_of([&](const Vec3& a, const Vec3& b) { return c.world.rays.transmittance(a, b); });
  slab.formula =
      mean_of([&](const Vec3& a, const Vec3& b) { return std::exp(-kappa * inside(a, b)); });
  slab.medium = mean_of([&](const Vec3& a, const Vec3& b) {
    return tree.multires({a, b - a, 1.f}, StopRule::between(100.f, 100.f));
  });
  slab.leaves = mean_of([&](const Vec3& a, const Vec3& b) {
    return tree.average({a, b - a, 1.f}, StopRule::never());
  });
  return slab;
}

// Rays come in from the slab's neighbourhood in directions within 15 degrees of its normal; bodies
// are turned at random, so that the direction does not matter.
Slab slab_of_discs(float optical_depth) {
  ShapeScene shapes;
  Dice dice(5);
  const float radius = 0.02f, octagon = 2.f * std::sqrt(2.f) * radius * radius;
  const int n = static_cast<int>(optical_depth * 2.f * kFilled.volume() / octagon / 1.4f);
  for (int i = 0; i < n; ++i) {
    const Vec3 at = dice.point_in(kFilled);
    shapes.disc(at, dice.frame(), radius, 8);
  }
  return shoot_through(shapes);
}

TEST(Extinction, RandomDiscsWeakenAsTheFormulaSays) {
  const Slab slab = slab_of_discs(1.f);
  EXPECT_NEAR(slab.formula, 0.36, 0.02);
  EXPECT_NEAR(slab.exact, slab.formula, 0.02);
  EXPECT_NEAR(slab.medium, slab.formula, 0.02);
}

TEST(Extinction, RandomClosedBoxesWeakenAsTheFormulaSays) {
  ShapeScene shapes;
  Dice dice(6);
  const float edge = 0.02f;
  const int n = static_cast<int>(kFilled.volume() / (1.5f * edge * edge) / 1.4f);
  for (int i = 0; i < n; ++i) {
    const Vec3 at = dice.point_in(kFilled);
    shapes.cube(at, dice.frame(), edge);
  }
  const Slab slab = shoot_through(shapes);
  EXPECT_NEAR(slab.formula, 0.36, 0.02);
  EXPECT_NEAR(slab.exact, slab.formula, 0.02);
  EXPECT_NEAR(slab.medium, slab.formula, 0.02);
}

TEST(Extinction, MoreDiscsLetLessThrough) {
  Slab last{1.0, 1.0, 1.0, 1.0};
  for (const float depth : {0.25f, 0.5f, 1.f, 2.f}) {
    const Slab slab = slab_of_discs(depth);
    EXPECT_LT(slab.medium, last.medium - 0.05);
    EXPECT_LT(slab.leaves, last.leaves - 0.05);
    EXPECT_GT(slab.medium, 0.0);
    last = slab;
  }
}

}  // namespace
}  // namespace halflight
