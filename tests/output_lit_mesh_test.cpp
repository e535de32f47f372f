#include "halflight/output/lit_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "halflight/base/parallel.h"
#include "halflight/output/exposure.h"

namespace halflight {
namespace {

using Light = std::function<Rgb(const ReadingPoint&)>;

LightReader reader(Light light) {
  return [light = std::move(light)](std::span<const ReadingPoint> points) {
    std::vector<Reading> readings(points.size());
    parallel_for(points.size(), 64, [&](std::size_t i) {
      readings[i].direct = 0.75f * light(points[i]);
      readings[i].indirect = 0.25f * light(points[i]);
    });
    return readings;
  };
}

// Light that reaches upper sides only.
LightReader from_above(Light light) {
  return reader([light = std::move(light)](const ReadingPoint& p) {
    return p.normal.y > 0.f ? light(p) : Rgb(0.f);
  });
}

// Quads a b c d (counter-clockwise) of one primitive.
using Quad = std::array<Vec3, 4>;

void add_primitive(Scene& s, const std::vector<Quad>& quads, bool shared_vertices = false) {
  Primitive p;
  p.material = s.materials.push_back({});
  for (const Quad& q : quads) {
    std::array<std::uint32_t, 4> index{};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto found = std::find(p.positions.begin(), p.positions.end(), q[k]);
      if (shared_vertices && found != p.positions.end()) {
        index[k] = static_cast<std::uint32_t>(found - p.positions.begin());
      } else {
        index[k] = static_cast<std::uint32_t>(p.positions.size());
        p.positions.push_back(q[k]);
      }
    }
    p.triangles.push_back({index[0], index[1], index[2]});
    p.triangles.push_back({index[0], index[2], index[3]});
  }
  Node n;
  n.mesh = s.meshes.push_back(Mesh{"", {p}});
  s.nodes.push_back(n);
}

// Square [0, size]^2 on the floor, facing up.
Quad floor_quad(float size) { return {Vec3(0, 0, size), {size, 0, size}, {size, 0, 0}, {0, 0, 0}}; }

// The faces of the box [0, 1]^3 facing outwards, or inwards.
std::vector<Quad> box_quads(bool inwards) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0);
  const Vec3 e(0, 0, 1), f(1, 0, 1), g(1, 1, 1), h(0, 1, 1);
  std::vector<Quad> quads{{a, d, c, b}, {e, f, g, h}, {a, b, f, e},
                          {d, h, g, c}, {a, e, h, d}, {b, c, g, f}};
  if (inwards)
    for (Quad& q : quads) std::swap(q[1], q[3]);
  return quads;
}

LitMeshOptions options_for(float feature_size) {
  LitMeshOptions o;
  o.feature_size = feature_size;
  return o;
}

std::vector<float> edge_lengths(const LitPrimitive& p) {
  std::vector<float> lengths;
  for (const auto& t : p.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      lengths.push_back(glm::distance(p.positions[t[k]], p.positions[t[(k + 1) % 3]]));
  return lengths;
}

TEST(LitMesh, LinearLightIsNotSubdividedBeyondTheCoarseLength) {
  Scene s;
  add_primitive(s, {floor_quad(10.f)});
  const LitMesh lit = build_lit_mesh(
      s, flatten(s), from_above([](const ReadingPoint& p) { return Rgb(1.f + p.position.x); }),
      options_for(0.5f));
  ASSERT_EQ(lit.primitives.size(), 1u);
  const auto lengths = edge_lengths(lit.primitives[0]);
  EXPECT_LE(*std::max_element(lengths.begin(), lengths.end()), 2.0f);
  EXPECT_GE(*std::min_element(lengths.begin(), lengths.end()), 0.5f * 2.0f / std::sqrt(2.f));
}

TEST(LitMesh, SurfacesWithoutLightStayCoarser) {
  Scene s;
  add_primitive(s, {floor_quad(10.f)});
  const LitMesh lit = build_lit_mesh(
      s, flatten(s), reader([](const ReadingPoint&) { return Rgb(0.f); }), options_for(0.1f));
  EXPECT_LT(lit.triangles, 100u);  // 1,250 squares of 4 s elsewhere
  EXPECT_FALSE(lit.limited);
}

// Interpolated irradiance at points of the floor.
struct FloorLight {
  const LitPrimitive& p;

  float at(float x, float z) const {
    for (const auto& t : p.triangles) {
      const Vec3 a = p.positions[t[0]], b = p.positions[t[1]], c = p.positions[t[2]];
      const auto doubled_area = [](Vec3 u, Vec3 v, float px, float pz) {
        return (v.x - u.x) * (pz - u.z) - (v.z - u.z) * (px - u.x);
      };
      const float whole = doubled_area(a, b, c.x, c.z);
      const float wa = doubled_area(b, c, x, z) / whole, wb = doubled_area(c, a, x, z) / whole;
      if (wa < -1e-4f || wb < -1e-4f || wa + wb > 1.0002f) continue;
      return wa * p.irradiance[t[0]].x + wb * p.irradiance[t[1]].x +
             (1.f - wa - wb) * p.irradiance[t[2]].x;
    }
    return -1.f;
  }
};

TEST(LitMesh, AShadowEdgeIsResolvedToTheFinestLengthAndOnlyThere) {
  Scene s;
  add_primitive(s, {floor_quad(4.f)});
  const float feature_size = 0.1f, finest = feature_size / 2.f;
  const auto shadow_distance = [](float x, float z) {
    return std::hypot(x - 1.9f, z - 2.2f) - 1.1f;
  };
  const LitMesh lit = build_lit_mesh(s, flatten(s), from_above([&](const ReadingPoint& p) {
                                       const float d = shadow_distance(p.position.x, p.position.z);
                                       return Rgb(d < 0.f ? 0.1f : 1.f);
                                     }),
                                     options_for(feature_size));
  ASSERT_EQ(lit.primitives.size(), 1u);
  const LitPrimitive& p = lit.primitives[0];
  std::size_t crossing = 0, too_long = 0;
  for (const auto& t : p.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = p.positions[t[k]], b = p.positions[t[(k + 1) % 3]];
      if (shadow_distance(a.x, a.z) * shadow_distance(b.x, b.z) >= 0.f) continue;
      ++crossing;
      too_long += glm::distance(a, b) > finest * 1.001f;
    }
  EXPECT_GT(crossing, 100u);
  EXPECT_EQ(too_long, 0u);
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) {
      const float x = 0.01f + 3.98f * static_cast<float>(i) / 59.f;
      const float z = 0.01f + 3.98f * static_cast<float>(j) / 59.f;
      const float d = shadow_distance(x, z);
      if (std::abs(d) < 2.f * finest) continue;
      EXPECT_NEAR((FloorLight{p}.at(x, z)), d < 0.f ? 0.1f : 1.f, 0.02f) << x << " " << z;
    }
  // About 4 rows of vertices along the circle, where a uniform mesh would need 6,400.
  EXPECT_LT(lit.vertices, 2500u);
}

// Light with features of all sizes on all sides of the unit box.
Rgb busy_light(const ReadingPoint& p) {
  const Vec3 q = p.position;
  const bool dark = glm::distance(q, Vec3(1.f, 0.9f, 0.3f)) < 0.5f || q.x + 0.3f * q.y < 0.2f;
  return Rgb(dark ? 0.1f : 1.f + std::sin(9.f * q.z));
}

using Place = std::array<float, 3>;
Place place(const Vec3& v) { return {v.x, v.y, v.z}; }

TEST(LitMesh, EveryEdgeOfARefinedClosedBoxIsSharedByTwoTriangles) {
  Scene s;  // three primitives with vertices of their own
  const auto quads = box_quads(false);
  for (std::size_t i = 0; i < 6; i += 2) add_primitive(s, {quads[i], quads[i + 1]});
  const Geometry g = flatten(s);
  const LitMesh lit = build_lit_mesh(s, g, reader([](const ReadingPoint& p) {
                                       const bool outwards =
                                           glm::dot(p.normal, p.position - Vec3(0.5f)) > 0.f;
                                       return outwards ? busy_light(p) : Rgb(0.f);
                                     }),
                                     options_for(0.05f));
  std::map<std::pair<Place, Place>, int> uses;
  for (const LitPrimitive& p : lit.primitives) {
    EXPECT_FALSE(p.back);
    for (const auto& t : p.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        ++uses[{place(p.positions[t[k]]), place(p.positions[t[(k + 1) % 3]])}];
  }
  ASSERT_GT(lit.triangles, 2000u);
  std::size_t cracks = 0;
  for (const auto& [edge, count] : uses) {
    const auto other = uses.find({edge.second, edge.first});
    cracks += count != 1 || other == uses.end() || other->second != 1;
  }
  EXPECT_EQ(cracks, 0u);
}

TEST(LitMesh, PartsOfATriangleCoverItExactly) {
  Scene s;
  add_primitive(s, box_quads(false), true);
  add_primitive(s, {Quad{Vec3(2, 0, 0), {5, 0.2f, 0}, {5, 0.3f, 0}, {2, 0.01f, 0}}});  // slivers
  const Geometry g = flatten(s);
  const LitMesh lit = build_lit_mesh(s, g, reader(busy_light), options_for(0.1f));
  std::map<std::pair<std::uint32_t, bool>, double> area;
  for (const LitPrimitive& p : lit.primitives)
    for (std::size_t i = 0; i < p.triangles.size(); ++i) {
      const auto& t = p.triangles[i];
      const Vec3 a = p.positions[t[0]], b = p.positions[t[1]], c = p.positions[t[2]];
      const Vec3 n = 0.5f * glm::cross(b - a, c - a);
      const Vec3 whole = g.scaled_normal(p.sources[i]) * (p.back ? -1.f : 1.f);
      EXPECT_GT(glm::dot(n, whole), 0.f);
      area[{p.sources[i].value, p.back}] += static_cast<double>(glm::length(n));
    }
  for (const auto& [source, sum] : area) {
    const double whole = 0.5 * glm::length(g.scaled_normal(TriangleId(source.first)));
    EXPECT_NEAR(sum, whole, 1e-5 * whole);
  }
}

TEST(LitMesh, TextureCoordinatesStayLinearOverTheInputTriangle) {
  Scene s;
  add_primitive(s, {floor_quad(1.f)});
  Primitive& p = s.meshes[MeshId(0)].primitives[0];
  for (const Vec3& v : p.positions) p.uvs[0].push_back({3.f * v.x, 2.f - v.z});
  const LitMesh lit = build_lit_mesh(s, flatten(s), reader(busy_light), options_for(0.1f));
  for (const LitPrimitive& out : lit.primitives) {
    ASSERT_EQ(out.uvs[0].size(), out.positions.size());
    EXPECT_TRUE(out.uvs[1].empty());
    for (std::size_t i = 0; i < out.positions.size(); ++i) {
      EXPECT_NEAR(out.uvs[0][i].x, 3.f * out.positions[i].x, 1e-5f);
      EXPECT_NEAR(out.uvs[0][i].y, 2.f - out.positions[i].z, 1e-5f);
    }
  }
}

TEST(LitMesh, CornersOfARoomAreNotReadInsideTheNextWall) {
  Scene s;
  add_primitive(s, box_quads(true), true);
  // Black within a hair of any wall but the one the point lies on.
  const LitMesh lit = build_lit_mesh(s, flatten(s), reader([](const ReadingPoint& p) {
                                       const Vec3 off_wall = p.position + 1e-3f * p.normal;
                                       const bool inside = min_component(off_wall) > 1e-4f &&
                                                           max_component(off_wall) < 0.9999f;
                                       return Rgb(inside ? 1.f : 0.f);
                                     }),
                                     options_for(0.2f));
  ASSERT_GT(lit.vertices, 24u);
  for (const LitPrimitive& p : lit.primitives) {
    EXPECT_FALSE(p.back);
    for (const Rgb& e : p.irradiance) EXPECT_EQ(e.x, 1.f);
  }
}

TEST(LitMesh, LightDoesNotLeakUnderAThinWall) {
  Scene s;
  std::vector<Quad> floor;
  for (int x = 0; x < 2; ++x)
    for (int z = 0; z < 2; ++z) {
      Quad q = floor_quad(1.f);
      for (Vec3& v : q) v += Vec3(x, 0, z);
      floor.push_back(q);
    }
  add_primitive(s, floor, true);
  add_primitive(s,
                {Quad{Vec3(1, 0, 0), {1, 0, 1}, {1, 1, 1}, {1, 1, 0}},
                 Quad{Vec3(1, 0, 1), {1, 0, 2}, {1, 1, 2}, {1, 1, 1}}},
                true);
  // The wall at x = 1 parts light from dark.
  const LitMesh lit =
      build_lit_mesh(s, flatten(s), reader([](const ReadingPoint& p) {
                       return Rgb(p.position.x + 1e-3f * p.normal.x < 1.f ? 1.f : 0.f);
                     }),
                     options_for(0.2f));
  for (const LitPrimitive& p : lit.primitives) {
    if (p.instance != InstanceId(0)) continue;
    for (const auto& t : p.triangles) {
      const Vec3 center = (p.positions[t[0]] + p.positions[t[1]] + p.positions[t[2]]) / 3.f;
      for (const std::uint32_t v : t) EXPECT_EQ(p.irradiance[v].x, center.x < 1.f ? 1.f : 0.f);
    }
  }
}

TEST(LitMesh, AShortWallInsideAFloorPartsTheLightAtItsFoot) {
  Scene s;
  std::vector<Quad> floor;
  for (int x = 0; x < 2; ++x)
    for (int z = 0; z < 3; ++z) {
      Quad q = floor_quad(1.f);
      for (Vec3& v : q) v += Vec3(x, 0, z);
      floor.push_back(q);
    }
  add_primitive(s, floor, true);
  add_primitive(s, {Quad{Vec3(1, 0, 1), {1, 0, 2}, {1, 1, 2}, {1, 1, 1}}});
  const LitMesh lit =
      build_lit_mesh(s, flatten(s), reader([](const ReadingPoint& p) {
                       return Rgb(p.position.x + 1e-3f * p.normal.x < 1.f ? 1.f : 0.f);
                     }),
                     options_for(0.2f));
  std::set<float> at_the_foot;
  for (const LitPrimitive& p : lit.primitives)
    for (std::size_t i = 0; i < p.positions.size(); ++i)
      if (p.instance == InstanceId(0) && p.positions[i] == Vec3(1, 0, 1.5f))
        at_the_foot.insert(p.irradiance[i].x);
  EXPECT_EQ(at_the_foot, (std::set<float>{0.f, 1.f}));
}

TEST(LitMesh, AWallThatRunsOnBehindTheCeilingHasNoDarkRim) {
  Scene s;
  add_primitive(s, {Quad{Vec3(0, 0, 0), {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}});
  const float ceiling = 0.7f;
  const LitMesh lit =
      build_lit_mesh(s, flatten(s), reader([&](const ReadingPoint& p) {
                       return Rgb(p.normal.z > 0.f && p.position.y < ceiling ? 1.f : 0.f);
                     }),
                     options_for(0.2f));
  std::size_t below = 0;
  for (const auto& t : lit.primitives[0].triangles) {
    float lowest = kInfinity;
    for (const std::uint32_t v : t) lowest = std::min(lowest, lit.primitives[0].positions[v].y);
    if (lowest >= ceiling) continue;
    ++below;
    for (const std::uint32_t v : t) EXPECT_EQ(lit.primitives[0].irradiance[v].x, 1.f);
  }
  EXPECT_GT(below, 20u);
}

TEST(LitMesh, AWallWoundAwayFromItsRoomIsShownFromTheRoom) {
  Scene s;
  Quad down = floor_quad(1.f);
  std::swap(down[1], down[3]);
  add_primitive(s, {down});
  const LitMesh lit = build_lit_mesh(s, flatten(s), reader([](const ReadingPoint& p) {
                                       return Rgb(p.normal.y > 0.f ? 1.f : 0.f);
                                     }),
                                     options_for(1.f));
  ASSERT_EQ(lit.primitives.size(), 1u);
  const LitPrimitive& p = lit.primitives[0];
  EXPECT_TRUE(p.back);
  for (const auto& t : p.triangles) {
    const Vec3 a = p.positions[t[0]], b = p.positions[t[1]], c = p.positions[t[2]];
    EXPECT_GT(glm::cross(b - a, c - a).y, 0.f);
    for (const std::uint32_t v : t) {
      EXPECT_EQ(p.normals[v].y, 1.f);
      EXPECT_EQ(p.irradiance[v].x, 1.f);
    }
  }
}

TEST(LitMesh, ACurtainKeepsTheLightOfBothItsSides) {
  Scene s;
  add_primitive(s, {floor_quad(1.f)});
  const LitMesh lit = build_lit_mesh(s, flatten(s), reader([](const ReadingPoint& p) {
                                       return Rgb(p.normal.y > 0.f ? 1.f : 2.f);
                                     }),
                                     options_for(1.f));
  ASSERT_EQ(lit.primitives.size(), 2u);
  for (const LitPrimitive& p : lit.primitives)
    for (std::size_t i = 0; i < p.positions.size(); ++i)
      EXPECT_EQ(p.irradiance[i].x, p.back ? 2.f : 1.f);
}

TEST(LitMesh, AFlatShadedCylinderIsLitSmoothlyAndABoxIsNot) {
  constexpr int kFacets = 24;
  std::vector<Quad> cylinder;
  for (int i = 0; i < kFacets; ++i) {
    const auto rim = [&](int k, float y) {
      const float phi = 2.f * kPi * static_cast<float>(k % kFacets) / kFacets;
      return Vec3(0.1f * std::cos(phi), y, -0.1f * std::sin(phi));
    };
    cylinder.push_back({rim(i, 0), rim(i + 1, 0), rim(i + 1, 1), rim(i, 1)});
  }
  const auto cosine = reader([](const ReadingPoint& p) { return Rgb(2.f + p.normal.x); });
  const auto readings_per_place = [&](const std::vector<Quad>& quads) {
    Scene s;
    add_primitive(s, quads);
    const LitMesh lit = build_lit_mesh(s, flatten(s), cosine, options_for(10.f));
    std::map<Place, std::set<float>> seen;
    for (const LitPrimitive& p : lit.primitives)
      if (!p.back)
        for (std::size_t i = 0; i < p.positions.size(); ++i)
          seen[place(p.positions[i])].insert(p.irradiance[i].x);
    std::size_t most = 0;
    for (const auto& [where, values] : seen) most = std::max(most, values.size());
    return most;
  };
  EXPECT_EQ(readings_per_place(cylinder), 1u);
  EXPECT_EQ(readings_per_place(box_quads(false)), 3u - 1u);  // two of three normals share x = 0
}

TEST(LitMesh, StaysBelowTheVertexLimitAndSaysSo) {
  Scene s;
  add_primitive(s, box_quads(true), true);
  LitMeshOptions options = options_for(0.02f);
  options.max_vertices = 1000;
  const LitMesh lit = build_lit_mesh(s, flatten(s), reader(busy_light), options);
  EXPECT_LE(lit.vertices, 1000u);
  EXPECT_GT(lit.vertices, 250u);
  EXPECT_TRUE(lit.limited);
  EXPECT_GT(lit.largest_error_left, options.tolerance);
}

TEST(LitMesh, IsTheSameForAnyThreadCount) {
  Scene s;
  add_primitive(s, box_quads(true));
  const Geometry g = flatten(s);
  set_thread_count(1);
  const LitMesh one = build_lit_mesh(s, g, reader(busy_light), options_for(0.05f));
  set_thread_count(0);
  const LitMesh all = build_lit_mesh(s, g, reader(busy_light), options_for(0.05f));
  ASSERT_EQ(one.primitives.size(), all.primitives.size());
  for (std::size_t i = 0; i < one.primitives.size(); ++i) {
    EXPECT_EQ(one.primitives[i].positions, all.primitives[i].positions);
    EXPECT_EQ(one.primitives[i].irradiance, all.primitives[i].irradiance);
    EXPECT_EQ(one.primitives[i].triangles, all.primitives[i].triangles);
  }
}

TEST(AutomaticExposure, ShowsNearlyAllLitAreaBelowSaturation) {
  Scene s;
  add_primitive(s, {floor_quad(1.f)});
  const Geometry g = flatten(s);
  // Irradiance 0 to 10 across the floor: 98 % of the lit area lies below 9.8.
  const LitMesh lit = build_lit_mesh(
      s, g, from_above([](const ReadingPoint& p) { return Rgb(10.f * p.position.x); }),
      options_for(0.005f));
  const float exposure = automatic_exposure(s, g, lit.primitives);
  EXPECT_NEAR(exposure * 9.8f / kPi, 0.9f, 0.005f);
  EXPECT_EQ(automatic_exposure(s, g, {}), 1.f);
}

}  // namespace
}  // namespace halflight
