// The live view without a browser: what is published agrees with a solve, and follows what is
// asked.
#include <chrono>
#include <future>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "halflight/io/image_read.h"
#include "halflight/io/load_scene.h"
#include "halflight/scene/procedural/catalogue.h"
#include "halflight/view/packet.h"
#include "halflight/view/shared_exponent.h"
#include "halflight/view/view_downloads.h"
#include "halflight/view/view_layers.h"
#include "halflight/view/view_queries.h"
#include "halflight/view/view_session.h"
#include "live_view.h"
#include "quad_scene.h"
#include "solved_scene.h"

namespace halflight {
namespace {

using nlohmann::json;
using testing::array_of;
using ::testing::HasSubstr;
using testing::json_of;
using testing::Live;
using testing::QuadScene;
using testing::room;
using Clock = std::chrono::steady_clock;

TEST(SharedExponent, KeepsColoursToAFifthOfAPercent) {
  for (const float scale : {1e-3f, 0.7f, 1.f, 255.9f, 511.6f, 6e4f}) {
    const Rgb c = scale * Rgb(1.f, 0.37f, 0.02f);
    const Rgb back = unpack_rgb9e5(pack_rgb9e5(c));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(back[k], c[k], 0.002f * scale) << scale;
  }
  EXPECT_EQ(pack_rgb9e5(Rgb(0.f)), 0u);
  EXPECT_EQ(unpack_rgb9e5(pack_rgb9e5(Rgb(1e9f))), Rgb(65408.f));
}

TEST(LightFrames, TellWhatChangedSinceAVersion) {
  LightFrames frames;
  EXPECT_TRUE(frames.since(1, 0).empty());
  frames.begin(1);
  std::vector<Rgb> light(2000, Rgb(1.f));
  const std::uint64_t first = frames.add(1, light, 1.f);
  EXPECT_EQ(array_of<std::uint32_t>(frames.since(1, 0), "light").size(), 2000u);
  light[700] = Rgb(2.f);
  const std::uint64_t second = frames.add(1, light, 1.f);
  EXPECT_GT(second, first);
  const std::string change = frames.since(1, first);
  const auto ranges = array_of<std::uint32_t>(change, "ranges");
  ASSERT_EQ(ranges.size(), 2u);
  EXPECT_LE(ranges[0], 700u);
  EXPECT_GT(ranges[0] + ranges[1], 700u);
  EXPECT_LT(ranges[1], 1000u);
  EXPECT_EQ(array_of<std::uint32_t>(frames.since(1, second), "light").size(), 0u);
  EXPECT_EQ(array_of<std::uint32_t>(frames.since(7, second), "light").size(), 2000u)
      << "who has another mesh gets everything";
}

TEST(LightFrames, HaveLightOfNoVerticesWhereNothingIsShown) {
  LightFrames frames;
  frames.begin(1);
  EXPECT_TRUE(frames.since(1, 0).empty()) << "not there yet";
  frames.add(1, {}, 1.f);
  ASSERT_FALSE(frames.since(1, 0).empty());
  EXPECT_EQ(array_of<std::uint32_t>(frames.since(1, 0), "light").size(), 0u);
}

TEST(LightFrames, KeepFaintAndGlaringLight) {
  for (const float level : {1e-9f, 1.f, 1e9f}) {
    LightFrames frames;
    frames.begin(1);
    const std::vector<Rgb> light(100, level * Rgb(1.f, 0.5f, 0.1f));
    frames.add(1, light, 1.f);
    const std::string packet = frames.since(1, 0);
    const Rgb back = json_of(packet)["scale"].get<float>() *
                     unpack_rgb9e5(array_of<std::uint32_t>(packet, "light").front());
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(back[k] / level, light[0][k] / level, 0.002f);
  }
}

TEST(ViewCommandText, IsCheckedBeforeAnybodyActs) {
  for (const char* bad :
       {"", "[]", "{", R"({"featureSize": -1})", R"({"featureSize": "x"})", R"({"error": 0})",
        R"({"visibility": "none"})", R"({"offset": [1, 2]})", R"({"offset": [1, 2, 3]})",
        R"({"groups": {"a": -1}})", R"({"groups": {"a": 1e30}})", R"({"paused": 1})",
        R"({"what": 1})", R"({"important": {"forward": [0, 1, 0], "up": [0, 1, 0]}})",
        R"({"important": 3})", R"({"seconds": 1e300})", R"({"node": -2, "shown": true})"})
    EXPECT_FALSE(parse_view_command(bad)) << bad;
  EXPECT_FALSE(parse_view_command(std::string(60'000, '[')));
  const auto good = parse_view_command(
      R"({"paused": true, "groups": {"lamp": 0.5}, "node": 3, "offset": [0, 1, 0]})");
  ASSERT_TRUE(good);
  EXPECT_EQ(good->groups.front().second, Rgb(0.5f));
  EXPECT_EQ(good->offset, Vec3(0.f, 1.f, 0.f));
}

TEST(LiveView, EndsWithTheLightThatASolveFinds) {
  Live live;
  ASSERT_TRUE(live.done());
  const SolverState solved = testing::solve(room(), live.plan(0.3f).options);
  EXPECT_NEAR(live.mean(), mean_irradiance(solved), 0.02f * mean_irradiance(solved));

  // The probe reads as a sensor does, and the vertices of the sharp mesh agree with it.
  const json seen = live.probe_at({0.5f, 1.5f, 2.5f}, {0, -1, 0}, true);
  const std::vector<ReadingPoint> place{{{0.5f, 0.f, 2.5f}, {0, 1, 0}, {}}};
  const float expected = testing::read_irradiance(solved, place).front();
  EXPECT_NEAR(seen["irradiance"][0].get<float>(), expected, 0.03f * expected);

  const auto topology = live.session.topology();
  EXPECT_TRUE(json_of(*topology)["sharp"].get<bool>());
  const auto positions = array_of<float>(*topology, "positions");
  const std::string light = live.session.frames().since(0, 0);
  const auto packed = array_of<std::uint32_t>(light, "light");
  const float scale = json_of(light)["scale"];
  ASSERT_EQ(3 * packed.size(), positions.size());
  float nearest = kInfinity, there = 0.f;
  for (std::size_t v = 0; v < packed.size(); ++v) {
    const Vec3 p(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
    const float distance = glm::distance(p, Vec3(0.5f, 0.f, 2.5f));
    if (distance < nearest) nearest = distance, there = unpack_rgb9e5(packed[v]).r * scale;
  }
  EXPECT_LT(nearest, 0.5f);
  EXPECT_NEAR(there, expected, 0.15f * expected);
}

TEST(LiveView, SharpensThePictureVersionByVersion) {
  Live live(room(), 0.1f);
  ASSERT_TRUE(live.done());
  const json s = live.status();
  EXPECT_GT(s["version"].get<int>(), 2);
  EXPECT_EQ(s["epoch"], 2);
  EXPECT_LT(s["error"]["estimated"].get<float>(), 0.1f);
  EXPECT_LT(s["firstLightSeconds"].get<double>(), s["wallSeconds"].get<double>());
}

// What is coarse comes first, with all its parts, and the rest grows out of it.
TEST(LiveView, HasACompleteCoarseSolutionBeforeTheFineOne) {
  Live live(room(), 0.03f);
  ASSERT_TRUE(live.done());
  const json records = json::parse(live.session.history(0))["records"];
  std::size_t coarse_links = 0;  // when the first solution had its last rays
  double coarse = 0.0, fine = 0.0;
  for (const json& r : records) {
    if (r["stage"] != "sample") continue;
    if (coarse == 0.0) coarse = r["threshold"];
    if (r["threshold"] == coarse) coarse_links = r["links"];
    fine = r["threshold"];
  }
  EXPECT_GT(coarse, 2.0 * fine);
  EXPECT_GT(coarse_links, 0u);
  EXPECT_LT(5 * coarse_links, records.back()["links"].get<std::size_t>());
}

TEST(LiveView, DimsALampAsPhysicsSays) {
  Live live;
  ASSERT_TRUE(live.done());
  const double both = live.mean();
  live.command(R"({"groups": {"spare": 0}})");
  ASSERT_TRUE(live.wait([&](const json& s) { return s["meanIrradiance"] < 0.995 * both; }));
  const double one = live.mean();
  live.command(R"({"groups": {"lamp": 0, "spare": 1}})");
  ASSERT_TRUE(live.wait([&](const json& s) { return s["meanIrradiance"] < 0.5 * both; }));
  const double other = live.mean();
  EXPECT_NEAR(one + other, both, 0.01 * both) << "light adds up";
  // Power is radiance times area: 10 x 1 m2 against 5 x 0.09 m2.
  EXPECT_NEAR(other / one, 0.045, 0.015);
}

TEST(LiveView, DimsALampBeforeItIsDone) {
  Live live(room(), 0.03f);
  ASSERT_TRUE(live.wait([](const json& s) { return s.value("meanIrradiance", 0.0) > 0.0; }));
  live.command(R"({"paused": true})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["phase"] == "paused"; }));
  const double before = live.mean();
  live.command(R"({"groups": {"lamp": 0.5, "spare": 0.5}})");
  ASSERT_TRUE(live.wait([&](const json& s) { return s["meanIrradiance"] < 0.9 * before; }));
  EXPECT_NEAR(live.mean(), 0.5 * before, 0.1 * before);
}

TEST(LiveView, FollowsALampThatMoves) {
  Live live;
  ASSERT_TRUE(live.done());
  const json before = live.probe_at({0.5f, 1.f, 0.5f}, {0, -1, 0}, true);
  live.command(R"({"node": 6, "offset": [-1, 0, -1]})");
  ASSERT_TRUE(live.wait(
      [](const json& s) { return s["iterations"].get<int>() == 0 || s["phase"] != "done"; }));
  ASSERT_TRUE(live.done());
  const json after = live.probe_at({0.5f, 1.f, 0.5f}, {0, -1, 0}, true);
  Scene moved = room();
  moved.nodes[NodeId(std::size_t{6})].local[3] = glm::dvec4(-1, 0, -1, 1);
  const SolverState solved = testing::solve(std::move(moved), live.plan(0.3f).options);
  const float expected =
      testing::read_irradiance(solved, {{{0.5f, 0.f, 0.5f}, {0, 1, 0}, {}}}).front();
  EXPECT_NEAR(after["irradiance"][0].get<float>(), expected, 0.03f * expected);
  EXPECT_GT(after["irradiance"][0].get<float>(), 1.1f * before["irradiance"][0].get<float>());
  // And back again.
  live.command(R"({"node": 6, "offset": [0, 0, 0]})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["phase"] != "done"; }));
  ASSERT_TRUE(live.done());
  const json back = live.probe_at({0.5f, 1.f, 0.5f}, {0, -1, 0}, true);
  EXPECT_NEAR(back["irradiance"][0].get<float>(), before["irradiance"][0].get<float>(),
              0.02f * before["irradiance"][0].get<float>());
}

TEST(LiveView, TakesAnObjectAwayAndPutsItBack) {
  Live live;
  ASSERT_TRUE(live.done());
  EXPECT_EQ(live.probe_at({1.4f, 1.f, 1.4f}, {0, -1, 0}, false)["node"], 8);
  const double shaded = live.probe_at({1.4f, 0.3f, 1.4f}, {0, -1, 0}, true)["irradiance"][0];
  live.command(R"({"node": 8, "shown": false})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["phase"] != "done"; }));
  ASSERT_TRUE(live.done());
  EXPECT_NE(live.probe_at({1.4f, 1.f, 1.4f}, {0, -1, 0}, false)["node"], 8);
  const double open = live.probe_at({1.4f, 0.3f, 1.4f}, {0, -1, 0}, true)["irradiance"][0];
  EXPECT_GT(open, 1.5 * shaded);
  live.command(R"({"node": 8, "shown": true})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["phase"] != "done"; }));
  ASSERT_TRUE(live.done());
  EXPECT_EQ(live.probe_at({1.4f, 1.f, 1.4f}, {0, -1, 0}, false)["node"], 8);
}

TEST(LiveView, ShowsARoomInWhichNothingIsLeft) {
  Live live;
  ASSERT_TRUE(live.done());
  for (int node = 0; node <= 8; ++node)
    live.command(fmt::format(R"({{"node": {}, "shown": false}})", node));
  ASSERT_TRUE(live.wait([](const json& s) { return s["edits"].size() == 9; }));
  ASSERT_TRUE(live.done());
  EXPECT_EQ(json_of(*live.session.topology())["triangles"], 0);
  EXPECT_FALSE(live.session.frames().since(0, 0).empty());
  live.command(R"({"node": 8, "shown": true})");
  ASSERT_TRUE(live.wait(
      [&](const json&) { return json_of(*live.session.topology())["triangles"].get<int>() > 0; }));
}

// A speck that loses its area in single precision where it is moved to: all triangles after it get
// other numbers.
TEST(LiveView, MovesSpecksThatVanish) {
  QuadScene quads;
  quads.quad({0, 0, 0}, {1e-7f, 0, 0}, {0, 0, 1e-7f}, quads.material(0.5f));
  quads.box({0, 0, 0}, {3, 3, 3}, quads.material(0.5f), true);
  quads.quad({1, 2.9f, 1}, {1, 0, 0}, {0, 0, 1}, quads.material(0.f, 10.f));
  const std::size_t before = flatten(quads.scene).triangles.size();
  ASSERT_EQ(before, 16u);
  Live live(quads.scene);
  ASSERT_TRUE(live.done());
  live.command(R"({"node": 0, "offset": [2, 2, 2]})");
  ASSERT_TRUE(live.wait([](const json& s) { return !s["edits"].empty(); }));
  ASSERT_TRUE(live.done());
  EXPECT_LT(live.session.world()->geometry.triangles.size(), before);
  EXPECT_GT(live.probe_at({0.5f, 1.f, 0.5f}, {0, -1, 0}, true)["irradiance"][0].get<float>(), 0.f);
  live.command(R"({"node": 0, "offset": [0, 0, 0]})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["phase"] != "done"; }));
  ASSERT_TRUE(live.done());
  EXPECT_EQ(live.session.world()->geometry.triangles.size(), before);
  // So far away that nothing of a room keeps its shape.
  live.command(R"({"node": 3, "offset": [1e7, 7e6, 3e6]})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["phase"] != "done"; }));
  ASSERT_TRUE(live.done());
}

TEST(LiveView, LeavesObjectsOfFlattenedGroupsWhereTheyAre) {
  Scene scene = room();
  Node flat;
  flat.local = glm::scale(Mat4(1.0), glm::dvec3(1.0, 0.0, 1.0));
  const NodeId group = scene.nodes.push_back(flat);
  scene.nodes[NodeId(std::size_t{8})].parent = group;
  EXPECT_FALSE(can_move(scene, NodeId(std::size_t{8})));
  EXPECT_TRUE(can_move(scene, group));
  Live live(scene);
  ASSERT_TRUE(live.done());
  const auto move = parse_view_command(R"({"node": 8, "offset": [0.5, 0, 0]})");
  const auto refused = live.session.command(*move);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().line(), HasSubstr("cannot be moved"));
  live.command(fmt::format(R"({{"node": {}, "offset": [0.5, 0, 0]}})", group.value));
  ASSERT_TRUE(live.wait([](const json& s) { return s["edits"].size() == 1; }));
  ASSERT_TRUE(live.done());
}

TEST(LiveView, PausesStepsAndKeepsToLimits) {
  Live live(room(), 0.02f);
  live.command(R"({"paused": true})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["phase"] == "paused"; }));
  const int before = live.status()["iterations"];
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(live.status()["iterations"], before);
  live.command(R"({"step": true})");
  ASSERT_TRUE(live.wait([&](const json& s) { return s["iterations"] == before + 1; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(live.status()["iterations"], before + 1);
  live.command(R"({"paused": false, "links": 10})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["phase"] == "limited"; }));
  live.command(R"({"links": 0})");
  ASSERT_TRUE(live.wait([&](const json& s) { return s["iterations"] > before + 3; }));
}

TEST(LiveView, BeginsAnewWithOtherOptions) {
  Live live;
  ASSERT_TRUE(live.done());
  const std::size_t coarse = live.status()["elements"];
  live.command(R"({"featureSize": 0.1})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["featureSize"] < 0.2; }));
  ASSERT_TRUE(live.done());
  EXPECT_GT(live.status()["elements"].get<std::size_t>(), coarse);
  live.command(R"({"visibility": "average"})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["visibility"] == "average"; }));
}

TEST(LiveView, RefinesWhatIsSeen) {
  Live live;
  ASSERT_TRUE(live.done());
  const std::size_t before = live.status()["elements"];
  live.command(
      R"({"important": {"position": [0.5, 1.5, 0.5], "forward": [1, -1, 1], "fov": 0.8,
          "width": 64, "height": 64}})");
  ASSERT_TRUE(
      live.wait([](const json& s) { return s["important"] == true && s["phase"] != "done"; }));
  ASSERT_TRUE(live.done());
  EXPECT_GT(live.status()["elements"].get<std::size_t>(), before);
}

TEST(LiveView, ShowsWhatTheSolverWorksWith) {
  Live live;
  ASSERT_TRUE(live.done());
  const json seen = live.probe_at({1.4f, 1.f, 1.4f}, {0, -1, 0}, false);
  const ElementId element(seen["element"]["id"].get<std::size_t>());
  const auto ask = [&](const ViewSession::Question& question) {
    const auto answer = live.session.ask(question, 20.0);
    EXPECT_TRUE(answer) << (answer ? "" : answer.error().line());
    return answer ? *answer : Packet().bytes();
  };
  const std::string elements = ask([](LiveSolution& l) { return elements_packet(l); });
  EXPECT_GE(array_of<float>(elements, "lines").size() / 6,
            3 * json_of(elements)["cells"].get<std::size_t>());
  const std::string clusters = ask([](LiveSolution& l) { return clusters_packet(l, 1); });
  const auto boxes = array_of<float>(clusters, "boxes");
  ASSERT_FALSE(boxes.empty());
  for (const float kappa : array_of<float>(clusters, "extinction")) EXPECT_GT(kappa, 0.f);
  // The links of an element carry its irradiance, the light of lamps apart.
  const std::string links = ask([=](LiveSolution& l) { return links_packet(l, element); });
  float sum = 0.f;
  for (const float e : array_of<float>(links, "values")) sum += e;
  const json& cell = seen["element"];
  const float indirect = cell["irradiance"][0].get<float>() - cell["direct"][0].get<float>();
  EXPECT_NEAR(sum, indirect, 0.1f * indirect);
  const std::string errors = ask([](LiveSolution& l) { return error_packet(l); });
  EXPECT_TRUE(json_of(errors)["measured"].get<bool>());
  double mean = 0.0;
  const auto values = array_of<float>(errors, "values");
  for (const float e : values) mean += static_cast<double>(e) / static_cast<double>(values.size());
  EXPECT_GT(mean, 0.0);
  EXPECT_LT(mean, 0.2);
  const json bins = json::parse(ask([](LiveSolution& l) { return histogram(l); }));
  std::size_t counted = 0;
  for (const json& count : bins["counts"]) counted += count.get<std::size_t>();
  EXPECT_GT(counted, 0u);
  ViewOfInterest view;
  view.camera.position = {0.3f, 1.5f, 0.3f};
  view.camera.forward = glm::normalize(Vec3(1.f, -1.f, 1.f));
  view.width = view.height = 320;
  const auto classes = array_of<std::uint32_t>(
      ask([&](LiveSolution& l) { return feature_mask_packet(l, view, 8.f); }), "classes");
  EXPECT_GT(std::count(classes.begin(), classes.end(), 2u), 100) << "the table throws a shadow";
  EXPECT_GT(std::count(classes.begin(), classes.end(), 0u), 100);
}

// The packet of a cut through a swarm of little quads, on the way from the table to the lamp.
TEST(LiveView, ShowsTheClustersThatARayTakesForMedia) {
  QuadScene swarm;
  swarm.scene = room();
  const MaterialId grey = swarm.material(0.5f);
  for (int i = 0; i < 64; ++i)
    swarm.quad(
        {1.38f + 0.04f * static_cast<float>(i % 4), 1.6f + 0.02f * static_cast<float>(i / 16),
         1.38f + 0.04f * static_cast<float>(i / 4 % 4)},
        {0.02f, 0, 0}, {0, 0, 0.02f}, grey);
  Live live(swarm.scene);
  ASSERT_TRUE(live.done());
  const auto table = [&] {
    const json seen = live.probe_at({1.4f, 1.f, 1.4f}, {0, -1, 0}, false);
    return ElementId(seen["element"]["id"].get<std::size_t>());
  };
  const auto cut = [&](ElementId e) {
    return live.session.ask([=](LiveSolution& l) { return cut_packet(l, e); }, 20.0);
  };
  EXPECT_FALSE(cut(ElementId(std::size_t{1} << 30)));
  const auto exact = cut(table());
  ASSERT_FALSE(exact) << "clusters save nothing in so small a room";
  EXPECT_THAT(exact.error().line(), HasSubstr("traced exactly"));
  EXPECT_EQ(live.status()["visibilityWanted"], "exact") << "so that the page can ask for another";

  live.command(R"({"visibility": "multires"})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["visibility"] == "multires"; }));
  ASSERT_TRUE(live.done());
  const auto packet = cut(table());
  ASSERT_TRUE(packet) << packet.error().line();
  const auto line = array_of<float>(*packet, "lines"), boxes = array_of<float>(*packet, "boxes");
  const auto averaged = array_of<float>(*packet, "averaged");
  const auto extinction = array_of<float>(*packet, "extinction");
  ASSERT_EQ(line.size(), 6u);
  EXPECT_NEAR(line[1], 0.5f, 0.01f);
  EXPECT_NEAR(line[4], 2.9f, 0.01f) << "ends in the brightest lamp";
  ASSERT_EQ(boxes.size(), 6 * averaged.size());
  ASSERT_EQ(extinction.size(), averaged.size());
  EXPECT_GT(std::count(averaged.begin(), averaged.end(), 1.f), 0);
  for (std::size_t i = 0; i < averaged.size(); ++i) {
    if (averaged[i] == 0.f) continue;
    EXPECT_GT(extinction[i], 0.f);
    EXPECT_GT(boxes[6 * i + 1], 1.5f) << "a part of the swarm, not of the room";
    EXPECT_LT(boxes[6 * i + 4], 1.7f);
  }
}

TEST(LiveView, EstimatesItsErrorBeforeThePictureIsSharp) {
  Live live(room(), 0.02f);
  live.command(R"({"links": 10})");
  ASSERT_TRUE(live.wait([](const json& s) { return s["phase"] == "limited"; }));
  const auto packet = live.session.ask(
      [](LiveSolution& l) -> Result<std::string> { return error_packet(l); }, 20.0);
  ASSERT_TRUE(packet) << packet.error().line();
  EXPECT_FALSE(json_of(*packet)["measured"].get<bool>());
  const auto errors = array_of<float>(*packet, "values");
  ASSERT_FALSE(errors.empty());
  for (const float e : errors) {
    EXPECT_GE(e, 0.f);
    EXPECT_LE(e, 1.f);
  }
  EXPECT_GT(*std::max_element(errors.begin(), errors.end()), 0.f);
}

// The scene and the picture hold the light that a probe reads.
TEST(LiveView, GivesTheLitSceneAndAPictureToTakeHome) {
  Live live;
  ASSERT_TRUE(live.done());
  const auto lit = live.session.ask_copy(lit_glb, 20.0);
  ASSERT_TRUE(lit) << lit.error().line();
  const auto scene = parse_scene(Bytes(lit->begin(), lit->end()), "lit.glb");
  ASSERT_TRUE(scene) << scene.error().line();
  const Geometry lit_room = flatten(*scene), plain = flatten(room());
  EXPECT_GT(lit_room.triangles.size(), plain.triangles.size());
  EXPECT_EQ(lit_room.bounds.lower, plain.bounds.lower);
  EXPECT_EQ(lit_room.bounds.upper, plain.bounds.upper);

  ViewOfInterest down;  // to the middle of the table
  down.camera.position = {1.4f, 2.f, 1.4f};
  down.camera.forward = {0, -1, 0};
  down.camera.up = {0, 0, 1};
  down.camera.vertical_fov = 0.1f;
  down.width = 9;
  down.height = 7;
  const auto picture = live.session.ask_copy(
      [&](const SolutionCopy& copy, const Progress& progress) {
        return hdr_picture(copy, down, progress);
      },
      20.0);
  ASSERT_TRUE(picture) << picture.error().line();
  const auto image = decode_float_image(Bytes(picture->begin(), picture->end()), "view.exr");
  ASSERT_TRUE(image) << image.error().line();
  EXPECT_EQ(image->width, 9);
  EXPECT_EQ(image->height, 7);
  const json seen = live.probe_at({1.4f, 2.f, 1.4f}, {0, -1, 0}, true);
  const float irradiance = seen["irradiance"][0];
  EXPECT_NEAR(image->at(4, 3).r, 0.5f * irradiance / kPi, 0.05f * irradiance / kPi);
}

TEST(LiveView, LeavesTheProcessorToThePageThatAsksForIt) {
  Live live(room(), 0.02f);
  ASSERT_TRUE(live.wait([](const json& s) { return s.value("version", 0) > 0; }));
  // From the end of one iteration to the end of another one.
  const auto after = [&](std::size_t iterations) {
    live.wait([&](const json& s) {
      live.command(R"({"giveWay": true})");
      return s["iterations"].get<std::size_t>() >= iterations;
    });
    return live.status();
  };
  const json first = after(2), last = after(6);
  const auto taken = [&](const char* name) {
    return last[name].get<double>() - first[name].get<double>();
  };
  EXPECT_LT(taken("solvingSeconds"), 0.4 * taken("wallSeconds"));
  EXPECT_FALSE(parse_view_command(R"({"giveWay": true, "paused": true})"));
}

TEST(LiveView, SolvesOnWhileSomethingIsTakenHome) {
  Live live(room(), 0.02f);
  ASSERT_TRUE(live.wait([](const json& s) { return s.value("version", 0) > 0; }));
  const auto answer = live.session.ask_copy(
      [&](const SolutionCopy& copy, const Progress&) -> Result<std::string> {
        const std::size_t iterations = copy.state.history.size();
        const bool goes_on = live.wait(
            [&](const json& s) { return s["iterations"].get<std::size_t>() > iterations + 2; },
            20.0);
        EXPECT_EQ(copy.state.history.size(), iterations) << "the copy stays as it is";
        return std::string(goes_on ? "goes on" : "stands");
      },
      20.0);
  ASSERT_TRUE(answer);
  EXPECT_EQ(*answer, "goes on");
}

TEST(LiveView, TellsWhyThereIsNothingToSee) {
  ViewSession broken([]() -> Result<Scene> { return input_error("bad", "room.glb", "mend it"); },
                     {});
  const auto start = Clock::now();
  while (!broken.failure() && Clock::now() - start < std::chrono::seconds(5))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const json s = json::parse(broken.status());
  EXPECT_EQ(s["phase"], "failed");
  EXPECT_THAT(s["sentence"].get<std::string>(), HasSubstr("bad"));
  EXPECT_EQ(s["remedy"], "mend it");
  EXPECT_FALSE(broken.ask([](LiveSolution&) -> Result<std::string> { return std::string(); }, 1.0));

  Live empty{Scene()};
  ASSERT_TRUE(empty.wait([](const json& s2) { return s2["phase"] == "failed"; }));
  EXPECT_THAT(empty.status()["sentence"].get<std::string>(), HasSubstr("no triangles"));

  QuadScene dark;
  dark.box({0, 0, 0}, {1, 1, 1}, dark.material(0.5f), true);
  Live unlit(dark.scene);
  ASSERT_TRUE(unlit.wait([](const json& s2) { return s2["version"].get<int>() > 0; }));
  EXPECT_THAT(unlit.status()["sentence"].get<std::string>(), HasSubstr("gives light"));
  EXPECT_THAT(unlit.status()["remedy"].get<std::string>(), HasSubstr("--sky"));
}

// A question that waits while the scene is read has its answer when there will be none.
TEST(LiveView, LeavesNobodyWaitingForAnAnswer) {
  std::promise<void> gate;
  ViewSession session(
      [opened = gate.get_future().share()]() -> Result<Scene> {
        opened.wait();
        return input_error("bad", "room.glb", "mend it");
      },
      {});
  const auto start = Clock::now();
  auto asked = std::async(std::launch::async, [&] {
    return session.ask([](LiveSolution&) -> Result<std::string> { return std::string(); }, 30.0);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  gate.set_value();
  const auto answer = asked.get();
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().line(), HasSubstr("mend it"));
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(10));
}

// A picture that takes half a minute ends with the view, and those that wait for their turn.
TEST(LiveView, EndsInTheMiddleOfDownloads) {
  Live live;
  ASSERT_TRUE(live.done());
  ViewOfInterest large;
  large.camera.position = {1.4f, 2.f, 1.4f};
  large.camera.forward = {0, -1, 0};
  large.camera.up = {0, 0, 1};
  large.width = large.height = kLargestPicture;
  std::vector<std::future<Result<std::string>>> downloads;
  for (int i = 0; i < 3; ++i)
    downloads.push_back(std::async(std::launch::async, [&] {
      return live.session.ask_copy(
          [&](const SolutionCopy& copy, const Progress& progress) {
            return hdr_picture(copy, large, progress);
          },
          60.0);
    }));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto start = Clock::now();
  live.session.stop();
  for (auto& download : downloads) {
    const auto answer = download.get();
    ASSERT_FALSE(answer);
    EXPECT_THAT(answer.error().line(), HasSubstr("has ended"));
  }
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(5));
}

TEST(LiveView, EndsInTheMiddleOfAnything) {
  for (const int milliseconds : {0, 1, 20, 100, 400}) {
    Live live(room(), 0.02f);
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  }
}

}  // namespace
}  // namespace halflight
