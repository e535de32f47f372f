#include "halflight/output/bake_lightmap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "gltf_check.h"
#include "halflight/base/parallel.h"
#include "halflight/io/image_read.h"
#include "halflight/io/image_write.h"
#include "halflight/output/lit_mesh.h"
#include "halflight/output/match_seams.h"
#include "quad_scene.h"
#include "shared_scenes.h"
#include "solved_scene.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

using testing::QuadScene;

constexpr float kIndirect = 0.25f;

// Light that follows the place alone, part of it reflected.
LightReader reader(std::function<float(const ReadingPoint&)> light) {
  return [light = std::move(light)](std::span<const ReadingPoint> points) {
    std::vector<Reading> readings(points.size());
    parallel_for(points.size(), 64, [&](std::size_t i) {
      readings[i].direct = Rgb(light(points[i]));
      if (!points[i].direct_only) readings[i].indirect = Rgb(kIndirect);
    });
    return readings;
  };
}

std::vector<std::uint8_t> nowhere(std::span<const ReadingPoint> points) {
  return std::vector<std::uint8_t>(points.size(), 0);
}

void add_mesh(Scene& scene, Primitive primitive) {
  primitive.material = scene.materials.push_back({});
  Node node;
  node.mesh = scene.meshes.push_back(Mesh{"", {std::move(primitive)}});
  scene.nodes.push_back(node);
}

// A grid of points (u, v) in [0, 1]^2 put somewhere.
Primitive grid(int columns, int rows, const std::function<Vec3(float, float)>& place) {
  Primitive p;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i)
      p.positions.push_back(place(static_cast<float>(i) / static_cast<float>(columns),
                                  static_cast<float>(j) / static_cast<float>(rows)));
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (columns + 1) + i); };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      p.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      p.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return p;
}

Vec3 on_sphere(float u, float v) {
  const float phi = 2.f * kPi * u, theta = 0.01f + (kPi - 0.02f) * v;
  return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

// Three turns of a nearly level ramp, one above the other.
Vec3 on_ramp(float u, float v) {
  const float phi = 6.f * kPi * u, r = 1.f + v;
  return {3.f + r * std::cos(phi), 0.5f * u, r * std::sin(phi)};
}

// A ball, a spiral, a box from outside and a hundred loose triangles, down to tiny ones.
Scene many_shapes() {
  QuadScene quads;
  quads.box({-4, 0, -1}, {-2, 1, 1}, quads.material(0.5f), false);
  Scene scene = quads.scene;
  add_mesh(scene, grid(24, 12, on_sphere));
  add_mesh(scene, grid(96, 4, on_ramp));
  Primitive loose;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const float size = std::pow(0.93f, static_cast<float>(i));
    const Vec3 at(0.3f * static_cast<float>(i % 10), 3.f + 0.3f * static_cast<float>(i / 10), 0.f);
    for (const Vec3& corner : {Vec3(0.f), Vec3(size, 0.f, 0.f), Vec3(0.f, 0.f, -0.5f * size)})
      loose.positions.push_back(at + corner);
    loose.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  add_mesh(scene, loose);
  return scene;
}

struct Baked {
  Scene scene;
  Geometry geometry;
  LitMesh mesh;
  Lightmap map;
};

Baked bake(Scene scene, int size, const LightReader& read,
           const decltype(LightmapLight::covered)& covered = nowhere) {
  Baked b;
  b.scene = std::move(scene);
  b.geometry = flatten(b.scene);
  LitMeshOptions options;
  options.feature_size = 0.2f;
  b.mesh = build_lit_mesh(b.scene, b.geometry, read, options);
  auto map = bake_lightmap(b.scene, b.geometry, b.mesh.primitives, {read, covered},
                           options.feature_size, size);
  EXPECT_TRUE(map) << map.error().line();
  if (map) b.map = std::move(*map);
  return b;
}

struct TexelTriangle {
  const LitPrimitive* primitive = nullptr;
  std::size_t triangle = 0;
  std::array<Vec2, 3> corners{};  // texels
  Vec3 at(Vec2 weights) const {
    const auto& v = primitive->triangles[triangle];
    const auto& p = primitive->positions;
    return p[v[0]] + weights.x * (p[v[1]] - p[v[0]]) + weights.y * (p[v[2]] - p[v[0]]);
  }
};

std::vector<TexelTriangle> triangles_in_map(const std::vector<LitPrimitive>& primitives, int size) {
  std::vector<TexelTriangle> triangles;
  for (const LitPrimitive& p : primitives)
    for (std::size_t t = 0; t < p.triangles.size(); ++t) {
      TexelTriangle& added = triangles.emplace_back();
      added.primitive = &p;
      added.triangle = t;
      for (std::size_t k = 0; k < 3; ++k)
        added.corners[k] = p.lightmap_uvs[p.triangles[t][k]] * static_cast<float>(size);
    }
  return triangles;
}

// Calls visit(x, y, weights of corners 1 and 2) for the texel centres within a triangle, further
// than `margin` texels from its sides.
void for_each_centre(const TexelTriangle& t, float margin,
                     const std::function<void(int, int, Vec2)>& visit) {
  const auto cross = [](Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; };
  const auto& p = t.corners;
  const float area = cross(p[1] - p[0], p[2] - p[0]);
  if (!(area > 1e-6f)) return;
  const Vec2 lower = glm::min(p[0], glm::min(p[1], p[2])),
             upper = glm::max(p[0], glm::max(p[1], p[2]));
  for (int y = static_cast<int>(lower.y); y <= static_cast<int>(upper.y); ++y)
    for (int x = static_cast<int>(lower.x); x <= static_cast<int>(upper.x); ++x) {
      const Vec2 c(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      bool inside = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 edge = p[(k + 1) % 3] - p[k];
        inside &= cross(edge, c - p[k]) > margin * glm::length(edge);
      }
      if (inside)
        visit(x, y, {cross(c - p[0], p[2] - p[0]) / area, cross(p[1] - p[0], c - p[0]) / area});
    }
}

Rgb bilinear(const Image& image, Vec2 texels) {
  const Vec2 from = texels - 0.5f, low = glm::floor(from), share = from - low;
  const auto at = [&](int dx, int dy) {
    return image.at(std::clamp(static_cast<int>(low.x) + dx, 0, image.width - 1),
                    std::clamp(static_cast<int>(low.y) + dy, 0, image.height - 1));
  };
  return glm::mix(glm::mix(at(0, 0), at(1, 0), share.x), glm::mix(at(0, 1), at(1, 1), share.x),
                  share.y);
}

TEST(Lightmap, NoTwoTrianglesShareATexel) {
  for (const int size : {64, 256, 512}) {
    const Baked b = bake(many_shapes(), size, reader([](const ReadingPoint&) { return 1.f; }));
    std::vector<int> owners(static_cast<std::size_t>(size) * size, 0);
    std::size_t twice = 0, once = 0;
    for (const TexelTriangle& t : triangles_in_map(b.mesh.primitives, size))
      for_each_centre(t, 1e-3f, [&](int x, int y, Vec2) {
        int& count = owners[static_cast<std::size_t>(y) * size + x];
        once += count == 0;
        twice += count == 1;
        ++count;
      });
    EXPECT_EQ(twice, 0u) << size;
    // Padding of a hundred small charts takes most of a small map.
    EXPECT_GT(once, static_cast<std::size_t>(size) * size / (size < 512 ? 64 : 4)) << size;
  }
}

TEST(Lightmap, ChartsLieWithinTheMapAndFarEnoughApart) {
  const int size = 256;
  const Baked b = bake(many_shapes(), size, reader([](const ReadingPoint&) { return 1.f; }));
  // Texels that filtering can ask for, by chart.
  std::vector<std::uint32_t> owner(static_cast<std::size_t>(size) * size, ChartId::kInvalid);
  for (const LitPrimitive& p : b.mesh.primitives)
    for (std::size_t t = 0; t < p.triangles.size(); ++t) {
      const ChartId chart = b.map.charts.of({p.sources[t], p.back});
      for (const std::uint32_t v : p.triangles[t]) {
        const Vec2 from = p.lightmap_uvs[v] * static_cast<float>(size) - 0.5f;
        const Vec2 low = glm::floor(from), share = from - low;
        for (int k = 0; k < 4; ++k) {
          const int x = static_cast<int>(low.x) + k % 2, y = static_cast<int>(low.y) + k / 2;
          const Vec2 weight(k % 2 != 0 ? share.x : 1.f - share.x,
                            k / 2 != 0 ? share.y : 1.f - share.y);
          if (weight.x * weight.y < 1e-3f) continue;  // borders lie on centres, but for rounding
          ASSERT_TRUE(x >= 0 && y >= 0 && x < size && y < size);
          owner[static_cast<std::size_t>(y) * size + x] = chart.value;
        }
      }
    }
  const auto padding = [&](std::uint32_t chart) {
    return b.map.layout.placed[ChartId(chart)].padding;
  };
  int least = size;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const std::uint32_t here = owner[static_cast<std::size_t>(y) * size + x];
      if (here == ChartId::kInvalid) continue;
      for (int dy = -5; dy <= 5; ++dy)
        for (int dx = -5; dx <= 5; ++dx) {
          if (x + dx < 0 || y + dy < 0 || x + dx >= size || y + dy >= size) continue;
          const std::uint32_t there = owner[static_cast<std::size_t>(y + dy) * size + x + dx];
          if (there == ChartId::kInvalid || there == here) continue;
          const int apart = std::max(std::abs(dx), std::abs(dy));
          EXPECT_GE(apart, padding(here) + padding(there) + 1) << x << " " << y;
          least = std::min(least, apart);
        }
    }
  EXPECT_LE(least, 5) << "charts are packed closely enough for this test to mean something";
}

TEST(Lightmap, ShowsTheLightOfEveryPlace) {
  const auto light = [](const Vec3& p) { return 1.f + 0.1f * p.x + 0.05f * p.y - 0.08f * p.z; };
  const int size = 512;
  const Baked b =
      bake(many_shapes(), size, reader([&](const ReadingPoint& p) { return light(p.position); }));
  const float texel = 1.f / b.map.layout.texels_per_metre;
  std::size_t checked = 0;
  for (const TexelTriangle& t : triangles_in_map(b.mesh.primitives, size)) {
    // Of a chart below a texel all is one light.
    for (const Vec2 w :
         {Vec2(0.02f, 0.02f), Vec2(0.96f, 0.02f), Vec2(1.f / 3.f), Vec2(0.5f, 0.f)}) {
      const Vec2 at =
          t.corners[0] + w.x * (t.corners[1] - t.corners[0]) + w.y * (t.corners[2] - t.corners[0]);
      const Rgb seen = bilinear(b.map.irradiance, at);
      EXPECT_NEAR(seen.g, light(t.at(w)) + kIndirect, 0.25f * texel) << checked;
      ++checked;
    }
  }
  EXPECT_GT(checked, 4000u);
}

TEST(Lightmap, TexelCentresOffSeamsAndCreasesHoldTheReadingThere) {
  const auto light = [](const Vec3& p) {
    return 2.f + std::sin(9.f * p.x + 5.f * p.y - 7.f * p.z);
  };
  const int size = 512;
  const Baked b =
      bake(many_shapes(), size, reader([&](const ReadingPoint& p) { return light(p.position); }));
  std::set<std::uint32_t> at_seams;
  for (const ChartSeam& seam : b.map.charts.seams)
    for (const ChartId chart : seam.charts)
      for (float along = 0.f; along <= 1.f; along += 0.01f) {
        const Vec2 p = b.map.layout.to_texels(b.map.charts, chart,
                                              glm::mix(seam.ends[0], seam.ends[1], along));
        for (int dy = -2; dy <= 2; ++dy)
          for (int dx = -2; dx <= 2; ++dx)
            at_seams.insert(static_cast<std::uint32_t>((static_cast<int>(p.y) + dy) * size +
                                                       static_cast<int>(p.x) + dx));
      }
  std::size_t checked = 0;
  for (const TexelTriangle& t : triangles_in_map(b.mesh.primitives, size)) {
    const ChartId chart = b.map.charts.of({t.primitive->sources[t.triangle], t.primitive->back});
    if (b.map.layout.placed[chart].single) continue;
    // Less than a texel from a side the reading may have been drawn off a crease.
    for_each_centre(t, 0.3f, [&](int x, int y, Vec2 w) {
      if (at_seams.count(static_cast<std::uint32_t>(y * size + x)) > 0) return;
      EXPECT_NEAR(b.map.irradiance.at(x, y).g, light(t.at(w)) + kIndirect, 2e-3f);
      ++checked;
    });
  }
  EXPECT_GT(checked, 20'000u);
}

TEST(Lightmap, DensityIsTheSameAllOver) {
  const Baked b = bake(many_shapes(), 512, reader([](const ReadingPoint&) { return 1.f; }));
  for (std::size_t i = 0; i < b.map.charts.charts.size(); ++i) {
    const PlacedChart& p = b.map.layout.placed[ChartId(i)];
    if (p.single) continue;
    for (int k = 0; k < 2; ++k) {
      const float length = b.map.charts.charts[ChartId(i)].size[k] * b.map.layout.texels_per_metre;
      const float got = p.texels_per_metre[k] * b.map.charts.charts[ChartId(i)].size[k];
      EXPECT_NEAR(got, length, 1.001f) << "stretched by at most a texel, to end on centres";
    }
  }
  // Projection compresses no length below 0.86 of what it is.
  for (const TexelTriangle& t : triangles_in_map(b.mesh.primitives, 512)) {
    const ChartId chart = b.map.charts.of({t.primitive->sources[t.triangle], t.primitive->back});
    const PlacedChart& placed = b.map.layout.placed[chart];
    if (placed.single) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& v = t.primitive->triangles[t.triangle];
      const float metres =
          glm::distance(t.primitive->positions[v[k]], t.primitive->positions[v[(k + 1) % 3]]);
      const Vec2 edge = (t.corners[(k + 1) % 3] - t.corners[k]) / placed.texels_per_metre;
      EXPECT_GT(glm::length(edge), 0.8f * metres);
      EXPECT_LT(glm::length(edge), 1.01f * metres);
    }
  }
}

TEST(Lightmap, SeamsOfABallAreMatched) {
  Scene scene;
  add_mesh(scene, grid(48, 24, on_sphere));
  // A hard shadow all across.
  const Baked b = bake(std::move(scene), 128, reader([](const ReadingPoint& p) {
                         return p.position.x + 0.3f * p.position.y > 0.1f ? 2.f : 0.5f;
                       }));
  EXPECT_GT(b.map.charts.charts.size(), 4u);
  EXPECT_GT(b.map.charts.seams.size(), 50u);
  EXPECT_GT(b.map.seam_difference_as_read, 0.02f);
  EXPECT_LT(b.map.seam_difference, 0.01f);
  EXPECT_LT(b.map.seam_difference, 0.2f * b.map.seam_difference_as_read);
}

TEST(Lightmap, PaddingContinuesTheLightOfItsChart) {
  QuadScene quads;
  quads.box({0, 0, 0}, {1, 1, 1}, quads.material(0.5f), true);
  // Each wall has its own light.
  const auto wall = [](const Vec3& n) { return 2.f + n.x + 0.5f * n.y + 0.25f * n.z; };
  const Baked b =
      bake(quads.scene, 128, reader([&](const ReadingPoint& p) { return wall(p.normal); }));
  ASSERT_EQ(b.map.charts.charts.size(), 12u) << "both sides of each wall are lit";
  for (std::size_t i = 0; i < 12; ++i) {
    const LightmapChart& chart = b.map.charts.charts[ChartId(i)];
    const PlacedChart& at = b.map.layout.placed[ChartId(i)];
    ASSERT_EQ(at.padding, 2);
    const float light = wall(glm::cross(chart.axis_u, chart.axis_v)) + kIndirect;
    for (int y = at.y; y < at.y + at.height; ++y)
      for (int x = at.x; x < at.x + at.width; ++x)
        EXPECT_NEAR(b.map.irradiance.at(x, y).r, light, 1e-4f);
  }
}

TEST(Lightmap, CoveredTexelsTakeTheLightBesideThem) {
  QuadScene quads;
  quads.quad({0, 0, 1}, {1, 0, 0}, {0, 0, -1}, quads.material(0.5f));
  const auto is_under_a_box = [](const Vec3& p) {
    return std::abs(p.x - 0.5f) < 0.2f && std::abs(p.z - 0.5f) < 0.2f;
  };
  const LightReader read = reader([&](const ReadingPoint& p) {
    return is_under_a_box(p.position) || p.normal.y < 0.f ? 0.f : 1.f;
  });
  const Baked b = bake(quads.scene, 64, read, [&](std::span<const ReadingPoint> points) {
    std::vector<std::uint8_t> covered;
    for (const ReadingPoint& p : points) covered.push_back(is_under_a_box(p.position));
    return covered;
  });
  EXPECT_GT(b.map.covered, 100u);
  const ChartId top = b.map.charts.of({TriangleId(std::size_t{0}), false});
  for (const Vec3 p : {Vec3(0.5f, 0, 0.5f), Vec3(0.295f, 0, 0.5f), Vec3(0.5f, 0, 0.705f)}) {
    const Vec2 at = b.map.layout.to_texels(b.map.charts, top, p);
    EXPECT_NEAR(bilinear(b.map.irradiance, at).g, 1.f + kIndirect, 1e-4f) << p.x << " " << p.z;
  }
}

TEST(Lightmap, BlackUnderABoxThatIsNotClosedDoesNotShowAroundIt) {
  QuadScene quads;
  quads.quad({0, 0, 1}, {1, 0, 0}, {0, 0, -1}, quads.material(0.5f));
  const auto is_under_a_box = [](const Vec3& p) { return p.x > 0.5f; };
  const LightReader read = [&](std::span<const ReadingPoint> points) {
    std::vector<Reading> readings(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!is_under_a_box(points[i].position) && points[i].normal.y > 0.f)
        readings[i] = {Rgb(1.f), Rgb(points[i].direct_only ? 0.f : 0.5f)};
    return readings;
  };
  const Baked b = bake(quads.scene, 64, read);
  const ChartId top = b.map.charts.of({TriangleId(std::size_t{0}), false});
  const auto seen = [&](float x) {
    return bilinear(b.map.irradiance, b.map.layout.to_texels(b.map.charts, top, {x, 0.f, 0.5f})).g;
  };
  EXPECT_GT(seen(0.499f), 0.99f);
  EXPECT_LT(seen(0.6f), 0.3f);
}

TEST(Lightmap, ChartsBelowATexelKeepTheirOwnLight) {
  Scene scene;
  Primitive p;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const Vec3 at(static_cast<float>(i % 60), 0.f, static_cast<float>(i / 60));
    for (const Vec3& corner : {Vec3(0.f), Vec3(0.1f, 0.f, 0.f), Vec3(0.f, 0.f, -0.1f)})
      p.positions.push_back(at + corner);
    p.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  add_mesh(scene, p);
  const auto light = [](const Vec3& at) {
    return 1.f + std::round(at.x) + 0.01f * std::round(at.z);
  };
  const LightReader read =
      reader([&](const ReadingPoint& q) { return q.normal.y > 0.f ? light(q.position) : 0.f; });
  const Baked b = bake(scene, 128, read);
  const auto triangles = triangles_in_map(b.mesh.primitives, 128);
  ASSERT_GE(triangles.size(), 3000u);
  for (const TexelTriangle& t : triangles) {
    if (t.primitive->back) continue;
    EXPECT_NEAR(bilinear(b.map.irradiance, t.corners[1]).g, light(t.at(Vec2(0.3f))) + kIndirect,
                1e-3f);
  }
  // 3,000 charts and their backs do not fit into 1,024 texels.
  LitMesh mesh = build_lit_mesh(b.scene, b.geometry, read, {});
  const auto map = bake_lightmap(b.scene, b.geometry, mesh.primitives, {read, nowhere}, 0.1f, 32);
  ASSERT_FALSE(map);
  EXPECT_THAT(map.error().line(), ::testing::HasSubstr("--lightmap"));
}

TEST(Lightmap, SameBytesWhateverTheThreads) {
  const LightReader read = reader([](const ReadingPoint& p) { return 2.f + p.position.y; });
  set_thread_count(1);
  const Baked one = bake(many_shapes(), 128, read);
  set_thread_count(3);
  const Baked three = bake(many_shapes(), 128, read);
  set_thread_count(0);
  EXPECT_EQ(one.map.irradiance.pixels, three.map.irradiance.pixels);
  ASSERT_EQ(one.mesh.primitives.size(), three.mesh.primitives.size());
  for (std::size_t i = 0; i < one.mesh.primitives.size(); ++i)
    EXPECT_EQ(one.mesh.primitives[i].lightmap_uvs, three.mesh.primitives[i].lightmap_uvs);
}

// Both files are read back by their specifications; texels are compared with sensors.
TEST(Lightmap, WrittenFilesHoldWhatSensorsRead) {
  QuadScene quads;
  quads.box({0, 0, 0}, {4, 3, 5}, quads.material(0.6f), true);
  quads.box({1, 0.2f, 1}, {2, 1, 2}, quads.material(0.4f), false);
  quads.quad({1.5f, 2.9f, 2}, {1, 0, 0}, {0, 0, 1}, quads.material(0.f, 10.f));
  const SolverState state =
      testing::solve(quads.scene, testing::options_of(LinkMaker::sampled, 0.1f));
  const SolutionReader solution(state, kMeshReading);
  const LightReader read = [&](std::span<const ReadingPoint> points) { return solution(points); };
  const World& world = *state.world;
  LitMeshOptions options;
  options.feature_size = state.options.feature_size;
  LitMesh mesh = build_lit_mesh(world.scene, world.geometry, read, options);
  const int size = 256;
  const auto map = bake_lightmap(
      world.scene, world.geometry, mesh.primitives,
      {read, [&](std::span<const ReadingPoint> points) { return solution.covered(points); }},
      options.feature_size, size);
  ASSERT_TRUE(map);
  const TemporaryFolder folder;
  ASSERT_TRUE(write_lit_glb(folder.path() / "lit.glb", world.scene, world.geometry, mesh.primitives,
                            1.f, {"lit.lightmap.exr", size}));
  ASSERT_TRUE(write_image(folder.path() / "lit.lightmap.exr", map->irradiance));

  const test::GlbFile file(folder.path() / "lit.glb");
  EXPECT_EQ(file.document["scenes"][0]["extras"]["lightmap"]["uri"], "lit.lightmap.exr");
  const auto picture = read_float_image(folder.path() / "lit.lightmap.exr");
  ASSERT_TRUE(picture);
  ASSERT_EQ(picture->width, size);
  double squares = 0.0, worst_direct = 0.0;
  std::size_t checked = 0;
  for (const auto& written : file.document["meshes"])
    for (const auto& primitive : written["primitives"]) {
      const auto& attributes = primitive["attributes"];
      const auto numbers = [&](const char* name) { return file.floats(attributes[name]); };
      const auto positions = numbers("POSITION"), normals = numbers("NORMAL"),
                 uvs = numbers("TEXCOORD_1");
      const auto indices = file.indices(primitive["indices"]);
      for (std::size_t i = 0; i < indices.size(); i += 3) {
        LitPrimitive one;  // the scene's nodes move nothing
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = indices[i + k];
          one.positions.emplace_back(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
          one.normals.emplace_back(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]);
          one.lightmap_uvs.emplace_back(uvs[2 * v], uvs[2 * v + 1]);
        }
        one.triangles.push_back({0, 1, 2});
        const TexelTriangle t = triangles_in_map({one}, size)[0];
        const TexelTriangle there{&one, 0, t.corners};
        for_each_centre(there, 0.26f, [&](int x, int y, Vec2 w) {
          if ((x * 7 + y * 3) % 11 != 0) return;
          const Vec3 n = one.normals[0], at = there.at(w);
          if (solution.is_covered({at, n, TriangleId(std::size_t{0})})) return;
          const Rgb light = picture->at(x, y);
          const Reading sensor = solution.read({at, n, {}});
          const double difference = static_cast<double>(light.g - sensor.irradiance().g);
          squares += difference * difference;
          worst_direct = std::max(worst_direct, static_cast<double>(sensor.direct.g - light.g));
          ++checked;
        });
      }
    }
  ASSERT_GT(checked, 1000u);
  const auto mean = static_cast<double>(map->mean_irradiance);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(checked)), 0.03 * mean);
  EXPECT_LT(worst_direct, 0.01 * mean) << "direct light is that of the place itself";
}

}  // namespace
}  // namespace halflight
