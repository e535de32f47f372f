// The live view without a browser or a server, over a small room.
#pragma once

#include <chrono>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "halflight/view/view_command.h"
#include "halflight/view/view_queries.h"
#include "halflight/view/view_session.h"
#include "quad_scene.h"

namespace halflight::testing {

// A room of 3 m with a lamp below its ceiling and a box on its floor, each a node of its own.
inline Scene room() {
  QuadScene quads;
  quads.box({0, 0, 0}, {3, 3, 3}, quads.material(0.5f), true);
  const MaterialId lamp = quads.material(0.f, 10.f), spare = quads.material(0.f, 5.f);
  quads.scene.materials[lamp].name = "lamp";
  quads.scene.materials[spare].name = "spare";
  quads.quad({1, 2.9f, 1}, {1, 0, 0}, {0, 0, 1}, lamp);                        // node 6
  quads.quad({0.2f, 2.9f, 0.2f}, {0.3f, 0, 0}, {0, 0, 0.3f}, spare);           // node 7
  quads.quad({1, 0.5f, 1}, {0, 0, 0.8f}, {0.8f, 0, 0}, quads.material(0.5f));  // node 8, a table
  return quads.scene;
}

inline nlohmann::json json_of(const std::string& packet) {
  std::uint32_t length = 0;
  std::memcpy(&length, packet.data() + 4, 4);
  return nlohmann::json::parse(packet.substr(8, length));
}

template <class T>
std::vector<T> array_of(const std::string& packet, const char* name) {
  std::uint32_t length = 0;
  std::memcpy(&length, packet.data() + 4, 4);
  const nlohmann::json place = json_of(packet)["arrays"][name];
  std::vector<T> values(place["count"].get<std::size_t>());
  if (!values.empty())
    std::memcpy(values.data(), packet.data() + 8 + length + place["offset"].get<std::size_t>(),
                4 * values.size());
  return values;
}

struct Live {
  using json = nlohmann::json;
  using Clock = std::chrono::steady_clock;
  explicit Live(Scene scene = room(), float feature_size = 0.3f)
      : session([scene] { return scene; }, plan(feature_size)) {}

  static ViewPlan plan(float feature_size) {
    ViewPlan plan;
    plan.options.feature_size = feature_size;
    return plan;
  }
  json status() const { return json::parse(session.status()); }
  template <class Condition>
  bool wait(const Condition& condition, double seconds = 60.0) const {
    const auto start = Clock::now();
    while (!condition(status())) {
      if (std::chrono::duration<double>(Clock::now() - start).count() > seconds) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }
  bool done() const {
    return wait([](const json& s) { return s["phase"] == "done"; });
  }
  void command(const std::string& text) {
    ASSERT_TRUE(wait([](const json& s) { return s.value("version", 0) > 0; }));
    const auto parsed = parse_view_command(text);
    ASSERT_TRUE(parsed) << parsed.error().line();
    const auto sent = session.command(*parsed);
    ASSERT_TRUE(sent) << sent.error().line();
  }
  json probe_at(const Vec3& origin, const Vec3& direction, bool exact) {
    const auto answer = session.ask(
        [=](LiveSolution& live) -> Result<std::string> {
          return probe(live, {origin, direction, exact});
        },
        20.0);
    return answer ? json::parse(*answer) : json();
  }
  double mean() const { return status()["meanIrradiance"]; }

  ViewSession session;
};

}  // namespace halflight::testing
