// Surfaces: one wall is one surface with the same cells, however the file cut it into triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <tuple>
#include <vector>

#include "halflight/hierarchy/elements.h"
#include "halflight/hierarchy/size_grid.h"
#include "quad_scene.h"

namespace halflight {
namespace {

using Corners = std::array<Vec3, 3>;

constexpr float kWidth = 3.f, kHeight = 2.f;

Vec3 on_wall(float u, float v) { return {u * kWidth, v * kHeight, 1.f}; }

std::vector<Corners> two_triangles() {
  return {{on_wall(0, 0), on_wall(1, 0), on_wall(1, 1)},
          {on_wall(0, 0), on_wall(1, 1), on_wall(0, 1)}};
}
std::vector<Corners> other_diagonal() {
  return {{on_wall(0, 0), on_wall(1, 0), on_wall(0, 1)},
          {on_wall(1, 0), on_wall(1, 1), on_wall(0, 1)}};
}
std::vector<Corners> fan(Vec3 hub) {
  const std::array<Vec3, 4> rim{on_wall(0, 0), on_wall(1, 0), on_wall(1, 1), on_wall(0, 1)};
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < 4; ++i) triangles.push_back({hub, rim[i], rim[(i + 1) % 4]});
  return triangles;
}
std::vector<Corners> fine_grid() {
  constexpr int kColumns = 7, kRows = 5;
  std::vector<Corners> triangles;
  for (int i = 0; i < kColumns; ++i)
    for (int k = 0; k < kRows; ++k) {
      const auto at = [&](int a, int b) {
        return on_wall(static_cast<float>(i + a) / kColumns, static_cast<float>(k + b) / kRows);
      };
      triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  return triangles;
}

Scene scene_of(const std::vector<Corners>& triangles) {
  testing::QuadScene quads;
  const MaterialId grey = quads.material(0.5f);
  Primitive p;
  for (const Corners& t : triangles) {
    const auto n = static_cast<std::uint32_t>(p.positions.size());
    p.positions.insert(p.positions.end(), t.begin(), t.end());
    p.triangles.push_back({n, n + 1, n + 2});
  }
  p.material = grey;
  Mesh mesh;
  mesh.primitives.push_back(p);
  Node node;
  node.mesh = quads.scene.meshes.push_back(mesh);
  quads.scene.nodes.push_back(node);
  return quads.scene;
}

// Area and middle of the sixteen cells of the wall's front after four rounds of halving.
using Cell = std::array<float, 3>;
std::vector<Cell> cells_of(const std::vector<Corners>& triangles) {
  const auto world = make_world(scene_of(triangles));
  const Surfaces surfaces = build_surfaces(world->geometry);
  EXPECT_EQ(surfaces.surfaces.size(), 1u);
  const std::vector<Bounds3f> boxes{surfaces[SurfaceId(0)].box};
  ElementTree tree(world->geometry, surfaces, build_size_grid(boxes),
                   IdVector<SideId, std::uint8_t>(2, 1));
  std::vector<ElementId> leaves{tree.side_root(SideId(0))};
  for (int round = 0; round < 4; ++round) {
    std::vector<ElementId> halves;
    for (const ElementId leaf : leaves) {
      tree.split(leaf);
      for (const ElementId child : tree[leaf].children()) halves.push_back(child);
    }
    leaves = halves;
  }
  std::vector<Cell> cells;
  for (const ElementId leaf : leaves) {
    const auto rounded = [](float x) { return std::round(x * 1e4f) * 1e-4f; };
    cells.push_back(
        {rounded(tree[leaf].center().x), rounded(tree[leaf].center().y), rounded(tree[leaf].area)});
  }
  std::sort(cells.begin(), cells.end());
  return cells;
}

TEST(SurfaceTest, OneWallHasTheSameCellsHoweverItIsCut) {
  const std::vector<Cell> expected = cells_of(two_triangles());
  ASSERT_EQ(expected.size(), 16u);
  for (const Cell& c : expected) EXPECT_NEAR(c[2], kWidth * kHeight / 16.f, 1e-4f);
  for (const auto& other : {other_diagonal(), fine_grid(), fan(on_wall(0.5f, 0.5f)),
                            fan(on_wall(0.37f, 0.61f)), fan(on_wall(0.05f, 0.9f))}) {
    const std::vector<Cell> cells = cells_of(other);
    ASSERT_EQ(cells.size(), expected.size());
    for (std::size_t i = 0; i < cells.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(cells[i][k], expected[i][k], 2e-4f);
  }
}

TEST(SurfaceTest, TurnedTrianglesAndOtherMaterialsAreSurfacesOfTheirOwn) {
  std::vector<Corners> folded = two_triangles();
  folded[1][2].z += 0.2f;
  const auto bent = make_world(scene_of(folded));
  EXPECT_EQ(build_surfaces(bent->geometry).surfaces.size(), 2u);

  std::vector<Corners> flipped = two_triangles();
  std::swap(flipped[1][1], flipped[1][2]);
  const auto turned = make_world(scene_of(flipped));
  EXPECT_EQ(build_surfaces(turned->geometry).surfaces.size(), 2u);

  testing::QuadScene quads;
  quads.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, quads.material(0.5f));
  quads.quad({1, 0, 0}, {0, 0, 1}, {1, 0, 0}, quads.material(0.2f));
  const auto painted = make_world(quads.scene);
  EXPECT_EQ(build_surfaces(painted->geometry).surfaces.size(), 2u);
}

TEST(SurfaceTest, TrianglesAreSharedOutWithTheirArea) {
  const auto world = make_world(scene_of(fine_grid()));
  const Surfaces surfaces = build_surfaces(world->geometry);
  ASSERT_EQ(surfaces.surfaces.size(), 1u);
  EXPECT_EQ(surfaces[SurfaceId(0)].triangle_count, world->geometry.triangles.size());
  EXPECT_NEAR(surfaces[SurfaceId(0)].area, kWidth * kHeight, 1e-4f);
  for (const SurfaceId s : surfaces.of_triangle) EXPECT_EQ(s, SurfaceId(0));
}

}  // namespace
}  // namespace halflight
