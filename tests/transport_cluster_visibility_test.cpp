// Visibility inside clusters at both ends of a link.
#include "halflight/transport/cluster_visibility.h"

#include <gtest/gtest.h>

#include "halflight/transport/transfer.h"
#include "solved_scene.h"
#include "stacked_books.h"

namespace halflight {
namespace {

using testing::QuadScene;

TEST(DirectionCells, HoldTheirMiddleAndHaveAnOpposite) {
  for (int cell = 0; cell < kDirectionCells; ++cell) {
    EXPECT_EQ(direction_cell(direction_of_cell(cell)), cell);
    EXPECT_NE(opposite_cell(cell), cell);
    EXPECT_EQ(opposite_cell(opposite_cell(cell)), cell);
  }
}

TEST(DirectionCells, AreOfAboutEqualSize) {
  constexpr std::uint32_t kDirections = 100000;
  std::vector<int> count(kDirectionCells);
  for (std::uint32_t i = 0; i < kDirections; ++i)
    ++count[direction_cell(uniform_sphere(r2_sequence(i)))];
  for (const int n : count) EXPECT_NEAR(n * kDirectionCells, kDirections, 0.2 * kDirections);
}

// Both ends of a link: clusters of books, one opposite the other, all of it glowing evenly.
struct BookEnds {
  SolverState state;
  std::vector<ElementId> ends;
  ClusterVisibility inside;

  BookEnds() : state(make_state(make_world(scene()), options())) {
    for (const ElementId child : state.tree[state.tree.root()].children())
      if (state.tree[child].is_cluster()) ends.push_back(child);
    inside = ClusterVisibility(state.tree, state.opacity, ends);
  }
  static SolveOptions options() {
    SolveOptions options = testing::options_of(LinkMaker::refined, 0.1f);
    options.intra_cluster = false;
    return options;
  }
  static Scene scene() {
    QuadScene scene;
    const MaterialId glowing = scene.material(0.5f, 1.f);
    for (const Vec3 at : {Vec3(0.f), Vec3(1.9f, 0.7f, 2.f)})
      for (const Bounds3f& book : testing::stacked_books())
        scene.box(at + book.lower, at + book.upper, glowing, false);
    scene.scene.sky = Rgb(1.f);
    return scene.scene;
  }
  TransferScene transfer() const {
    return {state.tree, *state.visibility, 0.f, state.radiosity, state.opacity, &inside};
  }
};

TEST(ClusterVisibility, KnowsBooksThatHideEachOther) {
  const BookEnds books;
  ASSERT_EQ(books.ends.size(), 2u);
  for (const ElementId end : books.ends) {
    ASSERT_TRUE(books.inside.knows(end));
    EXPECT_EQ(books.inside.items(end).size(), 6 * testing::stacked_books().size());
  }
  EXPECT_FALSE(books.inside.knows(books.state.tree.root()));
}

TEST(ClusterVisibility, OfAConvexBodyThereIsNothingToKnow) {
  QuadScene scene;
  const MaterialId grey = scene.material(0.5f, 1.f);
  scene.box({0, 0, 0}, {1, 2, 3}, grey, false);
  const SolverState state =
      make_state(make_world(scene.scene), testing::options_of(LinkMaker::refined, 0.1f));
  const ElementId root = state.tree.root();
  EXPECT_FALSE(ClusterVisibility(state.tree, state.opacity, {&root, 1}).knows(root));
}

TEST(ClusterVisibility, OneLinkGivesTheSilhouetteItsLightAndHiddenFacesNothing) {
  const BookEnds books;
  const ElementId end = books.ends.front();
  const auto items = books.inside.items(end);
  const Bounds3f hidden = testing::stacked_books().back();
  for (int cell = 0; cell < kDirectionCells; ++cell) {
    const Vec3 d = direction_of_cell(cell);
    const Arrival link{d, Rgb(2.f)};
    const std::vector<Rgb> irradiance = hand_out(books.inside, end, {&link, 1});
    float given = 0.f, all = 0.f;
    for (std::size_t i = 0; i < items.size(); ++i) {
      const float facing = std::max(0.f, glm::dot(items[i].normal, d));
      given += items[i].area * irradiance[i].g;
      all += items[i].area * 2.f * facing;
      const Vec3 center = books.state.tree[items[i].cell].center();
      // From in front and above, row and pile stand before the small book.
      const bool dark = d.z > 0.8f && d.y > 0.2f && hidden.contains(center);
      EXPECT_LE(irradiance[i].g, dark ? 0.f : 2.f * facing);
    }
    const testing::BookLines lines = testing::count_lines(d);
    // The cached pictures are as coarse as the items are few.
    EXPECT_NEAR(given / (2.f * lines.silhouette), 1.f, 0.03f) << cell;
    EXPECT_NEAR(all / (2.f * lines.silhouette), lines.facing_layers, 0.02f * lines.facing_layers);
    EXPECT_NEAR(books.inside.facing_area(end, d).seen / lines.silhouette, 1.f, 0.03f);
    EXPECT_LE(books.inside.facing_area(end, d).seen, 1.001f * books.inside.largest_silhouette(end));
  }
}

// Where all weights are means over what faces the other end, concentrated on what is seen.
TEST(ClusterVisibility, ConcentrationKeepsTheEnergy) {
  const BookEnds books;
  const ElementId end = books.ends.front();
  const auto items = books.inside.items(end);
  for (std::uint32_t k = 0; k < 50; ++k) {
    const Vec3 w = uniform_sphere(r2_sequence(k));
    const auto area = books.inside.facing_area(end, w);
    const Arrival link{w, Rgb(books.inside.concentration(end, w, false))};
    const std::vector<Rgb> irradiance = hand_out(books.inside, end, {&link, 1});
    float given = 0.f;
    for (std::size_t i = 0; i < items.size(); ++i) given += items[i].area * irradiance[i].g;
    EXPECT_NEAR(given / area.all, 1.f, 1e-4f);
  }
}

// What one end shows is what it receives by: A_r F_rs = A_s F_sr with visible projected areas.
TEST(ClusterVisibility, SwappingTheEndsOfALinkKeepsThePower) {
  const BookEnds books;
  const ElementId a = books.ends[0], b = books.ends[1];
  const Vec3 to_b = glm::normalize(books.state.tree[b].center() - books.state.tree[a].center());
  // The samples of one stream pair the same places: a mean over many.
  constexpr int kStreams = 512, kSamples = 64;
  const auto power = [&](ElementId receiver, ElementId source, const Vec3& w) {
    float weight = 0.f;
    for (int stream = 0; stream < kStreams; ++stream)
      weight += estimate_transfer(books.transfer(), receiver, source, kSamples,
                                  static_cast<std::uint64_t>(stream))
                    .weight /
                kStreams;
    return weight * books.inside.facing_area(receiver, w).all;
  };
  const float to_a = power(a, b, to_b), from_a = power(b, a, -to_b);
  EXPECT_NEAR(to_a / from_a, 1.f, 0.03f);
  // Silhouettes are small beside the distance: the transfer is A_a A_b / (pi r^2).
  const float r = glm::length(books.state.tree[b].center() - books.state.tree[a].center());
  const float expected = testing::count_lines(to_b).silhouette *
                         testing::count_lines(-to_b).silhouette / (kPi * r * r);
  EXPECT_NEAR(to_a / expected, 1.f, 0.06f);
}

TEST(ClusterVisibility, AnEndSendsTheLightOfWhatIsSeenOfIt) {
  BookEnds books;
  const ElementId end = books.ends.front();
  const Vec3 d = glm::normalize(Vec3(0.3f, 0.4f, 1.f));
  const int cell = direction_cell(d);
  const auto items = books.inside.items(end);
  // Only what is hidden from there glows.
  for (std::size_t i = 0; i < items.size(); ++i)
    books.state.radiosity[items[i].cell] = Rgb(books.inside.share(end, i, cell) == 0.f ? 1.f : 0.f);
  EXPECT_EQ(books.inside.seen_radiosity(end, cell, books.state.radiosity), Rgb(0.f));
  for (const ClusterVisibility::Item& item : items) books.state.radiosity[item.cell] = Rgb(3.f);
  EXPECT_NEAR(books.inside.seen_radiosity(end, cell, books.state.radiosity).g, 3.f, 1e-4f);
}

}  // namespace
}  // namespace halflight
