// A binary tree over emitting triangles, or cells that reflect much light, for direct light by a
// cut: near emitters one by one, weak ones and far groups by some of them chosen at random (after
// Walter et al. 2005, "Lightcuts").
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "halflight/base/vec.h"
#include "halflight/hierarchy/elements.h"
#include "halflight/visibility/visibility.h"

namespace halflight {

struct DirectLightOptions {
  // To an emitter that gives a quarter of the light or more, others take fewer in proportion.
  int shadow_rays = 16;    // before looking closer
  int penumbra_rays = 64;  // where the first ones disagree; weak emitters together take half
  // Irradiance, W/m2: an emitter that would give more if nothing hid it takes as many times the
  // rays in penumbrae, and the root of that to begin with. 0: however much it gives.
  float plain_light = 0.f;
  // Emitters and groups of them are weak when they give at most this share of the light at the
  // point, groups also when they are seen under at most this angle (size / distance).
  float largest_group_share = 0.01f;
  float smallest_angle = 0.01f;
  float feature_size = 0.f;  // of shadows that count, metres; 0: all
};

// One side of a triangle that shines with a radiance of its own, or of a piece of a cell.
struct EmittingSide {
  std::array<Vec3, 3> corners;
  TriangleId triangle;  // of the scene, that it is or whose plane it lies in
  ElementId cell;       // invalid: a triangle of the scene
  bool back = false;    // from the clockwise side of the scene's triangle
  Rgb radiance{0.f};    // mean over the triangle, times its opacity
  bool varies = false;  // over the triangle
  float power = 0.f;    // average(radiance) * area
};

// Radiance of one place on an emitter that varies, times its opacity, as it counts at a place this
// far away.
using RadianceAt = std::function<Rgb(const EmittingSide&, const Vec3& y, float distance)>;

// All emitting sides of the scene's triangles.
std::vector<EmittingSide> find_emitters(const World& world);

// A place on an emitter, chosen at random.
struct EmitterPoint {
  std::uint32_t emitter = 0;
  Vec3 position{0.f};
  Vec3 normal{0.f, 1.f, 0.f};  // unit, of the side that shines
  Rgb power{0.f};              // radiance over the density with which it was chosen, W/sr
};

class EmitterTree {
 public:
  // Refers to the visibility. By default what varies is the emission of the scene.
  EmitterTree(const Visibility& visibility, std::vector<EmittingSide> emitters,
              RadianceAt radiance_at = {});
  bool empty() const { return emitters_.empty(); }

  // Irradiance at x with unit normal n from all emitting surfaces, shadows by the visibility. With
  // the same shift everywhere there is no noise, and penumbrae come in as many steps as there are
  // rays; different shifts make estimates that average out.
  Rgb irradiance(const Vec3& x, const Vec3& n, const DirectLightOptions& options,
                 Vec2 shift = Vec2(0.5f)) const;

  // The same if nothing stood between, roughly; of groups of emitters all that they could give.
  float unoccluded_irradiance(const Vec3& x, const Vec3& n) const;

  // Chooses a place to light something at x of the given radius, about in proportion to what it
  // sends there; u in [0, 1)^3. None: nothing can.
  std::optional<EmitterPoint> choose(const Vec3& x, float radius, const Vec3& u) const;
  // Share of the light from a place on an emitter that arrives at a point (lifted off its surface).
  float seen(std::uint32_t emitter, const Vec3& from, const Vec3& y, float feature_size) const;

 private:
  struct Node {
    Bounds3f box;
    Vec3 axis{0.f};          // of the cone that holds all emitter normals
    float cos_spread = 1.f;  // -1: no cone
    float power = 0.f;
    std::uint32_t first = 0, count = 0;  // emitters
    std::uint32_t right = 0;             // second child; the first follows its parent; 0: a leaf
  };
  struct CutNode {
    std::uint32_t node = 0;
    float expected = 0.f;  // unoccluded irradiance, roughly
  };

  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  bool cannot_light(const Node& node, const Vec3& x, const Vec3& n) const;
  float expected_irradiance(const Node& node, const Vec3& x, const Vec3& n) const;
  std::vector<CutNode> choose_cut(const Vec3& x, const Vec3& n,
                                  const DirectLightOptions& options) const;
  Vec3 normal_of(const EmittingSide& e) const;
  Rgb from_triangle(std::uint32_t emitter, const Vec3& x, const Vec3& n, int rays, int more_rays,
                    Vec2 shift, float feature_size) const;
  // If all of it shone towards x, from its nearest point.
  static float sent_to(const Node& node, const Vec3& x, float least_distance);
  // One ray each to emitters chosen at random below these nodes.
  Rgb from_some(std::span<const CutNode> nodes, const Vec3& x, const Vec3& n, int rays, Vec2 shift,
                float feature_size) const;
  struct ChosenEmitter {
    std::uint32_t emitter = 0;
    float probability = 0.f;
  };
  // One of the emitters below a node, in proportion to estimate(node) on the way down, choice in
  // [0, 1); probability 0: nothing is expected of any.
  template <class Estimate>
  ChosenEmitter choose_below(std::uint32_t node, float choice, const Estimate& estimate) const;

  ChosenEmitter choose_below(std::uint32_t node, float choice, const Vec3& x, const Vec3& n) const;

  struct Shape {
    Vec3 middle, normal;
    float size = 0.f;  // diameter about the middle
    float area = 0.f;
  };

  const Visibility* visibility_;
  const World* world_;
  std::vector<EmittingSide> emitters_;
  RadianceAt radiance_at_;
  std::vector<Shape> shapes_;  // of each emitter
  std::vector<Node> nodes_;
};

}  // namespace halflight
