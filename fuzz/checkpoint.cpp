// Checkpoints of a small scene: what is restored can be read, and the solve goes on from it where
// it is the one that was asked for.
#include <algorithm>
#include <array>

#include "checkpoint_scene.h"
#include "fuzz_target.h"
#include "halflight/output/read_light.h"
#include "halflight/solve/checkpoint.h"

namespace {
constexpr std::array kLinks{halflight::LinkMaker::refined, halflight::LinkMaker::sampled};
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  static const auto world = fuzz::checkpoint_world();
  const auto checkpoint = Checkpoint::parse(fuzz::bytes_of(data, size), "/nowhere/checkpoint");
  if (!checkpoint) {
    fuzz::require_clear(checkpoint.error());
    return 0;
  }
  if (const auto same = checkpoint->check(checkpoint->origin()); !same)
    fuzz::require_clear(same.error());
  auto state = checkpoint->restore(world);
  if (!state) {
    fuzz::require_clear(state.error());
    return 0;
  }
  ReadOptions reading;
  reading.gather_rays = 8;
  const SolutionReader reader(*state, reading);
  for (std::size_t t = 0; t < world->geometry.triangles.size(); t += 3) {
    const TriangleId triangle(t);
    const Vec3 n = glm::normalize(world->geometry.scaled_normal(triangle));
    const Vec3 x = world->geometry.corners(triangle)[0] + 0.001f * n;
    reader.of_cell({x, n, triangle});
    reader.read({x, n, triangle});
  }
  const bool asked_for = std::any_of(kLinks.begin(), kLinks.end(), [&](LinkMaker links) {
    return checkpoint->check(fuzz::checkpoint_origin(*world, links)).has_value();
  });
  if (asked_for && !state->done()) advance(*state, {}, {.links = 50});
  return 0;
}
