// The item buffer against lines through boxes.
#include "halflight/transport/item_buffer.h"

#include <gtest/gtest.h>

#include "solved_scene.h"
#include "stacked_books.h"

namespace halflight {
namespace {

using testing::QuadScene;

// All live sides of a scene as items.
struct Items {
  SolverState state;
  std::vector<ElementId> cells;

  explicit Items(Scene scene)
      : state(make_state(make_world(std::move(scene)),
                         testing::options_of(LinkMaker::refined, 0.1f))) {
    for (std::size_t i = 0; i < state.tree.size(); ++i)
      if (!state.tree[ElementId(i)].is_cluster()) cells.emplace_back(i);
  }
  std::vector<float> visible(const Vec3& d) const {
    return visible_areas(state.tree, cells, state.opacity, d);
  }
  float facing(std::size_t i, const Vec3& d) const {
    return state.tree[cells[i]].area * std::max(0.f, glm::dot(state.tree.normal(cells[i]), d));
  }
  float facing(const Vec3& d) const {
    float sum = 0.f;
    for (std::size_t i = 0; i < cells.size(); ++i) sum += facing(i, d);
    return sum;
  }
};

float total(const std::vector<float>& areas) {
  double sum = 0;
  for (const float a : areas) sum += static_cast<double>(a);
  return static_cast<float>(sum);
}

TEST(ItemBuffer, OfABoxShowsExactlyTheFacesTowardsTheViewer) {
  QuadScene scene;
  scene.box({1, 2, 3}, {2, 4, 3.5f}, scene.material(0.5f), false);
  scene.scene.sky = Rgb(1.f);
  const Items box(scene.scene);
  ASSERT_EQ(box.cells.size(), 6u);
  const Vec3 d = glm::normalize(Vec3(1.f, -0.6f, 0.4f));
  const std::vector<float> visible = box.visible(d);
  int seen = 0;
  for (std::size_t i = 0; i < box.cells.size(); ++i) {
    EXPECT_FLOAT_EQ(visible[i], box.facing(i, d));
    seen += visible[i] > 0.f ? 1 : 0;
  }
  EXPECT_EQ(seen, 3);
}

class StackedBooks : public ::testing::TestWithParam<Vec3> {
 protected:
  Vec3 direction() const { return glm::normalize(GetParam()); }
  const Items books_{testing::scene_of_books()};
};

TEST_P(StackedBooks, ShowTheirSilhouette) {
  EXPECT_NEAR(total(books_.visible(direction())) / testing::count_lines(direction()).silhouette,
              1.f, 0.02f);
}

// Without the buffer every book on a line would be lit.
TEST_P(StackedBooks, FaceTheViewerInMoreThanOneLayer) {
  const testing::BookLines lines = testing::count_lines(direction());
  EXPECT_GT(lines.facing_layers, 1.3f);
  EXPECT_NEAR(books_.facing(direction()) / lines.silhouette / lines.facing_layers, 1.f, 0.02f);
}

TEST_P(StackedBooks, HaveOneSilhouetteFromBothEndsOfALine) {
  EXPECT_NEAR(total(books_.visible(direction())) / total(books_.visible(-direction())), 1.f, 0.02f);
}

INSTANTIATE_TEST_SUITE_P(Directions, StackedBooks,
                         ::testing::Values(Vec3(0.3f, 0.5f, 1.f), Vec3(1.f, 0.2f, 0.3f),
                                           Vec3(-0.7f, 0.3f, -1.f), Vec3(0.1f, 1.f, -0.6f)));

TEST(ItemBuffer, ShowsNothingOfABookBehindTheOthers) {
  const Items books(testing::scene_of_books());
  const Bounds3f last = testing::stacked_books().back();
  const Vec3 d = glm::normalize(Vec3(0.f, 0.f, 1.f));
  const std::vector<float> visible = books.visible(d);
  float facing = 0.f;
  for (std::size_t i = 0; i < books.cells.size(); ++i) {
    if (!last.contains(books.state.tree[books.cells[i]].center())) continue;
    EXPECT_EQ(visible[i], 0.f);
    facing += books.facing(i, d);
  }
  EXPECT_GT(facing, 0.002f);
}

TEST(ItemBuffer, ThinPanesHideNothingAndAreHidden) {
  QuadScene scene;
  const MaterialId wall = scene.material(0.5f, 0.f, true), pane = scene.pane(0.3f);
  scene.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, wall);
  scene.quad({0.2f, 0.2f, 0.1f}, {0.6f, 0, 0}, {0, 0.6f, 0}, pane);
  scene.quad({0.2f, 0.2f, -0.1f}, {0.6f, 0, 0}, {0, 0.6f, 0}, pane);
  scene.scene.sky = Rgb(1.f);
  const Items items(scene.scene);
  const std::vector<float> visible = items.visible(Vec3(0, 0, 1));
  for (std::size_t i = 0; i < items.cells.size(); ++i) {
    const Element& e = items.state.tree[items.cells[i]];
    const bool hidden = items.state.tree.normal(items.cells[i]).z < 0.f || e.center().z < -0.05f;
    EXPECT_FLOAT_EQ(visible[i], hidden ? 0.f : e.area);
  }
}

// A thousand leaves far below a pixel: together they show what a count of lines finds.
TEST(ItemBuffer, SharesTheLightAmongThingsBelowAPixel) {
  QuadScene scene;
  const MaterialId leaf = scene.material(0.5f, 0.f, true);
  constexpr int kLeaves = 4000;
  constexpr float kSide = 0.002f;  // in a cube of 1 m: a pixel is 4 mm or more
  for (std::uint64_t i = 0; i < kLeaves; ++i) {
    const Vec2 a = random_shift(hash(i, 1)), b = random_shift(hash(i, 2));
    scene.quad({a.x, a.y, b.x}, {kSide, 0, 0}, {0, kSide, 0}, leaf);
  }
  scene.scene.sky = Rgb(1.f);
  const Items leaves(scene.scene);
  const std::vector<float> visible = leaves.visible(Vec3(0, 0, 1));
  // Hardly one lies before another.
  EXPECT_NEAR(total(visible) / (kLeaves * kSide * kSide), 1.f, 0.1f);
  EXPECT_LT(*std::max_element(visible.begin(), visible.end()), 50.f * kSide * kSide);
}

// Between the light that comes from pixels and areas below one: what has no pixel has no light.
TEST(ItemBuffer, GivesThingsBelowAPixelNothingBehindAWall) {
  QuadScene scene;
  const MaterialId grey = scene.material(0.5f, 0.f, true);
  constexpr int kLeaves = 400;
  constexpr float kSide = 0.002f;
  for (const float side : {-1.f, 1.f})
    for (std::uint64_t i = 0; i < kLeaves; ++i) {
      const Vec2 a = 0.8f * random_shift(hash(i, 3)) + 0.1f;
      scene.quad({a.x, a.y, 0.3f * side}, {kSide, 0, 0}, {0, kSide, 0}, grey);
    }
  scene.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, grey);
  scene.scene.sky = Rgb(1.f);
  const Items items(scene.scene);
  const std::vector<float> visible = items.visible(Vec3(0, 0, 1));
  float before = 0.f;
  for (std::size_t i = 0; i < items.cells.size(); ++i) {
    const float z = items.state.tree[items.cells[i]].center().z;
    EXPECT_TRUE(z >= 0.f || visible[i] == 0.f) << i;
    if (z > 0.f) before += visible[i];
  }
  EXPECT_NEAR(before / (kLeaves * kSide * kSide), 1.f, 0.3f);
}

TEST(ItemBuffer, IsAsFineAsTheSmallestItemAsks) {
  const Bounds3f box{Vec3(0.f), Vec3(1.f, 0.5f, 0.2f)};
  EXPECT_EQ(item_resolution(box, 1.f), 32);
  EXPECT_EQ(item_resolution(box, 4e-4f), 100);
  EXPECT_EQ(item_resolution(box, 1e-9f), 256);
}

}  // namespace
}  // namespace halflight
