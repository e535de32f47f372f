// The solver's sensors against the path tracer, which shares no radiosity code with it.
#include <gtest/gtest.h>

#include "halflight/rays/reference_sensors.h"
#include "halflight/scene/procedural/cornell_box.h"
#include "halflight/scene/procedural/furnace.h"
#include "halflight/scene/procedural/office.h"
#include "quad_scene.h"
#include "solved_scene.h"

namespace halflight {
namespace {

using testing::QuadScene;

std::vector<float> path_traced(const World& world, const std::vector<ReadingPoint>& points,
                               std::uint32_t samples) {
  std::vector<WorldSensor> sensors;
  for (const ReadingPoint& p : points) sensors.push_back({p.position, p.normal});
  std::vector<float> irradiance;
  for (const auto& e : reference_irradiance(PathTracer(world), sensors, samples, 5, Progress()))
    irradiance.push_back(average(e.mean));
  return irradiance;
}

struct Deviation {
  float median = 0.f;      // of |E - E_ref| / E_ref where E_ref is above 5 % of its mean
  float rms = 0.f;         // of E - E_ref, all sensors, over the mean of E_ref
  float mean_ratio = 0.f;  // of the means of E and E_ref
};

Deviation compare(const SolverState& state, std::size_t sensors, std::uint32_t samples) {
  const auto points = scatter_points(state, sensors);
  const auto reference = path_traced(*state.world, points, samples);
  const auto solved = testing::read_irradiance(state, points);
  const float mean = testing::mean(reference);
  std::vector<float> relative;
  float squares = 0.f;
  for (std::size_t i = 0; i < sensors; ++i) {
    const float difference = std::abs(solved[i] - reference[i]);
    squares += difference * difference;
    if (reference[i] > 0.05f * mean) relative.push_back(difference / reference[i]);
  }
  return {testing::quantile(relative, 0.5f),
          std::sqrt(squares / static_cast<float>(sensors)) / mean, testing::mean(solved) / mean};
}

TEST(SolvedLight, OfTheCornellBoxIsThatOfThePathTracer) {
  for (const LinkMaker links : {LinkMaker::refined, LinkMaker::sampled}) {
    const SolverState state =
        testing::solve(cornell_box_scene(), testing::options_of(links, 0.01f));
    const Deviation d = compare(state, 150, 4096);
    const bool refined = links == LinkMaker::refined;
    EXPECT_LT(d.median, refined ? 0.04f : 0.02f);
    EXPECT_LT(d.rms, refined ? 0.06f : 0.03f);
    EXPECT_NEAR(d.mean_ratio, 1.f, refined ? 0.03f : 0.01f);
  }
}

// Many of its sensors lie in gaps far below the feature size: a few of them make the RMS.
TEST(SolvedLight, OfASmallOfficeIsThatOfThePathTracer) {
  OfficeParameters p;
  p.count = 60;
  const SolverState state =
      testing::solve(office_scene(p), testing::options_of(LinkMaker::sampled, 0.2f));
  const Deviation d = compare(state, 150, 2048);
  EXPECT_LT(d.median, 0.06f);
  EXPECT_LT(d.rms, 0.5f);
  EXPECT_NEAR(d.mean_ratio, 1.f, 0.03f);
}

// Rooms of one reflectance lit in odd ways. Each sensor's reference is known to about 0.5 %.
void expect_as_path_traced(const QuadScene& scene, float feature_size) {
  const SolverState state =
      testing::solve(scene.scene, testing::options_of(LinkMaker::sampled, feature_size));
  const Deviation d = compare(state, 60, 1u << 14);
  EXPECT_LT(d.median, 0.02f);
  EXPECT_LT(d.rms, 0.03f);
  EXPECT_NEAR(d.mean_ratio, 1.f, 0.01f);
}

// A room of 3 x 2.5 x 4 m whose wall at x = 0 has a window of 1 x 2 m.
QuadScene room_with_window() {
  QuadScene scene;
  const MaterialId white = scene.material(0.6f);
  scene.quad({0, 0, 0}, {0, 0, 4}, {3, 0, 0}, white);
  scene.quad({0, 2.5f, 0}, {3, 0, 0}, {0, 0, 4}, white);
  scene.quad({0, 0, 0}, {3, 0, 0}, {0, 2.5f, 0}, white);
  scene.quad({0, 0, 4}, {0, 2.5f, 0}, {3, 0, 0}, white);
  scene.quad({3, 0, 0}, {0, 0, 4}, {0, 2.5f, 0}, white);
  scene.quad({0, 0, 0}, {0, 2.5f, 0}, {0, 0, 1}, white);
  scene.quad({0, 0, 3}, {0, 2.5f, 0}, {0, 0, 1}, white);
  scene.quad({0, 0, 1}, {0, 0.8f, 0}, {0, 0, 2}, white);
  scene.quad({0, 1.8f, 1}, {0, 0.7f, 0}, {0, 0, 2}, white);
  return scene;
}

TEST(SolvedLight, SkyThroughAPaneOfGlass) {
  QuadScene scene = room_with_window();
  scene.quad({0, 0.8f, 1}, {0, 1, 0}, {0, 0, 2}, scene.pane(0.1f));
  scene.scene.sky = Rgb(2.f);
  expect_as_path_traced(scene, 0.2f);
}

TEST(SolvedLight, PointLightAmongBlocks) {
  QuadScene scene;
  scene.box({0, 0, 0}, {3, 2.5f, 4}, scene.material(0.6f), true);
  scene.box({0.5f, 0.01f, 0.5f}, {1.2f, 1.4f, 1.2f}, scene.material(0.4f), false);
  Light light;
  light.intensity = Rgb(100.f);
  scene.light_shining_down(light, {1.8f, 2, 1.7f});
  expect_as_path_traced(scene, 0.1f);
}

TEST(SolvedLight, SheetThatGlowsOnBothSides) {
  QuadScene scene;
  scene.box({0, 0, 0}, {3, 2.5f, 4}, scene.material(0.6f), true);
  scene.quad({1, 1, 1}, {1, 0.3f, 0}, {0, 0.4f, 1}, scene.material(0.3f, 5.f, true));
  expect_as_path_traced(scene, 0.2f);
}

// A board hangs 1 cm below the ceiling, with cells ten times as large: what is above it is dark.
TEST(SolvedLight, OfAGapFarBelowTheFeatureSizeIsThatOfThePathTracer) {
  QuadScene scene;
  scene.box({0, 0, 0}, {3, 2.5f, 4}, scene.material(0.6f), true);
  scene.quad({1, 2.49f, 1}, {1, 0, 0}, {0, 0, 1.5f}, scene.material(0.6f, 0.f, true));
  scene.quad({1, 1, 1}, {0.5f, 0, 0}, {0, 0, 0.5f}, scene.material(0.f, 8.f, true));
  const SolverState state =
      testing::solve(scene.scene, testing::options_of(LinkMaker::sampled, 0.3f));
  std::vector<ReadingPoint> points;
  for (int i = 0; i < 8; ++i) {
    const float along = 0.05f * static_cast<float>(i);
    for (const float x : {1.01f + along, 0.995f - 0.1f * along})
      points.push_back({{x, 2.5f, 1.7f}, {0, -1, 0}, {}});
  }
  const auto reference = path_traced(*state.world, points, 1u << 14);
  const auto read = testing::read_irradiance(state, points, sensor_reading(state));
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(read[i], reference[i], 0.02f * mean_irradiance(state)) << points[i].position.x;
}

// A white lamp shade of 20 cm, open below: its cells are few, and a hundred times as bright as the
// room's.
TEST(SolvedLight, InsideALampIsThatOfThePathTracer) {
  QuadScene scene;
  scene.box({0, 0, 0}, {3, 2.5f, 4}, scene.material(0.6f), true);
  const MaterialId shade = scene.material(0.8f);
  scene.quad({1.4f, 2.f, 1.9f}, {0.2f, 0, 0}, {0, 0, 0.2f}, shade);
  for (const float side : {0.f, 0.2f}) {
    scene.quad({1.4f + side, 1.8f, 1.9f}, {0, 0, 0.2f}, {0, 0.2f, 0}, shade);
    scene.quad({1.4f, 1.8f, 1.9f + side}, {0.2f, 0, 0}, {0, 0.2f, 0}, shade);
  }
  scene.quad({1.47f, 1.95f, 1.97f}, {0.06f, 0, 0}, {0, 0, 0.06f}, scene.material(0.f, 80.f));
  const SolverState state =
      testing::solve(scene.scene, testing::options_of(LinkMaker::sampled, 0.3f));
  const Vec3 middle(1.5f, 1.9f, 2.f);
  std::vector<ReadingPoint> inside;
  for (const ReadingPoint& p : scatter_points(state, 8000)) {
    const Vec3 inwards = middle - p.position;
    if (max_component(glm::abs(inwards)) < 0.11f && glm::dot(p.normal, inwards) > 0.05f)
      inside.push_back(p);
  }
  ASSERT_GT(inside.size(), 10u);
  const auto reference = path_traced(*state.world, inside, 1u << 14);
  EXPECT_GT(testing::mean(reference), 20.f * mean_irradiance(state));
  const auto error_of = [&](const ReadOptions& options) {
    const auto read = testing::read_irradiance(state, inside, options);
    float squares = 0.f;
    for (std::size_t i = 0; i < inside.size(); ++i)
      squares += (read[i] - reference[i]) * (read[i] - reference[i]);
    return std::sqrt(squares / static_cast<float>(inside.size())) / testing::mean(reference);
  };
  ReadOptions options = sensor_reading(state);
  EXPECT_LT(error_of(options), 0.02f);
  options.gather_rays = 0;
  EXPECT_LT(error_of(options), 0.04f) << "from cells, but for places as bright as these";
}

// A leaf is a square with a hole in its alpha map; it lies under a lamp and lets light through.
TEST(SolvedLight, HolesInLeavesPassLight) {
  QuadScene scene;
  scene.box({0, 0, 0}, {3, 2.5f, 4}, scene.material(0.6f), true);
  Texture holes;
  holes.width = holes.height = 4;
  holes.texels.assign(16, {255, 255, 255, 255});
  for (const std::size_t i : {5u, 6u, 9u, 10u}) holes.texels[i] = {255, 255, 255, 0};
  const MaterialId leaf = scene.material(0.5f);
  scene.scene.materials[leaf].alpha_mode = AlphaMode::blend;
  scene.scene.materials[leaf].alpha_texture.texture = scene.scene.textures.push_back(holes);
  scene.quad({0.5f, 1.2f, 0.8f}, {0, 0, 2.4f}, {2, 0, 0}, leaf);
  scene.quad({1, 2.4f, 1.5f}, {1, 0, 0}, {0, 0, 1}, scene.material(0.5f, 8.f));
  expect_as_path_traced(scene, 0.1f);
}

// 25 lamps of many sizes under the ceiling of a black room that holds a box.
QuadScene room_of_lamps() {
  QuadScene scene;
  const MaterialId black = scene.material(0.f);
  scene.box({0, 0, 0}, {3, 2.5f, 4}, black, true);
  scene.box({1, 0.01f, 1}, {1.8f, 1.2f, 1.9f}, black, false);
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 5; ++k) {
      const float size = 0.05f + 0.05f * static_cast<float>(i);
      scene.quad({0.3f + 0.5f * static_cast<float>(i), 2.4f, 0.3f + 0.7f * static_cast<float>(k)},
                 {size, 0, 0}, {0, 0, 0.3f}, scene.material(0.f, 1.f + static_cast<float>(k)));
    }
  return scene;
}

// Direct light alone, from the closed-form view of the emitter tree.
TEST(EmitterTreeLight, IsTheDirectLightOfThePathTracer) {
  const QuadScene scene = room_of_lamps();
  const SolverState state =
      make_state(make_world(scene.scene), testing::options_of(LinkMaker::sampled, 0.1f));
  const auto points = scatter_points(state, 150);
  const auto reference = path_traced(*state.world, points, 1u << 14);
  const EmitterTree emitters(*state.visibility, find_emitters(*state.world));
  std::vector<float> direct, deviation;
  const float scale = testing::mean(reference);
  for (std::size_t i = 0; i < points.size(); ++i) {
    direct.push_back(average(emitters.irradiance(points[i].position, points[i].normal, {})));
    deviation.push_back(std::abs(direct[i] - reference[i]) / std::max(reference[i], 0.02f * scale));
  }
  EXPECT_LT(testing::quantile(deviation, 0.5f), 0.01f);
  EXPECT_LT(testing::quantile(deviation, 0.95f), 0.06f);
  EXPECT_NEAR(testing::mean(direct) / scale, 1.f, 0.005f);
}

// Weak lamps are chosen at random, one ray each: right on average at every place, shadows included.
TEST(EmitterTreeLight, OfFewRaysIsRightOnAverage) {
  const SolverState state =
      make_state(make_world(room_of_lamps().scene), testing::options_of(LinkMaker::sampled, 0.1f));
  const EmitterTree emitters(*state.visibility, find_emitters(*state.world));
  const DirectLightOptions few{
      .shadow_rays = 2, .penumbra_rays = 2, .largest_group_share = 0.2f, .smallest_angle = 0.01f};
  const DirectLightOptions many{.shadow_rays = 2048,
                                .penumbra_rays = 2048,
                                .largest_group_share = 1e-4f,
                                .smallest_angle = 1e-4f};
  constexpr int kTries = 4000;
  for (const ReadingPoint& p : scatter_points(state, 40)) {
    const auto expected =
        static_cast<double>(average(emitters.irradiance(p.position, p.normal, many)));
    double sum = 0.0, squares = 0.0;
    for (int k = 0; k < kTries; ++k) {
      const auto e = static_cast<double>(
          average(emitters.irradiance(p.position, p.normal, few, random_shift(hash(k, 3)))));
      sum += e;
      squares += e * e;
    }
    const double mean = sum / kTries;
    const double noise = std::sqrt(std::max(0.0, squares / kTries - mean * mean) / kTries);
    EXPECT_NEAR(mean, expected, 4.0 * noise + 0.01 * expected)
        << p.position.x << ", " << p.position.y << ", " << p.position.z;
  }
}

// Among black glowing cubes in a black glowing room every point receives pi L.
TEST(EmitterTreeLight, IsPiLWhereverOneLooksInAFurnace) {
  FurnaceParameters furnace;
  furnace.reflectance = 0.f;
  furnace.boxes = 27;
  const SolverState state =
      make_state(make_world(furnace_scene(furnace)), testing::options_of(LinkMaker::sampled, 0.1f));
  const EmitterTree emitters(*state.visibility, find_emitters(*state.world));
  const DirectLightOptions few_rays{
      .shadow_rays = 2, .penumbra_rays = 4, .largest_group_share = 0.1f, .smallest_angle = 0.01f};
  for (const auto& [options, tolerance] :
       {std::pair(DirectLightOptions{}, 0.005), std::pair(few_rays, 0.01)}) {
    double sum = 0.0;
    const auto points = scatter_points(state, 20000);
    for (std::size_t i = 0; i < points.size(); ++i)
      sum += static_cast<double>(
          emitters.irradiance(points[i].position, points[i].normal, options, random_shift(i)).g);
    EXPECT_NEAR(sum / 20000.0 / static_cast<double>(kPi), 1.0, tolerance);
  }
}

}  // namespace
}  // namespace halflight
