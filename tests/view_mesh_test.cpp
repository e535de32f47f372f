// What the live view draws, and what may be left out of it: nothing that would be missed.
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "halflight/view/view_mesh.h"
#include "quad_scene.h"
#include "solved_scene.h"

namespace halflight {
namespace {

using testing::QuadScene;

// A room of 3 m with a lamp, and shelves of small boxes whose sides face all ways.
SolverState room() {
  QuadScene quads;
  quads.box({0, 0, 0}, {3, 3, 3}, quads.material(0.5f), true);
  quads.quad({1, 2.9f, 1}, {1, 0, 0}, {0, 0, 1}, quads.material(0.f, 10.f));
  const MaterialId wood = quads.material(0.3f);
  for (int i = 0; i < 5; ++i) {
    const float at = 0.3f + 0.5f * static_cast<float>(i);
    quads.box({at, 0.2f, 1}, {at + 0.2f, 0.5f, 1.4f}, wood, false);
  }
  SolveOptions options;
  options.feature_size = 0.05f;
  return make_state(make_world(quads.scene), options);
}

Vec3 area_vector(const ViewMesh& mesh, const ViewTriangle& t) {
  const Vec3 a = mesh.positions[t[0]];
  return 0.5f * glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
}

void expect_sound_chunks(const ViewMesh& mesh, const std::vector<ViewTriangle>& triangles,
                         const std::vector<ViewChunk>& chunks) {
  std::uint32_t next = 0, draw = 0;
  for (const ViewChunk& chunk : chunks) {
    EXPECT_EQ(chunk.first, next) << "each triangle lies in one chunk";
    next += chunk.count;
    EXPECT_GE(chunk.draw, draw);
    draw = chunk.draw;
    float largest = kInfinity;
    for (std::uint32_t i = chunk.first; i < next; ++i) {
      const Vec3 area = area_vector(mesh, triangles[i]);
      const float size = glm::length(area);
      EXPECT_LE(size, 1.0001f * largest) << "the largest come first";
      largest = size;
      for (const std::uint32_t v : triangles[i]) EXPECT_TRUE(chunk.box.contains(mesh.positions[v]));
      const float cosine = glm::dot(area, chunk.axis) / size;
      const float sine = std::sqrt(std::max(0.f, 1.f - cosine * cosine));
      EXPECT_TRUE(chunk.sine == 1.f || (cosine > 0.f && sine <= chunk.sine + 1e-3f))
          << "the cone holds all normals";
    }
  }
  EXPECT_EQ(next, triangles.size());
}

TEST(ViewMesh, IsArrangedInChunksThatTellWhereTheyLieAndFace) {
  const SolverState state = room();
  const ViewMesh mesh = make_view_mesh(*state.world, cut_evenly(state, 60'000));
  ASSERT_GT(mesh.triangles.size(), 10'000u);
  expect_sound_chunks(mesh, mesh.triangles, mesh.chunks);
  expect_sound_chunks(mesh, mesh.simple, mesh.simple_chunks);
  for (const ViewChunk& chunk : mesh.chunks) {
    const ViewMesh::Draw& draw = mesh.draws[chunk.draw];
    EXPECT_GE(chunk.first, draw.first);
    EXPECT_LE(chunk.first + chunk.count, draw.first + draw.count);
  }
}

TEST(ViewMesh, HasASimplerOneThatCoversTheSameSurface) {
  const SolverState state = room();
  const ViewMesh mesh = make_view_mesh(*state.world, cut_evenly(state, 60'000));
  ASSERT_FALSE(mesh.simple.empty());
  EXPECT_LT(mesh.simple.size(), mesh.triangles.size() / 4);
  // By the way that it faces and the plane that it lies in.
  const auto by_plane = [&](const std::vector<ViewTriangle>& triangles) {
    std::map<std::array<int, 4>, double> areas;
    for (const ViewTriangle& t : triangles) {
      const Vec3 area = area_vector(mesh, t);
      const Vec3 n = glm::normalize(area);
      const auto rounded = [](float x) { return static_cast<int>(std::lround(100.f * x)); };
      areas[{rounded(n.x), rounded(n.y), rounded(n.z),
             rounded(glm::dot(n, mesh.positions[t[0]]))}] += static_cast<double>(glm::length(area));
    }
    return areas;
  };
  const auto whole = by_plane(mesh.triangles), simple = by_plane(mesh.simple);
  ASSERT_EQ(whole.size(), simple.size());
  for (const auto& [plane, area] : whole) EXPECT_NEAR(simple.at(plane), area, 1e-4 * area);
}

TEST(ViewMesh, OfTooManyTrianglesTheLargestComeFirst) {
  const SolverState state = room();
  const LitMesh some = cut_evenly(state, 60'000, 14);
  std::set<std::uint32_t> sources;
  for (const LitPrimitive& p : some.primitives)
    for (const TriangleId t : p.sources) sources.insert(t.value);
  EXPECT_EQ(sources.size(), 14u);
  const Geometry& g = state.world->geometry;
  for (std::size_t i = 0; i < g.triangles.size(); ++i)
    EXPECT_EQ(g.area(TriangleId(i)) > 0.4f, sources.contains(static_cast<std::uint32_t>(i)))
        << "walls and lamp are larger than the sides of boxes";
}

TEST(ViewMesh, MovesWhatBelongsToANode) {
  const SolverState state = room();
  ViewMesh mesh = make_view_mesh(*state.world, cut_evenly(state, 60'000));
  const std::vector<Vec3> before = mesh.positions;
  const NodeId lamp(6);
  translate(mesh, *state.world, lamp, {0, -0.5f, 0});
  std::size_t moved = 0;
  for (std::size_t v = 0; v < before.size(); ++v) {
    if (before[v] == mesh.positions[v]) continue;
    ++moved;
    EXPECT_FLOAT_EQ(before[v].y, 2.9f);
    EXPECT_FLOAT_EQ(mesh.positions[v].y, 2.4f);
  }
  EXPECT_GT(moved, 100u);
  expect_sound_chunks(mesh, mesh.triangles, mesh.chunks);
  expect_sound_chunks(mesh, mesh.simple, mesh.simple_chunks);
}

}  // namespace
}  // namespace halflight
