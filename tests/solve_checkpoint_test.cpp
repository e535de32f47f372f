// Checkpoints: going on from one gives what would have come anyway, and none that is not as it was
// written is taken for a state.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "halflight/base/hash.h"
#include "halflight/io/write_gltf.h"
#include "halflight/output/estimated_error.h"
#include "halflight/scene/procedural/loose_triangles.h"
#include "halflight/scene/scene_digest.h"
#include "halflight/solve/checkpoint.h"
#include "halflight/solve/settings.h"
#include "halflight/solve/state_fields.h"
#include "solved_scene.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

using ::testing::HasSubstr;

// Everything but what depends on time.
class StateBytes {
 public:
  explicit StateBytes(const SolverState& state) : tree_(state.tree) {
    for_each_field(state, [&](std::string_view, const auto& field, auto&&...) { add(field); });
  }
  friend bool operator==(const StateBytes& a, const StateBytes& b) { return a.bytes_ == b.bytes_; }

 private:
  template <class T>
  void add(const T& value) {
    append(std::span(&value, 1));
  }
  template <class T>
  void add(const std::vector<T>& items) {
    append(std::span(items));
  }
  template <class T>
  void add(const IdVector<ElementId, T>& items) {
    append(items.span());
  }
  void add(const LinkTable& links) {
    for (std::size_t i = 0; i < tree_.size(); ++i) append(links.of(ElementId(i)));
  }
  template <class T, std::size_t n>
  void append(std::span<const T, n> items) {
    const auto bytes = std::as_bytes(items);
    bytes_.emplace_back(bytes.begin(), bytes.end());
  }

  const ElementTree& tree_;
  std::vector<std::vector<std::byte>> bytes_;
};

class StoredSolve : public ::testing::TestWithParam<LinkMaker> {
 protected:
  void SetUp() override {
    LooseTrianglesParameters p;
    p.count = 60;
    Scene scene = loose_triangles_scene(p);
    origin_.scene.path = folder_.path() / "scene.glb";
    ASSERT_TRUE(write_scene_glb(origin_.scene.path, scene));
    world_ = make_world(*load_scene(origin_.scene.path));
    origin_.scene_digest = digest_of(world_->scene);
    options_ = resolved(testing::options_of(GetParam(), 0.6f, 0.3f), *world_);
    origin_.options = options_;
  }
  void write(const SolverState& state, const std::string& name = "checkpoint") const {
    const auto written = write_checkpoint(folder_.path() / name, origin_, state);
    ASSERT_TRUE(written) << written.error().line();
  }
  Result<SolverState> restore(const std::string& name = "checkpoint") const {
    const auto checkpoint = Checkpoint::open(folder_.path() / name);
    if (!checkpoint) return tl::unexpected(checkpoint.error());
    return checkpoint->restore(world_);
  }
  Bytes bytes(const std::string& name = "checkpoint") const {
    return *read_file(folder_.path() / name);
  }
  SolverState solve() const { return testing::solve(world_, options_); }

  TemporaryFolder folder_;
  SolveOrigin origin_;
  std::shared_ptr<const World> world_;
  SolveOptions options_;
};

TEST_P(StoredSolve, GoesOnAsIfNothingHadHappened) {
  // Short iterations stop within levels, and with receivers left to sample.
  for (const std::size_t links : {std::numeric_limits<std::size_t>::max(), std::size_t{8000}}) {
    IterationBudget budget;
    budget.links = links;
    SolverState state = make_state(world_, options_);
    for (std::size_t k = 0;; ++k) {
      write(state, "iteration " + std::to_string(k));
      if (state.done()) break;
      advance(state, {}, budget);
    }
    ASSERT_GT(state.history.size(), links < 10000 ? 4u : 2u);
    for (std::size_t k = 0; k <= state.history.size(); ++k) {
      auto resumed = restore("iteration " + std::to_string(k));
      ASSERT_TRUE(resumed) << resumed.error().line();
      EXPECT_EQ(resumed->history.size(), k);
      while (!resumed->done()) advance(*resumed, {}, budget);
      EXPECT_TRUE(StateBytes(*resumed) == StateBytes(state)) << "from iteration " << k;
      write(*resumed, "end");
      EXPECT_EQ(bytes("end"), bytes("iteration " + std::to_string(state.history.size())));
    }
  }
}

TEST_P(StoredSolve, ReadsTheSameLight) {
  const SolverState state = solve();
  write(state);
  const auto restored = restore();
  ASSERT_TRUE(restored) << restored.error().line();
  const auto sensors = scatter_points(state, 40);
  EXPECT_EQ(testing::read_irradiance(state, sensors, kMeshReading),
            testing::read_irradiance(*restored, sensors, kMeshReading));
}

TEST_P(StoredSolve, DamageIsNeverTakenForAState) {
  write(solve());
  const Bytes whole = bytes();
  const auto try_it = [&](const Bytes& damaged, const std::string& what) {
    folder_.write("damaged", {reinterpret_cast<const char*>(damaged.data()), damaged.size()});
    const auto state = restore("damaged");
    ASSERT_FALSE(state) << what;
    EXPECT_THAT(state.error().line(), HasSubstr("damaged"));  // the file's name
    EXPECT_EQ(state.error().kind, Error::Kind::input);
  };
  for (std::uint64_t i = 0; i < 300; ++i) {
    Bytes damaged = whole;
    const std::size_t at = hash(i, 1) % whole.size();
    damaged[at] ^= static_cast<std::uint8_t>(1 + hash(i, 2) % 255);
    try_it(damaged, "byte " + std::to_string(at));
    const auto end = whole.begin() + static_cast<std::ptrdiff_t>(hash(i, 3) % whole.size());
    try_it(Bytes(whole.begin(), end), "first " + std::to_string(end - whole.begin()));
  }
  Bytes longer = whole;
  longer.push_back(0);
  try_it(longer, "one more byte");
}

// Files whose checksums hold and that no solve has written.
TEST_P(StoredSolve, NonsenseIsNeverTakenForAState) {
  const SolverState state = solve();
  const auto expect_refused = [&](const char* what, const auto& spoil) {
    SolverState spoilt = state;
    spoil(spoilt);
    write(spoilt);
    const auto read = restore();
    ASSERT_FALSE(read) << what;
    EXPECT_THAT(read.error().line(), HasSubstr("the checkpoint is damaged")) << what;
  };
  const auto with_first_link = [&](SolverState& s, const auto& change) {
    LinkTable& table = s.links.size() > 0 ? s.links : s.sampled_links;
    std::vector<ReceiverLink> links = table.release();
    ASSERT_FALSE(links.empty());
    change(links.front().link);
    table.append(links);
  };
  expect_refused("a source that does not exist", [&](SolverState& s) {
    with_first_link(s, [&](Link& l) { l.source = ElementId(s.tree.size()); });
  });
  expect_refused("a weight below nothing",
                 [&](SolverState& s) { with_first_link(s, [](Link& l) { l.weight = -2.f; }); });
  expect_refused("a weight that is no number", [&](SolverState& s) {
    with_first_link(s, [](Link& l) { l.weight = std::nanf(""); });
  });
  expect_refused("a receiver that does not exist",
                 [](SolverState& s) { s.schedule.receivers.push_back(ElementId()); });
  expect_refused("a stage that does not exist",
                 [](SolverState& s) { s.schedule.stage = static_cast<Stage>(17); });
  expect_refused("a weight beyond all sense",
                 [&](SolverState& s) { with_first_link(s, [](Link& l) { l.weight = 1e20f; }); });
  expect_refused("an error below nothing",
                 [&](SolverState& s) { with_first_link(s, [](Link& l) { l.error = -1.f; }); });
  for (const float light : {kInfinity, -1.f, 1e30f})
    expect_refused("light that cannot be",
                   [&](SolverState& s) { s.irradiance[ElementId(0)].r = light; });
  expect_refused("more reflected than falls on it",
                 [](SolverState& s) { s.reflectance[ElementId(1)].g = 1.5f; });
  expect_refused("no tolerance at all", [](SolverState& s) { s.tolerance[ElementId(0)] = 0.f; });
  expect_refused("an error beyond all sense aimed at",
                 [](SolverState& s) { s.schedule.coarseness = 1e30f; });
  expect_refused("a level beyond the last", [](SolverState& s) { s.schedule.level = 9; });
  expect_refused("a level before the first", [](SolverState& s) { s.schedule.level = -1; });
  expect_refused("links of a round to come", [](SolverState& s) {
    s.sampled[ElementId(0)] = static_cast<std::uint8_t>(s.schedule.round + 1);
  });
  expect_refused("more receivers than there are", [](SolverState& s) {
    s.schedule.receivers.assign(s.schedule.receiver_total + 1, s.tree.root());
  });
  expect_refused("more pairs than links", [](SolverState& s) {
    s.schedule.pairs.assign(s.links.size() + 2, {s.tree.root(), s.tree.root()});
  });
  expect_refused("other options than those asked for",
                 [](SolverState& s) { s.options.levels = 7; });
  expect_refused("next to no error aimed at", [](SolverState& s) { s.options.error = 1e-30f; });
  expect_refused("more error aimed at than asked for",
                 [](SolverState& s) { s.options.error *= 2.f; });
  expect_refused("a cell that was split without end", [](SolverState& s) {
    ElementId e(0);
    while (!s.tree[e].is_leaf_cell()) e = s.tree[e].children()[0];
    for (int k = 0; k < 60; ++k) {
      s.tree.split(e);
      e = s.tree[e].children()[0];
    }
    const std::size_t n = s.tree.size();
    for_each_field(s, [n]<class Field>(std::string_view, Field& field, auto&&...) {
      if constexpr (requires { field.raw(); }) field.resize(field.empty() ? 0 : n);
    });
    s.tolerance.raw().assign(n, 1.f);
  });
  expect_refused("too few values", [](SolverState& s) { s.tolerance.raw().pop_back(); });
  expect_refused("no values", [](SolverState& s) { s.radiosity.clear(); });
  expect_refused("more cells than values", [](SolverState& s) {
    for (std::size_t i = 0;; ++i) {
      const Element& e = s.tree[ElementId(i)];
      if (!e.is_leaf_cell()) continue;
      s.tree.split(ElementId(i));
      return;
    }
  });
}

TEST_P(StoredSolve, OnlyGoesOnWithTheSameSolve) {
  write(make_state(world_, options_));
  const auto checkpoint = Checkpoint::open(folder_.path() / "checkpoint");
  ASSERT_TRUE(checkpoint) << checkpoint.error().line();
  EXPECT_TRUE(checkpoint->check(origin_));
  const auto line = [&](const auto& change) {
    SolveOrigin wanted = origin_;
    change(wanted);
    const auto same = checkpoint->check(wanted);
    return same ? std::string() : same.error().line();
  };
  EXPECT_THAT(line([](SolveOrigin& o) { o.options.error = 0.01f; }),
              HasSubstr("error is 0.3 there and 0.01 here"));
  EXPECT_THAT(line([](SolveOrigin& o) { o.options.visibility = VisibilityMode::average; }),
              HasSubstr("visibility is multires there and average here"));
  EXPECT_THAT(line([](SolveOrigin& o) { ++o.scene_digest; }), HasSubstr("another scene"));
  EXPECT_THAT(line([](SolveOrigin& o) { o.scene.load.metres_per_unit = 2.0; }),
              HasSubstr("its unit is 1 m, not 2 m"));
  EXPECT_THAT(line([](SolveOrigin& o) { o.scene.load.up = UpAxis::z; }), HasSubstr("another axis"));
  EXPECT_THAT(line([](SolveOrigin& o) { o.scene.sky = Rgb(1.f); }),
              HasSubstr("its sky is 0,0,0, not 1,1,1"));
}

TEST_P(StoredSolve, FindsItsSceneAgain) {
  write(make_state(world_, options_));
  const auto checkpoint = Checkpoint::open(folder_.path() / "checkpoint");
  ASSERT_TRUE(checkpoint);
  EXPECT_TRUE(checkpoint->load_scene());
  std::filesystem::rename(origin_.scene.path, folder_.path() / "moved.glb");
  const auto gone = checkpoint->load_scene();
  ASSERT_FALSE(gone);
  EXPECT_THAT(gone.error().line(), HasSubstr("--scene"));
  EXPECT_TRUE(checkpoint->load_scene(folder_.path() / "moved.glb"));
  LooseTrianglesParameters p;
  p.count = 61;
  ASSERT_TRUE(write_scene_glb(origin_.scene.path, loose_triangles_scene(p)));
  const auto changed = checkpoint->load_scene();
  ASSERT_FALSE(changed);
  EXPECT_THAT(changed.error().line(), HasSubstr("not the scene that was solved"));
}

INSTANTIATE_TEST_SUITE_P(Links, StoredSolve,
                         ::testing::Values(LinkMaker::refined, LinkMaker::sampled),
                         [](const auto& test) {
                           return test.param == LinkMaker::refined ? "Refined" : "Sampled";
                         });

TEST(Settings, AreTheSameAfterBeingText) {
  SolveOptions options;
  options.feature_size = 0.1f;
  options.visibility = VisibilityMode::average;
  options.visibility_pilot = false;
  options.error = 1.f / 3.f;
  options.links = LinkMaker::refined;
  options.hierarchy = HierarchyKind::goldsmith_salmon;
  options.intra_cluster = false;
  options.levels = 5;
  options.most_links = 123;
  const auto read = parse_settings(to_text(options));
  ASSERT_TRUE(read);
  EXPECT_EQ(difference(options, *read), "");
  EXPECT_EQ(read->error, options.error);
  EXPECT_EQ(difference(options, SolveOptions()), "feature-size is 0.1 there and -1 here");
}

TEST(Settings, OfPartsAndViewsAreTheSameAfterBeingText) {
  SolveOptions options;
  options.feature_size = 0.1f;
  options.feature_size_rules = {{"Floor*", "", 0.02f}, {"", "a \"desk\"", 0.f}};
  ViewOfInterest view{PlacedCamera(), 640, 360};
  view.camera.position = {1.f, -2.5f, 1.f / 3.f};
  options.importance = view;
  options.pixels = PixelFeatureSize{view, 12.f};
  const std::string text = to_text(options);
  const auto read = parse_settings(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(to_text(*read), text);
  ASSERT_EQ(read->feature_size_rules.size(), 2u);
  EXPECT_EQ(read->feature_size_rules[1].node, "a \"desk\"");
  EXPECT_EQ(read->importance->camera.position, view.camera.position);
  EXPECT_EQ(read->pixels->view.height, 360);
  EXPECT_EQ(read->pixels->pixels, 12.f);
  const auto with = [&](std::string_view from, std::string_view to) {
    std::string changed = text;
    const std::size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return changed.replace(at, from.size(), to);
  };
  EXPECT_FALSE(parse_settings(with("0.019999", "-0.019999")));  // a rule's size
  EXPECT_FALSE(parse_settings(with("\"Floor*\"", "7")));
  EXPECT_FALSE(parse_settings(with("Floor*", std::string(kLongestRuleName + 1, 'a'))));
  EXPECT_FALSE(parse_settings(with("12.0", "0")));
  EXPECT_FALSE(parse_settings(with("-2.5", "1e99")));  // more than a float holds
  EXPECT_FALSE(parse_settings(with("-2.5", "true")));
  EXPECT_FALSE(parse_settings(with("640", "0")));
  EXPECT_FALSE(parse_settings(with("360", "1e9")));
  EXPECT_FALSE(parse_settings(with("importance [", "importance [[")));
}

TEST(Settings, NonsenseIsRefused) {
  const std::string text = to_text(resolved({}, World(Scene())));
  EXPECT_TRUE(parse_settings(text));
  EXPECT_FALSE(parse_settings(""));
  EXPECT_FALSE(parse_settings(text + "more 1\n"));
  const auto with = [&](std::string_view from, std::string_view to) {
    std::string changed = text;
    const std::size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return changed.replace(at, from.size(), to);
  };
  EXPECT_FALSE(parse_settings(with("error 0.05", "error nan")));
  EXPECT_FALSE(parse_settings(with("error 0.05", "error -1")));
  EXPECT_FALSE(parse_settings(with("error 0.05", "error 0")));
  EXPECT_FALSE(parse_settings(with("error 0.05", "error 1e9")));
  EXPECT_FALSE(parse_settings(with("levels 3", "levels 3x")));
  EXPECT_FALSE(parse_settings(with("levels 3", "levels 0")));
  EXPECT_FALSE(parse_settings(with("levels 3", "levels 2000000000")));
  EXPECT_FALSE(parse_settings(with("visibility multires", "visibility sharp")));
  EXPECT_FALSE(parse_settings(with("links sampled", "links woven")));
}

}  // namespace
}  // namespace halflight
