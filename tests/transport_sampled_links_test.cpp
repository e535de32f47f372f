// Links made by rays: the rows of cells and clusters, and direct light on clusters.
#include "halflight/transport/sampled_links.h"

#include <gtest/gtest.h>

#include "closed_forms.h"
#include "quad_scene.h"
#include "solved_scene.h"

namespace halflight {
namespace {

using testing::QuadScene;

constexpr int kRays = 8192;

// The order in which QuadScene::box draws its sides, two triangles each.
constexpr std::size_t kLeft = 0, kRight = 2, kBottom = 4, kTop = 6;

// Elements of a scene, and all light cast by so many rays that little noise is left.
struct LinkedScene {
  SolverState state;
  SampledLinkOptions options;

  explicit LinkedScene(const QuadScene& scene)
      : state(make_state(make_world(scene.scene), testing::options_of(LinkMaker::sampled, 0.1f))) {
    options.rays_per_cell = options.rays_per_cluster = options.shadow_rays_per_cluster = kRays;
  }
  ElementId front_of(std::size_t triangle) const {
    return state.tree.side_root(side_of(state.surfaces->of_triangle[TriangleId(triangle)], false));
  }
  // The smallest cluster around the box whose first triangle this is.
  ElementId cluster_of_box(std::size_t triangle) const {
    ElementId e = front_of(triangle);
    while (!state.tree.contains(e, front_of(triangle + kRight)) ||
           !state.tree.contains(e, front_of(triangle + kTop)))
      e = state.tree[e].parent;
    return e;
  }
  std::vector<ReceiverLink> links(ElementId receiver) const {
    return sample_links(state.tree, state.world->rays, state.opacity, {receiver}, options);
  }
  float weight(ElementId receiver, ElementId source) const {
    float sum = 0.f;
    for (const ReceiverLink& l : links(receiver))
      if (state.tree.contains(source, l.link.source)) sum += l.link.weight;
    return sum;
  }
  DirectLight direct_light(ElementId cluster) const {
    const EmitterTree emitters(*state.visibility, find_emitters(*state.world));
    return sample_direct_light(state.tree, *state.visibility, emitters, cluster, options);
  }
};

TEST(SampledLinks, OfACellInAClosedRoomAreTheFormFactors) {
  QuadScene scene;
  scene.box({0, 0, 0}, {2, 1, 1.5f}, scene.material(0.5f, 1.f), true);
  const LinkedScene room(scene);
  const ElementId floor = room.front_of(kBottom);
  EXPECT_NEAR(room.weight(floor, room.state.tree.root()), 1.f, 1e-4f);
  const auto ceiling = static_cast<float>(testing::factor_of_parallel_rectangles(2, 1.5, 1));
  const auto wall = static_cast<float>(testing::factor_of_perpendicular_rectangles(2, 1, 1.5));
  EXPECT_NEAR(room.weight(floor, room.front_of(kTop)), ceiling, 0.02f * ceiling);
  EXPECT_NEAR(room.weight(floor, room.front_of(kLeft)), wall, 0.02f * wall);
}

// Rays that begin under a closed body count for the rest of the cell.
TEST(SampledLinks, OfACellThatIsPartlyBuriedStillAddUpToOne) {
  QuadScene scene;
  const MaterialId glowing = scene.material(0.5f, 1.f);
  scene.box({0, 0, 0}, {2, 1, 1.5f}, glowing, true);
  scene.box({0.3f, 0, 0.4f}, {1.2f, 0.2f, 1.f}, glowing, false);
  const LinkedScene room(scene);
  EXPECT_NEAR(room.weight(room.front_of(kBottom), room.state.tree.root()), 1.f, 1e-4f);
}

// What stops few of the rays sends little by itself: the links carry the whole form factor.
TEST(SampledLinks, ToATranslucentPanelDoNotCountItsOpacityTwice) {
  QuadScene scene;
  scene.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, scene.material(0.5f));
  const MaterialId glowing = scene.pane(0.4f);
  scene.scene.materials[glowing].emission = Rgb(1.f);
  scene.quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, glowing);
  const LinkedScene plates(scene);
  const auto expected = static_cast<float>(testing::factor_of_parallel_rectangles(1, 1, 1));
  EXPECT_NEAR(plates.weight(plates.front_of(0), plates.front_of(2)), expected, 0.05f * expected);
}

// A box of 10 cm as one receiver.
class BoxAsOne : public ::testing::Test {
 protected:
  QuadScene scene;
  const Vec3 middle{0.05f};

  // To be drawn first.
  void draw_box() { scene.box(Vec3(0.f), Vec3(0.1f), scene.material(0.5f), false); }
  static ElementId box_of(const LinkedScene& s) {
    const ElementId box = s.cluster_of_box(0);
    EXPECT_NEAR(s.state.tree[box].area, 0.06f, 1e-6f);
    return box;
  }
  // Of sides that face any way, here a handful.
  static void expect_everywhere(const DirectionalIrradiance& light, float irradiance) {
    for (std::uint32_t k = 0; k < 20; ++k)
      EXPECT_NEAR(light.irradiance(uniform_sphere(r2_sequence(k))).g, irradiance,
                  0.03f * irradiance);
  }
};

TEST_F(BoxAsOne, InARoomOfEvenRadiosityGetsThatAsIrradiance) {
  draw_box();
  scene.box(Vec3(-2.f), Vec3(3.f, 1.f, 2.f), scene.material(0.5f, 1.f), true);
  const LinkedScene room(scene);
  std::vector<Arrival> arrivals;
  for (const ReceiverLink& l : room.links(box_of(room)))
    arrivals.push_back({l.link.direction.unpack(), Rgb(l.link.weight)});
  expect_everywhere(directional_irradiance(arrivals), 1.f);
}

TEST_F(BoxAsOne, UnderAnEvenSkyGetsPiTimesItsRadiance) {
  draw_box();
  scene.quad({50, 0, 0}, {1, 0, 0}, {0, 1, 0}, scene.material(0.5f));
  scene.scene.sky = Rgb(2.f);
  const LinkedScene open(scene);
  expect_everywhere(directional_irradiance(open.direct_light(box_of(open)).from_outside),
                    2.f * kPi);
}

// A panel 6 m away, tilted by 60 degrees: radiance, area and cosine over squared distance, and
// nothing when the other way round.
TEST_F(BoxAsOne, GetsTheLightOfThePanelsThatFaceIt) {
  for (const bool towards : {true, false}) {
    scene = {};
    scene.scene.sky = Rgb(1.f);  // so that no side is without light
    draw_box();
    const Vec3 u(0.1f, 0.1f * std::sqrt(3.f), 0.f), v(0.f, 0.f, 0.2f);  // 20 cm each
    const Vec3 corner = middle + Vec3(0.f, 6.f, 0.f) - 0.5f * (u + v);
    const MaterialId glowing = scene.material(0.f, 5.f);
    if (towards)
      scene.quad(corner, u, v, glowing);
    else
      scene.quad(corner, v, u, glowing);
    const LinkedScene lit(scene);
    float sum = 0.f;
    for (const Arrival& a : lit.direct_light(box_of(lit)).of_emitters) sum += a.facing.g;
    const float expected = towards ? 5.f * 0.04f * 0.5f / 36.f : 0.f;
    EXPECT_NEAR(sum, expected, 0.03f * expected) << towards;
  }
}

}  // namespace
}  // namespace halflight
