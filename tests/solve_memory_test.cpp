#include "halflight/solve/memory.h"

#include <gtest/gtest.h>

#include "halflight/base/memory.h"
#include "halflight/base/parallel.h"
#include "halflight/base/quantities.h"
#include "halflight/solve/state_fields.h"
#include "quad_scene.h"
#include "solved_scene.h"

namespace halflight {
namespace {

using testing::QuadScene;

// A room with a table, whose shadows ask for many cells.
Scene room() {
  QuadScene quads;
  quads.box({0, 0, 0}, {4, 3, 5}, quads.material(0.7f), true);
  quads.box({1, 0.9f, 1}, {2.5f, 1, 3}, quads.material(0.4f), false);
  quads.quad({1.5f, 2.9f, 2}, {0.5f, 0, 0}, {0, 0, 0.5f}, quads.material(0.f, 30.f));
  return quads.scene;
}

SolveOptions fine(std::size_t memory) {
  SolveOptions options = testing::options_of(LinkMaker::sampled, 0.02f);
  options.memory = memory;
  return options;
}

TEST(Memory, WhatIsCountedStaysBelowTheLimit) {
  const auto world = make_world(room());
  const SolverState free = testing::solve(world, fine(0));
  EXPECT_EQ(free.schedule.short_of_memory, 0);
  const std::size_t wanted = counted_bytes(free);
  for (const double share : {0.9, 0.7, 0.5}) {
    const std::size_t base = bytes_of_world(*world);
    const auto limit =
        base + static_cast<std::size_t>(share * static_cast<double>(wanted - base)) + (16u << 20);
    const SolverState state = testing::solve(world, fine(limit));
    EXPECT_LE(counted_bytes(state), limit) << share;
    EXPECT_LE(state.link_total(), free.link_total()) << share;
    EXPECT_EQ(state.schedule.short_of_memory, state.link_total() < free.link_total() ? 1 : 0);
    EXPECT_NEAR(mean_irradiance(state) / mean_irradiance(free), 1.f, 0.12f) << share;
  }
}

TEST(Memory, AGenerousLimitChangesNoLight) {
  const auto world = make_world(room());
  const SolverState free = testing::solve(world, fine(0));
  const SolverState limited = testing::solve(world, fine(std::size_t{8} << 30));
  EXPECT_EQ(limited.schedule.short_of_memory, 0);
  // Receivers get their links in smaller portions.
  EXPECT_NEAR(static_cast<double>(limited.link_total()) / static_cast<double>(free.link_total()),
              1.0, 0.02);
  EXPECT_NEAR(mean_irradiance(limited) / mean_irradiance(free), 1.f, 0.01f);
}

TEST(Memory, ALimitGivesTheSameBytesWhateverTheThreads) {
  const auto world = make_world(room());
  const std::size_t limit = bytes_of_world(*world) + (17u << 20);
  set_thread_count(1);
  const SolverState one = testing::solve(world, fine(limit));
  set_thread_count(3);
  const SolverState three = testing::solve(world, fine(limit));
  set_thread_count(0);
  EXPECT_EQ(one.schedule.short_of_memory, 1);
  EXPECT_EQ(one.irradiance.raw(), three.irradiance.raw());
  EXPECT_EQ(one.link_total(), three.link_total());
}

TEST(Memory, LightCanBeReadWithoutLinks) {
  SolverState state = testing::solve(make_world(room()), fine(0));
  const std::vector<ReadingPoint> points{{{0.5f, 0.f, 0.5f}, {0, 1, 0}, {}},
                                         {{3.f, 0.f, 4.f}, {0, 1, 0}, {}}};
  const auto before = testing::read_irradiance(state, points);
  drop_links(state);
  EXPECT_EQ(state.link_total(), 0u);
  EXPECT_EQ(testing::read_irradiance(state, points), before);
}

TEST(Memory, SizesAreReadAsPeopleWriteThem) {
  EXPECT_EQ(*parse_size("2GiB"), 2147483648.0);
  EXPECT_EQ(*parse_size("1.5GB"), 1.5e9);
  EXPECT_EQ(*parse_size("1048576"), 1048576.0);
  for (const char* text : {"", "2Gi", "-1MB", "much", "2 GB", "inf"})
    EXPECT_FALSE(parse_size(text));
}

}  // namespace
}  // namespace halflight
