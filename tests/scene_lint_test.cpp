#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "halflight/scene/lint.h"

namespace halflight {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::Not;

// A unit square at height y that faces up or down.
Primitive square(float y, bool faces_up, MaterialId material) {
  Primitive p;
  p.positions = {{0, y, 0}, {0, y, 1}, {1, y, 1}, {1, y, 0}};
  if (!faces_up) std::ranges::reverse(p.positions);
  p.triangles = {{0, 1, 2}, {0, 2, 3}};
  p.material = material;
  return p;
}

// A grey floor below a lamp of radiance 2 that shines down on it.
Scene lamp_over_floor() {
  Scene scene;
  Material lamp;
  lamp.name = "lamp";
  lamp.emission = Rgb(2.f);
  const MaterialId grey = scene.materials.push_back({});
  const MaterialId light = scene.materials.push_back(lamp);
  Node node;
  node.mesh = scene.meshes.push_back({"", {square(0, true, grey), square(1, false, light)}});
  scene.nodes.push_back(node);
  return scene;
}

std::vector<std::string> codes(const Scene& scene) {
  const Geometry g = flatten(scene);
  std::vector<std::string> found;
  for (const Finding& finding : lint(scene, g, summarize(scene, g))) found.push_back(finding.code);
  return found;
}

Primitive& primitive(Scene& scene, std::size_t i) { return scene.meshes[MeshId(0)].primitives[i]; }

TEST(Lint, ASoundSceneHasNoFindings) { EXPECT_THAT(codes(lamp_over_floor()), IsEmpty()); }

TEST(Lint, WithoutAnyLightItSaysSo) {
  Scene scene = lamp_over_floor();
  scene.materials[MaterialId(1)].emission = Rgb(0.f);
  EXPECT_THAT(codes(scene), Contains("no-light"));
  scene.sky = Rgb(1.f);
  EXPECT_THAT(codes(scene), Not(Contains("no-light")));
}

TEST(Lint, AnEmitterWithNothingInFrontFacesAway) {
  Scene scene = lamp_over_floor();
  primitive(scene, 1) = square(1, true, MaterialId(1));
  EXPECT_THAT(codes(scene), Contains("emitter-faces-away"));
  scene.materials[MaterialId(1)].double_sided = true;
  EXPECT_THAT(codes(scene), Not(Contains("emitter-faces-away")));
}

TEST(Lint, ColoursAboveOneAndAllWhiteScenesAreSuspect) {
  Scene scene = lamp_over_floor();
  scene.materials[MaterialId(0)].reflectance = Rgb(0.2f, 1.5f, 0.2f);
  EXPECT_THAT(codes(scene), Contains("reflectance-above-one"));
  scene.materials[MaterialId(0)].reflectance = Rgb(1.f);
  EXPECT_THAT(codes(scene), Contains("nearly-white"));
  EXPECT_THAT(codes(scene), Not(Contains("reflectance-above-one")));
}

TEST(Lint, TheSameTriangleTwiceIsFoundWhicheverWayRound) {
  Scene scene = lamp_over_floor();
  scene.meshes[MeshId(0)].primitives.push_back(square(0, false, MaterialId(0)));
  EXPECT_EQ(count_duplicate_triangles(flatten(scene)), 0u);  // cut along the other diagonal
  std::swap(primitive(scene, 2).triangles[0], primitive(scene, 2).triangles[1]);
  primitive(scene, 2).triangles = {{1, 2, 3}, {1, 3, 0}};
  EXPECT_EQ(count_duplicate_triangles(flatten(scene)), 2u);
  EXPECT_THAT(codes(scene), Contains("duplicate-triangles"));
}

TEST(Lint, MillimetresTakenAsMetresAndFarAwayScenesAreSuspect) {
  Scene scene = lamp_over_floor();
  scene.to_world = Mat4(1000.0);
  scene.to_world[3][3] = 1.0;
  EXPECT_THAT(codes(scene), Contains("suspicious-size"));
  scene.to_world = Mat4(1.0);
  EXPECT_THAT(codes(scene), Not(Contains("far-from-origin")));
  scene.to_world[3][0] = 1e3;
  EXPECT_THAT(codes(scene), Contains("far-from-origin"));
}

TEST(Lint, OneCornerFarAwayIsSuspect) {
  Scene scene = lamp_over_floor();
  for (int i = 0; i < 20; ++i) scene.nodes.push_back(scene.nodes[NodeId(std::size_t{0})]);
  EXPECT_THAT(codes(scene), Not(Contains("far-from-origin")));
  scene.nodes.push_back(scene.nodes[NodeId(std::size_t{0})]);
  scene.nodes[NodeId(std::size_t{21})].local[3][0] = 1e5;
  EXPECT_THAT(codes(scene), Contains("far-from-origin"));
}

TEST(Lint, TrianglesWithoutAreaMissingPicturesAndDimLampsAreFound) {
  Scene scene = lamp_over_floor();
  primitive(scene, 0).triangles.push_back({0, 1, 1});
  scene.textures.push_back({});
  scene.materials[MaterialId(1)].emission = Rgb(1e-6f);
  EXPECT_THAT(codes(scene), testing::UnorderedElementsAre("degenerate-triangles", "missing-texture",
                                                          "dim-emitter"));
}

TEST(Summary, EmittedPowerIsPiTimesAreaTimesRadiancePerSide) {
  Scene scene = lamp_over_floor();
  const auto power = [&] { return summarize(scene, flatten(scene)).emitted_power.r; };
  EXPECT_NEAR(power(), 2.f * kPi, 1e-5f);
  scene.materials[MaterialId(1)].double_sided = true;
  EXPECT_NEAR(power(), 4.f * kPi, 1e-5f);
  scene.to_world = Mat4(0.5);
  scene.to_world[3][3] = 1.0;
  EXPECT_NEAR(power(), kPi, 1e-5f);
}

TEST(Summary, MeanReflectanceIsWeightedByAreaAndLeavesEmittersOut) {
  Scene scene = lamp_over_floor();
  Material dark;
  dark.reflectance = Rgb(0.1f);
  Primitive half = square(0.5f, true, scene.materials.push_back(dark));
  half.triangles.pop_back();
  scene.meshes[MeshId(0)].primitives.push_back(half);
  const SceneSummary s = summarize(scene, flatten(scene));
  EXPECT_NEAR(s.reflectance.g, (0.5f * 1.f + 0.1f * 0.5f) / 1.5f, 1e-6f);
  EXPECT_NEAR(s.area, 2.5, 1e-6);
}

// A node of no size leaves a lamp or a camera nowhere to point; one that is only tiny does not.
TEST(Lint, LightsAndCamerasNeedADirectionAndAPlace) {
  const auto with = [](const Mat4& local, Light::Kind kind) {
    Scene scene = lamp_over_floor();
    Node node;
    node.local = local;
    Light light;
    light.kind = kind;
    node.light = scene.lights.push_back(light);
    node.camera = scene.cameras.push_back({});
    scene.nodes.push_back(node);
    return scene;
  };
  const auto scaled = [](double s) {
    return Mat4(glm::dvec4(s, 0, 0, 0), glm::dvec4(0, s, 0, 0), glm::dvec4(0, 0, s, 0),
                glm::dvec4(0, 0, 0, 1));
  };
  Mat4 far(1.0);
  far[3].x = 1e20;
  for (const auto kind : {Light::Kind::spot, Light::Kind::directional}) {
    for (const Mat4& local : {scaled(0.0), scaled(std::numeric_limits<double>::infinity())}) {
      const Scene scene = with(local, kind);
      EXPECT_THAT(codes(scene),
                  testing::IsSupersetOf({"light-without-place", "camera-without-place"}));
      EXPECT_THAT(flatten(scene).lights, IsEmpty());
    }
    for (const double tiny : {1e-30, 1e-170}) {
      const Geometry g = flatten(with(scaled(tiny), kind));
      ASSERT_EQ(g.lights.size(), 1u);
      EXPECT_EQ(g.lights[0].direction, Vec3(0.f, 0.f, -1.f));
      EXPECT_TRUE(can_look(g.cameras[0]));
    }
  }
  EXPECT_THAT(flatten(with(far, Light::Kind::point)).lights, IsEmpty());
  EXPECT_FALSE(can_look(flatten(with(far, Light::Kind::point)).cameras[0]));
  EXPECT_EQ(flatten(with(far, Light::Kind::directional)).lights.size(), 1u);
  EXPECT_EQ(flatten(with(scaled(0.0), Light::Kind::point)).lights.size(), 1u);
}

}  // namespace
}  // namespace halflight
