#include "halflight/transport/emitter_tree.h"

#include <algorithm>
#include <array>
#include <bit>

#include "halflight/rays/sampling.h"
#include "halflight/rays/spherical_triangle.h"
#include "halflight/transport/form_factor.h"

namespace halflight {
namespace {

// Fewer rays that agree say little: stopping only where they agree would lose what they missed.
constexpr int kRaysToJudgeBy = 8;
// Emitters that cover more of the sky (sr) are sampled by solid angle, others by area.
constexpr float kLargeView = 2e-3f;
// From this many times its size away a triangle's form factor is that of its middle, to 1 %.
constexpr float kFar = 5.f;
// Rays disagree when their visibilities spread by more than this.
constexpr float kMixed = 0.1f;
// Places of a triangle looked at, however few rays go there.
constexpr int kLeastPlaces = 8, kLeastPlacesInView = 3;  // in view: by solid angle and cosine
// An emitter that gives this much of the light takes all rays, others in proportion.
constexpr float kShareOfAllRays = 0.25f;
constexpr float kMostTimesRays = 16.f;  // where it would give more than plain light
// Distances from a group count from this much of its size, where they bound what it gives less.
constexpr float kNearGroup = 0.25f, kLeastDistance = 0.01f;
constexpr std::uint32_t kChoices = ~0u;  // a stream of samples beside those of the emitters
// Directions below the horizon keep this much of the cosine that samples follow.
constexpr float kLeastCosine = 0.01f;

constexpr std::uint32_t kPlacesOfMean = 16;

constexpr DirectLightOptions kRoughly{.largest_group_share = 0.1f, .smallest_angle = 0.2f};

// Cosine of the angle between two directions less a third one's opening, never below -1.
float cosine_of_difference(float cos_a, float cos_b) {
  if (cos_a >= cos_b) return 1.f;
  const float sin_a = std::sqrt(std::max(0.f, 1.f - cos_a * cos_a));
  const float sin_b = std::sqrt(std::max(0.f, 1.f - cos_b * cos_b));
  return cos_a * cos_b + sin_a * sin_b;
}

// For samples that must not hang together with those of this shift.
Vec2 other_shift(Vec2 shift, std::uint32_t emitter) {
  return random_shift(
      hash(std::bit_cast<std::uint32_t>(shift.x), std::bit_cast<std::uint32_t>(shift.y), emitter));
}

// A translucent surface shines with the share of it that is there.
RadianceAt emitted_radiance(const World& world) {
  return [&world](const EmittingSide& e, const Vec3& y, float) {
    const Vec2 b = world.geometry.barycentric(e.triangle, y);
    return emission_at(world.scene, world.geometry, e.triangle, b) *
           opacity_at(world.scene, world.geometry, e.triangle, b);
  };
}
bool varies(const Material& m) {
  const bool holes = m.alpha_texture.valid() || m.reflectance_texture.valid();
  return m.emission_texture.valid() || (may_be_transparent(m) && holes);
}

// cos cos / r^2 between two oriented points, unit normals; without 1 / pi.
float point_kernel(const Vec3& x, const Vec3& n, const Vec3& y, const Vec3& m) {
  const Vec3 between = y - x;
  const float squared = std::max(glm::dot(between, between), 1e-20f);
  return std::max(0.f, glm::dot(n, between)) * std::max(0.f, -glm::dot(m, between)) /
         (squared * squared);
}

// Weights of the 2nd and 3rd corner at a point of a triangle's plane.
Vec2 barycentric_in(const std::array<Vec3, 3>& corners, const Vec3& p) {
  const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0], d = p - corners[0];
  const Vec3 normal = glm::cross(u, v);
  return Vec2(glm::dot(glm::cross(d, v), normal), glm::dot(glm::cross(u, d), normal)) /
         std::max(glm::dot(normal, normal), 1e-30f);
}

// Over places on the triangle, every time the same ones.
Rgb mean_radiance(const EmittingSide& emitter, const RadianceAt& radiance_at) {
  const std::uint32_t places = emitter.varies ? kPlacesOfMean : 1;
  const auto& [a, b, c] = emitter.corners;
  Rgb sum(0.f);
  for (std::uint32_t k = 0; k < places; ++k) {
    const Vec2 u = uniform_triangle(r2_sequence(k));
    sum += radiance_at(emitter, a + u.x * (b - a) + u.y * (c - a), 0.f);
  }
  return sum / static_cast<float>(places);
}

}  // namespace

std::vector<EmittingSide> find_emitters(const World& world) {
  const Geometry& g = world.geometry;
  const RadianceAt emitted = emitted_radiance(world);
  std::vector<EmittingSide> emitters;
  for (std::uint32_t i = 0; i < g.triangles.size(); ++i) {
    const TriangleId t(i);
    const Material& m = world.scene.materials[g.materials[t]];
    if (!m.emits()) continue;
    EmittingSide e;
    e.triangle = t;
    e.corners = g.corners(t);
    e.varies = varies(m);
    e.radiance = mean_radiance(e, emitted);
    e.power = average(e.radiance) * g.area(t);
    if (!(e.power > 0.f)) continue;
    emitters.push_back(e);
    if (!m.double_sided) continue;
    e.back = true;
    emitters.push_back(e);
  }
  return emitters;
}

EmitterTree::EmitterTree(const Visibility& visibility, std::vector<EmittingSide> emitters,
                         RadianceAt radiance_at)
    : visibility_(&visibility),
      world_(&visibility.world()),
      emitters_(std::move(emitters)),
      radiance_at_(radiance_at ? std::move(radiance_at) : emitted_radiance(*world_)) {
  if (emitters_.empty()) return;
  nodes_.reserve(2 * emitters_.size());
  build(0, static_cast<std::uint32_t>(emitters_.size()));
  for (const EmittingSide& e : emitters_) {
    const auto& [a, b, c] = e.corners;
    const Vec3 middle = (a + b + c) / 3.f;
    const float size = 2.f * std::max({glm::distance(a, middle), glm::distance(b, middle),
                                       glm::distance(c, middle)});
    shapes_.push_back({middle, normal_of(e), size, 0.5f * glm::length(glm::cross(b - a, c - a))});
  }
}

// Share of the light from y on an emitter that arrives.
float EmitterTree::seen(std::uint32_t emitter, const Vec3& from, const Vec3& y,
                        float feature_size) const {
  const Vec3 to = world_->rays.lift(y, shapes_[emitter].normal);
  const float size = visibility_->emitter_size(emitters_[emitter].triangle, from, to);
  return visibility_->transmittance({from, to, feature_size, size});
}

Vec3 EmitterTree::normal_of(const EmittingSide& e) const {
  return glm::normalize(world_->geometry.scaled_normal(e.triangle)) * (e.back ? -1.f : 1.f);
}

std::uint32_t EmitterTree::build(std::uint32_t first, std::uint32_t count) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.first = first;
  node.count = count;
  Bounds3f centers;
  const auto center = [](const EmittingSide& e) {
    return (e.corners[0] + e.corners[1] + e.corners[2]) / 3.f;
  };
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const Vec3& p : emitters_[i].corners) node.box.extend(p);
    node.power += emitters_[i].power;
    node.axis += emitters_[i].power * normal_of(emitters_[i]);
    centers.extend(center(emitters_[i]));
  }
  node.cos_spread = -1.f;
  if (glm::length(node.axis) > 1e-3f * node.power) {
    node.axis = glm::normalize(node.axis);
    node.cos_spread = 1.f;
    for (std::uint32_t i = first; i < first + count; ++i)
      node.cos_spread = std::min(node.cos_spread, glm::dot(node.axis, normal_of(emitters_[i])));
  }
  if (count > 1) {
    const Vec3 e = centers.extent();
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : (e.y >= e.z ? 1 : 2);
    const auto begin = emitters_.begin() + first;
    std::stable_sort(begin, begin + count, [&](const EmittingSide& a, const EmittingSide& b) {
      return center(a)[axis] < center(b)[axis];
    });
    build(first, count / 2);
    node.right = build(first + count / 2, count - count / 2);
  }
  nodes_[index] = node;
  return index;
}

bool EmitterTree::cannot_light(const Node& node, const Vec3& x, const Vec3& n) const {
  const Vec3 farthest(n.x > 0.f ? node.box.upper.x : node.box.lower.x,
                      n.y > 0.f ? node.box.upper.y : node.box.lower.y,
                      n.z > 0.f ? node.box.upper.z : node.box.lower.z);
  if (glm::dot(farthest - x, n) <= 0.f) return true;
  if (node.cos_spread <= -1.f) return false;
  // All normals n_e and directions to x keep more than a right angle apart.
  const Vec3 towards_x = x - node.box.center();
  const float distance = glm::length(towards_x), radius = 0.5f * node.box.diagonal();
  if (distance <= radius) return false;
  const float sin_box = radius / distance;
  const float cos_box = std::sqrt(std::max(0.f, 1.f - sin_box * sin_box));
  const float cos_axis = glm::dot(node.axis, towards_x) / distance;
  return cosine_of_difference(cosine_of_difference(cos_axis, node.cos_spread), cos_box) <= 0.f;
}

float EmitterTree::sent_to(const Node& node, const Vec3& x, float least_distance) {
  const Vec3 nearest = glm::clamp(x, node.box.lower, node.box.upper) - x;
  return node.power / std::max(glm::dot(nearest, nearest), least_distance * least_distance);
}

// Unoccluded: close for single triangles, an upper bound for groups.
float EmitterTree::expected_irradiance(const Node& node, const Vec3& x, const Vec3& n) const {
  if (node.right == 0) {
    const Shape& shape = shapes_[node.first];
    const Vec3 between = x - shape.middle;
    if (glm::dot(shape.normal, between) <= 0.f) return 0.f;
    const EmittingSide& e = emitters_[node.first];
    const bool above = glm::dot(n, between) < -0.5f * shape.size;
    if (above && glm::dot(between, between) > kFar * kFar * shape.size * shape.size)
      return e.power * point_kernel(x, n, shape.middle, shape.normal);
    return kPi * average(e.radiance) * polygon_form_factor(x, n, e.corners);
  }
  if (cannot_light(node, x, n)) return 0.f;
  return sent_to(node, x, kLeastDistance * node.box.diagonal());
}

// Opens the strongest group until all that are left are weak or seen under a small angle.
std::vector<EmitterTree::CutNode> EmitterTree::choose_cut(const Vec3& x, const Vec3& n,
                                                          const DirectLightOptions& options) const {
  std::vector<CutNode> cut, groups;  // groups: a heap of what may be opened
  const auto weaker = [](const CutNode& a, const CutNode& b) { return a.expected < b.expected; };
  float total = 0.f;
  const auto add = [&](std::uint32_t index) {
    const Node& node = nodes_[index];
    const float expected = expected_irradiance(node, x, n);
    if (!(expected > 0.f)) return;
    total += expected;
    const float distance = glm::length(node.box.center() - x);
    if (node.right == 0 || node.box.diagonal() < options.smallest_angle * distance) {
      cut.push_back({index, expected});
    } else {
      groups.push_back({index, expected});
      std::push_heap(groups.begin(), groups.end(), weaker);
    }
  };
  add(0);
  while (!groups.empty() && groups.front().expected > options.largest_group_share * total) {
    const CutNode opened = groups.front();
    std::pop_heap(groups.begin(), groups.end(), weaker);
    groups.pop_back();
    total -= opened.expected;
    add(opened.node + 1);
    add(nodes_[opened.node].right);
  }
  cut.insert(cut.end(), groups.begin(), groups.end());
  return cut;
}

// The closed form carries the kernel; rays carry its visible share, weighted by the kernel.
Rgb EmitterTree::from_triangle(std::uint32_t emitter, const Vec3& x, const Vec3& n, int rays,
                               int more_rays, Vec2 shift, float feature_size) const {
  const EmittingSide& e = emitters_[emitter];
  const Vec3& normal = shapes_[emitter].normal;
  const auto& corner = e.corners;
  const float height = glm::dot(normal, corner[0] - x);
  if (height >= 0.f) return Rgb(0.f);
  const float form_factor = polygon_form_factor(x, n, corner);
  if (!(form_factor > 0.f)) return Rgb(0.f);
  const Vec3 from = world_->rays.lift(x, n);

  const SphericalTriangle view({corner[0] - x, corner[1] - x, corner[2] - x});
  const bool large = view.solid_angle() > kLargeView;
  const auto cosine = [&](int i) { return std::max(kLeastCosine, glm::dot(n, view.corner(i))); };
  const std::array<float, 4> cosines{cosine(1), cosine(1), cosine(0), cosine(2)};
  const auto at = [&](Vec2 b) {
    return corner[0] + b.x * (corner[1] - corner[0]) + b.y * (corner[2] - corner[0]);
  };
  struct Place {
    Vec2 barycentric;
    float kernel;  // over the density with which it was chosen
  };
  const auto choose = [&](Vec2 u) {
    if (!large) {
      const Vec2 b = uniform_triangle(u);
      return Place{b, point_kernel(x, n, at(b), normal)};
    }
    const WarpedPoint warped = sample_bilinear(u, cosines);
    const Vec3 w = view.direction(warped.u);
    const Vec3 y = x + w * (height / std::min(glm::dot(w, normal), -1e-6f));
    // Rounding must not carry it off the triangle, or behind it.
    Vec2 b = glm::clamp(barycentric_in(corner, y), 0.f, 1.f);
    b /= std::max(1.f, b.x + b.y);
    return Place{b, std::max(0.f, glm::dot(n, w)) / warped.density};
  };

  float kernel_sum = 0.f, seen_sum = 0.f, squares = 0.f;
  Rgb seen_radiance(0.f);
  // Few rays each choose among several places in proportion to the kernel: where most light comes
  // from counts as it should, and none is lost by a place below the horizon.
  const int candidates =
      std::max(1, (large ? kLeastPlacesInView : kLeastPlaces) / std::max(1, rays));
  // Emitters that take few rays each must not all be seen at the same of their places.
  const Vec2 own_shift = other_shift(shift, emitter);
  const auto choose_one = [&](int ray) {
    float choice = r2_sequence(static_cast<std::uint32_t>(ray), other_shift(own_shift, kChoices)).x;
    Place chosen{Vec2(0.f), 0.f};
    for (int k = 0; k < candidates; ++k) {
      const auto index = static_cast<std::uint32_t>(ray * candidates + k);
      const Place place = choose(r2_sequence(index, own_shift));
      if (!(place.kernel > 0.f)) continue;
      chosen.kernel += place.kernel;
      // Keeps the newcomer with probability share, and stretches the choice to be used again.
      const float share = place.kernel / chosen.kernel;
      const bool keep = choice < share;
      choice = keep ? choice / share : (choice - share) / (1.f - share);
      if (keep) chosen.barycentric = place.barycentric;
    }
    return chosen;
  };
  int taken = 0;
  const auto shoot = [&](int until) {
    for (; taken < until; ++taken) {
      const auto [b, kernel] = choose_one(taken);
      if (!(kernel > 0.f)) continue;
      kernel_sum += kernel;
      const float visible = kernel * seen(emitter, from, at(b), feature_size);
      seen_sum += visible;
      squares += visible * visible / kernel;
      if (!(visible > 0.f)) continue;
      const Vec3 y = at(b);
      seen_radiance += visible * (e.varies ? radiance_at_(e, y, glm::distance(x, y)) : e.radiance);
    }
  };
  shoot(rays);
  // Exact rays say all or nothing; clusters answer with shares that may agree.
  const float mean = seen_sum / std::max(kernel_sum, 1e-30f);
  const float variance = squares / std::max(kernel_sum, 1e-30f) - mean * mean;
  const bool mixed = variance > kMixed * kMixed;
  if (mixed && rays >= kRaysToJudgeBy && more_rays > rays) shoot(more_rays);
  return kernel_sum > 0.f ? kPi * form_factor * seen_radiance / kernel_sum : Rgb(0.f);
}

template <class Estimate>
EmitterTree::ChosenEmitter EmitterTree::choose_below(std::uint32_t node, float choice,
                                                     const Estimate& estimate) const {
  float probability = 1.f;
  while (nodes_[node].right != 0) {
    const std::uint32_t left = node + 1, right = nodes_[node].right;
    const float a = estimate(nodes_[left]), b = estimate(nodes_[right]);
    if (!(a + b > 0.f)) return {};
    const float share = a / (a + b);
    const bool first = choice < share;
    choice = first ? choice / share : (choice - share) / (1.f - share);
    probability *= first ? share : 1.f - share;
    node = first ? left : right;
  }
  return {nodes_[node].first, probability};
}

EmitterTree::ChosenEmitter EmitterTree::choose_below(std::uint32_t node, float choice,
                                                     const Vec3& x, const Vec3& n) const {
  // Unlike the bounds of the cut, no more than a middle estimate: what one group is thought to give
  // too much, others would get too rarely.
  return choose_below(node, choice, [&](const Node& group) {
    if (group.right == 0) return expected_irradiance(group, x, n);
    return cannot_light(group, x, n) ? 0.f : sent_to(group, x, kNearGroup * group.box.diagonal());
  });
}

Rgb EmitterTree::from_some(std::span<const CutNode> nodes, const Vec3& x, const Vec3& n, int rays,
                           Vec2 shift, float feature_size) const {
  float expected = 0.f;
  for (const CutNode& c : nodes) expected += c.expected;
  const Vec2 choice_shift = other_shift(shift, kChoices);
  Rgb sum(0.f);
  std::size_t at = 0;
  float before = 0.f;
  for (int k = 0; k < rays; ++k) {
    const auto index = static_cast<std::uint32_t>(k);
    const Vec2 u = r2_sequence(index, choice_shift);
    const float choice = expected * (static_cast<float>(k) + u.x) / static_cast<float>(rays);
    while (at + 1 < nodes.size() && before + nodes[at].expected <= choice)
      before += nodes[at++].expected;
    const ChosenEmitter chosen = choose_below(nodes[at].node, u.y, x, n);
    if (!(chosen.probability > 0.f)) continue;
    sum += from_triangle(chosen.emitter, x, n, 1, 1, r2_sequence(index, shift), feature_size) /
           (nodes[at].expected * chosen.probability);
  }
  return sum * (expected / static_cast<float>(rays));
}

std::optional<EmitterPoint> EmitterTree::choose(const Vec3& x, float radius, const Vec3& u) const {
  if (empty()) return std::nullopt;
  // An upper estimate of what a group sends, whichever way the receiver faces.
  const auto estimate = [&](const Node& node) {
    return sent_to(node, x, std::max(radius, kNearGroup * node.box.diagonal()));
  };
  const ChosenEmitter chosen = choose_below(0, u.z, estimate);
  if (!(chosen.probability > 0.f)) return std::nullopt;  // too weak for single precision
  EmitterPoint point;
  point.emitter = chosen.emitter;
  const EmittingSide& e = emitters_[point.emitter];
  const auto& corner = e.corners;
  const Vec2 b = uniform_triangle({u.x, u.y});
  point.position = corner[0] + b.x * (corner[1] - corner[0]) + b.y * (corner[2] - corner[0]);
  point.normal = shapes_[point.emitter].normal;
  point.power = e.radiance * (shapes_[point.emitter].area / chosen.probability);
  return point;
}

Rgb EmitterTree::irradiance(const Vec3& x, const Vec3& n, const DirectLightOptions& options,
                            Vec2 shift) const {
  if (empty()) return Rgb(0.f);
  std::vector<CutNode> cut = choose_cut(x, n, options);
  float expected = 0.f;
  for (const CutNode& c : cut) expected += c.expected;
  const auto alone = [&](const CutNode& c) {
    return nodes_[c.node].right == 0 && c.expected > options.largest_group_share * expected;
  };
  const auto first_of_rest = std::stable_partition(cut.begin(), cut.end(), alone);
  // Rays go where the light comes from. Light beyond all numbers has no share.
  const auto share_of_rays = [&](float light, float most) {
    const float here = std::min(most, std::max(0.f, light / (kShareOfAllRays * expected)));
    if (!(options.plain_light > 0.f)) return here;
    return std::max(here, std::min(kMostTimesRays, light / options.plain_light));
  };
  const auto rays = [](float share, int all) {
    return std::max(1, static_cast<int>(std::ceil(share * static_cast<float>(all))));
  };
  Rgb sum(0.f);
  float rest = expected;
  for (auto c = cut.begin(); c != first_of_rest; ++c) {
    rest -= c->expected;
    const float share = share_of_rays(c->expected, 1.f);
    sum += from_triangle(nodes_[c->node].first, x, n,
                         rays(std::min(share, std::sqrt(share)), options.shadow_rays),
                         rays(share, options.penumbra_rays), shift, options.feature_size);
  }
  if (first_of_rest != cut.end()) {
    // In penumbrae half of them: what is mixed here is which emitters are seen.
    const int all =
        std::max(std::min(kRaysToJudgeBy, options.penumbra_rays), options.penumbra_rays / 2);
    sum += from_some({first_of_rest, cut.end()}, x, n,
                     rays(share_of_rays(rest, 1.f / kShareOfAllRays), all), shift,
                     options.feature_size);
  }
  return sum;
}

float EmitterTree::unoccluded_irradiance(const Vec3& x, const Vec3& n) const {
  if (empty()) return 0.f;
  float sum = 0.f;
  for (const CutNode& c : choose_cut(x, n, kRoughly)) sum += c.expected;
  return sum;
}

}  // namespace halflight
