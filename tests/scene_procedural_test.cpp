#include <gtest/gtest.h>

#include <cctype>
#include <map>

#include "halflight/rays/ray_scene.h"
#include "halflight/scene/geometry.h"
#include "halflight/scene/procedural/books.h"
#include "halflight/scene/procedural/cube_groups.h"
#include "halflight/scene/procedural/doorway.h"
#include "halflight/scene/procedural/furnace.h"
#include "halflight/scene/procedural/loose_triangles.h"
#include "halflight/scene/procedural/office.h"
#include "halflight/scene/procedural/plants.h"

namespace halflight {
namespace {

float area(const Geometry& g, TriangleId t) { return 0.5f * glm::length(g.scaled_normal(t)); }

template <class Visit>
void for_each_triangle(const Geometry& g, const Visit& visit) {
  for (std::size_t i = 0; i < g.triangles.size(); ++i) visit(TriangleId(i));
}

TEST(Furnace, HasTheAreaOfTheBoxAndItsCubes) {
  FurnaceParameters p;
  p.side = 3.f;
  p.boxes = 20;
  const Scene scene = furnace_scene(p);
  const Geometry g = flatten(scene);
  double total = 0.0;
  for_each_triangle(g, [&](TriangleId t) { total += static_cast<double>(area(g, t)); });
  // Twenty cubes need three cells along a side of 3 m; an edge is 0.45 of a cell.
  const double edge = 0.45;
  EXPECT_NEAR(total, 6 * 9.0 + 20 * 6 * edge * edge, 1e-3);
  EXPECT_EQ(g.triangles.size(), 12u * 21u);
}

// Pairs of opposite edges: every edge of a closed surface is walked once in each direction.
TEST(Doorway, TheShellOfBothRoomsIsWatertight) {
  const Scene scene = doorway_scene();
  const Geometry g = flatten(scene);
  using Point = std::array<float, 3>;
  std::map<std::pair<Point, Point>, int> balance;
  const auto point = [&](VertexId v) {
    const Vec3& p = g.positions[v];
    return Point{p.x, p.y, p.z};
  };
  for_each_triangle(g, [&](TriangleId t) {
    for (int k = 0; k < 3; ++k) {
      const Point a = point(g.triangles[t][k]), b = point(g.triangles[t][(k + 1) % 3]);
      ++balance[{a, b}];
      --balance[{b, a}];
    }
  });
  for (const auto& [edge, count] : balance) EXPECT_EQ(count, 0);
}

TEST(Doorway, TheDarkRoomSeesTheLightOnlyThroughTheDoor) {
  const Scene scene = doorway_scene();
  const Geometry g = flatten(scene);
  const RayScene rays(scene, g);
  Vec3 light(0.f);
  int n = 0;
  for_each_triangle(g, [&](TriangleId t) {
    if (!scene.materials[g.materials[t]].emits()) return;
    const auto [a, b, c] = g.corners(t);
    light += (a + b + c) / 3.f;
    ++n;
  });
  light = light / static_cast<float>(n) - Vec3(0.f, 0.01f, 0.f);
  EXPECT_LT(light.x, 0.f);
  EXPECT_EQ(rays.transmittance({2.f, 1.5f, 1.2f}, light), 0.f);  // behind the wall
  EXPECT_EQ(rays.transmittance({0.5f, 0.1f, 0.f}, light), 1.f);  // just behind the door
}

TEST(CubeGroups, CubesAreApartAndInTheSlab) {
  for (int group = 1; group <= 4; ++group) {
    CubeGroupsParameters p;
    p.group = group;
    const Scene scene = cube_groups_scene(p);
    std::vector<Bounds3f> cubes;
    const Geometry g = flatten(scene);
    for (const PrimitiveInstance& instance : g.primitive_instances) {
      if (scene.nodes[instance.node].name.find("cube") == std::string::npos) continue;
      Bounds3f box;
      for (const VertexId v : instance.vertices) box.extend(g.positions[v]);
      cubes.push_back(box);
    }
    // Random placing finds no room for all 32 of the largest.
    constexpr std::array<std::size_t, 4> kMost{254, 113, 63, 32}, kLeast{254, 113, 63, 16};
    EXPECT_LE(cubes.size(), kMost[static_cast<std::size_t>(group - 1)]);
    EXPECT_GE(cubes.size(), kLeast[static_cast<std::size_t>(group - 1)]);
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      EXPECT_GE(cubes[i].lower.z, 0.2999f);
      EXPECT_LE(cubes[i].upper.z, 0.8001f);
      for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(cubes[i].overlaps(cubes[j]));
    }
  }
}

TEST(Books, StandApartBetweenTheBoards) {
  for (int seed = 1; seed < 6; ++seed) {
    BooksParameters p;
    p.boards = 4;
    p.seed = seed;
    const Scene scene = books_scene(p);
    const Geometry g = flatten(scene);
    std::map<NodeId, Bounds3f> books;
    Bounds3f shelf;
    for (const PrimitiveInstance& instance : g.primitive_instances) {
      const std::string& name = scene.nodes[instance.node].name;
      Bounds3f box;
      for (const VertexId v : instance.vertices) box.extend(g.positions[v]);
      if (name.starts_with("book ")) books[instance.node].extend(box);
      if (name == "shelf") shelf.extend(box);
    }
    EXPECT_GT(books.size(), 4u * 8u);
    for (const auto& [node, box] : books) {
      EXPECT_GT(box.lower.x, shelf.lower.x + 0.02f) << scene.nodes[node].name;
      EXPECT_LT(box.upper.x, shelf.upper.x - 0.02f) << scene.nodes[node].name;
      EXPECT_GT(box.lower.z, shelf.lower.z + 0.01f) << scene.nodes[node].name;
      EXPECT_LT(box.upper.z, shelf.upper.z) << scene.nodes[node].name;
      for (const auto& [other, other_box] : books) {
        const bool apart = node == other || !box.overlaps(other_box);
        EXPECT_TRUE(apart) << scene.nodes[node].name << ", " << scene.nodes[other].name;
      }
    }
  }
}

TEST(LooseTriangles, AreAsManyAndAsLargeAsAsked) {
  LooseTrianglesParameters p;
  p.count = 500;
  p.size = 0.1f;
  const Scene scene = loose_triangles_scene(p);
  const Geometry g = flatten(scene);
  int loose = 0;
  for_each_triangle(g, [&](TriangleId t) {
    if (!scene.materials[g.materials[t]].double_sided) return;
    ++loose;
    EXPECT_NEAR(area(g, t), std::sqrt(3.f) / 4.f * 0.01f, 1e-5f);
  });
  EXPECT_EQ(loose, 500);
}

TEST(Plants, KeepToTheTriangleCountAndToTheLeafSize) {
  for (const int count : {20000, 300000}) {
    PlantsParameters p;
    p.count = count;
    const Scene scene = plants_scene(p);
    const Geometry g = flatten(scene);
    EXPECT_NEAR(static_cast<double>(g.triangles.size()), count, 0.03 * count);
    for_each_triangle(g, [&](TriangleId t) {
      if (!scene.materials[g.materials[t]].double_sided) return;
      const auto [a, b, c] = g.corners(t);
      const float longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
      ASSERT_GE(longest, 0.0099f);
      ASSERT_LE(longest, 0.0401f);
    });
    EXPECT_LT(g.bounds.upper.y, 3.001f);
    EXPECT_LT(max_component(glm::abs(g.bounds.lower)), 5.001f);
  }
}

// Small things are the nodes that hang below desks and shelves and are numbered.
std::size_t count_small_things(const Scene& scene) {
  std::size_t n = 0;
  for (const Node& node : scene.nodes) {
    if (!node.parent.valid()) continue;
    const std::string& parent = scene.nodes[node.parent].name;
    if ((parent == "desk" || parent == "shelf") && std::isdigit(node.name.back()) != 0) ++n;
  }
  return n;
}

TEST(Office, HasExactlyAsManySmallThingsAsAsked) {
  for (const int count : {0, 7, 333, 5000}) {
    OfficeParameters p;
    p.count = count;
    EXPECT_EQ(count_small_things(office_scene(p)), static_cast<std::size_t>(count));
  }
}

TEST(Office, ReachesAMillionTrianglesWithTwentyThousandThings) {
  OfficeParameters p;
  p.count = 20000;
  EXPECT_GT(flatten(office_scene(p)).triangles.size(), 1000000u);
}

// Boxes of the things on one board, along the board, do not overlap by more than rounding.
TEST(Office, ThingsOnAShelfStandBesideEachOther) {
  const Scene scene = office_scene();
  std::map<std::uint32_t, std::vector<std::array<double, 3>>> shelves;  // height, from, to
  for (const Node& node : scene.nodes) {
    if (!node.parent.valid() || scene.nodes[node.parent].name != "shelf") continue;
    const Mat4& m = node.local;
    shelves[node.parent.value].push_back({m[3][1], m[3][0], m[3][0] + m[0][0]});
  }
  ASSERT_FALSE(shelves.empty());
  for (auto& [shelf, things] : shelves) {
    std::sort(things.begin(), things.end());
    for (std::size_t i = 1; i < things.size(); ++i) {
      if (things[i][0] != things[i - 1][0]) continue;
      EXPECT_GT(things[i][1], things[i - 1][2]);
    }
    EXPECT_LT(things.back()[2], 0.48);
  }
}

}  // namespace
}  // namespace halflight
