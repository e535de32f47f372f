// The element tree: containment, order, areas, and points found where they were sampled.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "halflight/hierarchy/elements.h"
#include "halflight/hierarchy/size_grid.h"
#include "halflight/rays/sampling.h"
#include "halflight/scene/procedural/loose_triangles.h"
#include "halflight/scene/procedural/office.h"
#include "quad_scene.h"

namespace halflight {
namespace {

// All sides live, so that every surface of the scene is tested.
struct Elements {
  explicit Elements(Scene scene, bool strict = false)
      : world(make_world(std::move(scene))), surfaces(build_surfaces(world->geometry)) {
    std::vector<Bounds3f> boxes;
    for (const Surface& s : surfaces.surfaces) boxes.push_back(s.box);
    SizeGridOptions options;
    options.strict = strict;
    const IdVector<SideId, std::uint8_t> live(2 * boxes.size(), 1);
    tree = std::make_unique<ElementTree>(world->geometry, surfaces, build_size_grid(boxes, options),
                                         live);
  }
  void split_all_cells(std::size_t rounds) {
    for (std::size_t round = 0; round < rounds; ++round)
      for (std::size_t i = 0, n = tree->size(); i < n; ++i)
        if ((*tree)[ElementId(i)].side.valid() && (*tree)[ElementId(i)].is_leaf())
          tree->split(ElementId(i));
  }

  std::shared_ptr<const World> world;
  Surfaces surfaces;
  std::unique_ptr<ElementTree> tree;
};

Scene small_office() {
  OfficeParameters p;
  p.count = 60;
  return office_scene(p);
}

bool holds(const Bounds3f& outer, const Bounds3f& inner, float tolerance) {
  return glm::all(glm::lessThanEqual(outer.lower - tolerance, inner.lower)) &&
         glm::all(glm::lessThanEqual(inner.upper, outer.upper + tolerance));
}

class ElementTrees : public ::testing::TestWithParam<bool> {};

TEST_P(ElementTrees, ParentsComeFirstAndHoldTheirChildren) {
  Elements e(small_office(), GetParam());
  e.split_all_cells(2);
  const ElementTree& tree = *e.tree;
  std::vector<int> parents(tree.size(), 0);
  for (std::size_t i = 0; i < tree.size(); ++i)
    for (const ElementId child : tree[ElementId(i)].children()) {
      EXPECT_GT(child.value, i);
      EXPECT_EQ(tree[child].parent.value, i);
      EXPECT_TRUE(holds(tree[ElementId(i)].box, tree[child].box, 2e-5f));
      ++parents[child.value];
    }
  for (std::size_t i = 1; i < tree.size(); ++i) EXPECT_EQ(parents[i], 1);
}

// Also in crowds, where clusters take later clusters in.
TEST_P(ElementTrees, HoldEveryLiveSideOnce) {
  LooseTrianglesParameters crowd;
  crowd.count = 3000;
  const Elements e(loose_triangles_scene(crowd), GetParam());
  std::vector<int> times(2 * e.surfaces.surfaces.size(), 0);
  for (std::size_t i = 0; i < e.tree->size(); ++i)
    if (const SideId side = (*e.tree)[ElementId(i)].side; side.valid()) {
      ++times[side.value];
      EXPECT_EQ(e.tree->side_root(side).value, i);
    }
  EXPECT_EQ(std::count(times.begin(), times.end(), 1), static_cast<long>(times.size()));
}

TEST_P(ElementTrees, CountTheAreaOfBothSidesOfAllTriangles) {
  const Elements e(small_office(), GetParam());
  double area = 0.0;
  for (std::size_t t = 0; t < e.world->geometry.triangles.size(); ++t)
    area += static_cast<double>(glm::length(e.world->geometry.scaled_normal(TriangleId(t))));
  EXPECT_NEAR((*e.tree)[e.tree->root()].area, area, 1e-4 * area);
}

INSTANTIATE_TEST_SUITE_P(Grids, ElementTrees, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "Strict" : "Loose"; });

TEST(ElementTreeTest, SplittingCellsKeepsArea) {
  Elements e(small_office());
  e.split_all_cells(4);
  const ElementTree& tree = *e.tree;
  for (std::size_t i = e.tree->initial_size(); i-- > 0;) {
    const ElementId whole(i);
    if (tree[whole].is_cluster()) continue;
    double leaves = 0.0;
    std::vector<ElementId> open{whole};
    while (!open.empty()) {
      const ElementId at = open.back();
      open.pop_back();
      if (tree[at].is_leaf()) leaves += static_cast<double>(tree[at].area);
      for (const ElementId child : tree[at].children()) open.push_back(child);
    }
    EXPECT_NEAR(leaves, tree[whole].area, 1e-4 * tree[whole].area)
        << "side " << tree[whole].side.value;
  }
}

TEST(ElementTreeTest, PiecesOfACellCoverItsArea) {
  Elements e(small_office());
  e.split_all_cells(3);
  const ElementTree& tree = *e.tree;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (tree[ElementId(i)].is_cluster()) continue;
    double area = 0.0;
    tree.for_each_piece(ElementId(i), [&](std::span<const Vec3> p) {
      Vec3 doubled(0.f);
      for (std::size_t k = 1; k + 1 < p.size(); ++k)
        doubled += glm::cross(p[k] - p[0], p[k + 1] - p[0]);
      area += 0.5 * static_cast<double>(glm::length(doubled));
    });
    EXPECT_NEAR(area, tree[ElementId(i)].area, 1e-3 * tree[ElementId(i)].area + 1e-9);
  }
}

// Points nearer to a cell's border than rounding may belong to either neighbour.
TEST(ElementTreeTest, FindsTheCellThatAPointWasSampledFrom) {
  Elements e(small_office());
  e.split_all_cells(4);
  const ElementTree& tree = *e.tree;
  std::size_t tried = 0, found = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const Element& cell = tree[ElementId(i)];
    if (!cell.is_leaf_cell()) continue;
    const CellPoint p = tree.sample(ElementId(i), random_shift(hash(i, 5)));
    const Surface& surface = tree.surfaces()[cell.side];
    EXPECT_LT(std::abs(glm::dot(p.position - surface.origin, surface.normal)), 1e-4f);
    EXPECT_EQ(tree.surfaces().of_triangle[p.triangle], surface_of(cell.side));
    ++tried;
    found += tree.find_leaf(cell.side, p.position) == ElementId(i);
  }
  EXPECT_GT(tried, 10000u);
  EXPECT_GT(static_cast<double>(found), 0.999 * static_cast<double>(tried));
}

TEST(ElementTreeTest, SamplesACellUniformlyOverItsArea) {
  testing::QuadScene scene;
  scene.quad({0, 0, 0}, {0, 0, 1}, {2, 0, 0}, scene.material(0.5f));
  Elements e(scene.scene);
  e.split_all_cells(1);
  const ElementId whole = e.tree->side_root(SideId(0));
  Vec3 sum(0.f), squares(0.f);
  constexpr int kPoints = 4096;
  for (std::uint32_t k = 0; k < kPoints; ++k) {
    const Vec3 p = e.tree->sample(whole, r2_sequence(k)).position;
    sum += p;
    squares += p * p;
  }
  // Mean 1/2 of each side, mean square 1/3 of its square.
  EXPECT_NEAR(sum.x / kPoints, 1.f, 0.005f);
  EXPECT_NEAR(sum.z / kPoints, 0.5f, 0.005f);
  EXPECT_NEAR(squares.x / kPoints, 4.f / 3.f, 0.01f);
  EXPECT_NEAR(squares.z / kPoints, 1.f / 3.f, 0.005f);
}

}  // namespace
}  // namespace halflight
