#include "halflight/rays/light_tree.h"

#include <algorithm>
#include <numeric>

namespace halflight {
namespace {

// A light of radius r seen from its surface gives at most about 3 I / r^2: near times far is not
// less than 0.15 r times 2 r.
constexpr float kLeastNear = 0.15f;

struct Angle {
  float cosine, sine;
};
Angle from_cosine(float c) { return {c, std::sqrt(std::max(0.f, 1.f - c * c))}; }
// max(0, a - b) for angles in [0, pi].
Angle minus(Angle a, Angle b) {
  if (a.cosine >= b.cosine) return {1.f, 0.f};
  return from_cosine(a.cosine * b.cosine + a.sine * b.sine);
}

// Smallest-ish cone around two cones.
void unite_cones(const LightBounds& a, const LightBounds& b, LightBounds& out) {
  const float angle_a = std::acos(std::clamp(a.cos_cone, -1.f, 1.f));
  const float angle_b = std::acos(std::clamp(b.cos_cone, -1.f, 1.f));
  const float between = std::acos(std::clamp(glm::dot(a.axis, b.axis), -1.f, 1.f));
  out.axis = a.axis;
  out.cos_cone = a.cos_cone;
  if (between + angle_b <= angle_a) return;
  out.axis = b.axis;
  out.cos_cone = b.cos_cone;
  if (between + angle_a <= angle_b) return;
  const float half = 0.5f * (angle_a + between + angle_b);
  const Vec3 towards = b.axis - glm::dot(a.axis, b.axis) * a.axis;
  const float length = glm::length(towards);
  if (half >= kPi || length < 1e-6f) {
    out.cos_cone = -1.f;
    return;
  }
  const float turn = half - angle_a;
  out.axis = glm::normalize(std::cos(turn) * a.axis + std::sin(turn) / length * towards);
  out.cos_cone = std::cos(half);
}

LightBounds unite(const LightBounds& a, const LightBounds& b) {
  LightBounds out;
  out.bounds = a.bounds;
  out.bounds.extend(b.bounds);
  out.two_sided = a.two_sided || b.two_sided;
  out.intensity = a.intensity + b.intensity;
  unite_cones(a, b, out);
  return out;
}

}  // namespace

// theta: angle between the light's axis and the direction to p; theta_o: its cone; theta_u: angle
// that the sphere around the bounds subtends at p; each difference of angles is not below 0.
// intensity * cos(theta - theta_o - theta_u) * cos(theta_i - theta_u) / (d_near * d_far): the mean
// of 1/d^2 along a row of lights from d_near to d_far, where 1/d^2 to the centre would not tell a
// group that begins next to p from one that p is far from.
float irradiance_estimate(const LightBounds& light, const Vec3& p, const Vec3& n) {
  const Vec3 offset = p - light.bounds.center();
  const float distance = glm::length(offset);
  const float radius = 0.5f * light.bounds.diagonal();
  const Vec3 outside =
      glm::max(glm::max(light.bounds.lower - p, p - light.bounds.upper), Vec3(0.f));
  const float near = std::max(glm::length(outside), kLeastNear * radius);
  const float near_times_far = near * (distance + radius);
  if (!(near_times_far > 0.f)) return 0.f;
  if (distance <= radius) return light.intensity / near_times_far;

  const Vec3 away = offset / distance;
  const Angle subtended = from_cosine(std::sqrt(1.f - radius * radius / (distance * distance)));
  const Angle received = minus(from_cosine(-glm::dot(away, n)), subtended);
  if (received.cosine <= 0.f) return 0.f;

  float along = glm::dot(light.axis, away);
  if (light.two_sided) along = std::abs(along);
  const Angle emitted = minus(minus(from_cosine(along), from_cosine(light.cos_cone)), subtended);
  if (emitted.cosine <= 0.f) return 0.f;
  return light.intensity * emitted.cosine * received.cosine / near_times_far;
}

LightTree::LightTree(std::span<const LightBounds> lights) : trails_(lights.size(), 0) {
  if (lights.empty()) return;
  std::vector<std::uint32_t> order(lights.size());
  std::iota(order.begin(), order.end(), 0u);
  nodes_.reserve(2 * lights.size());

  // Depth first, so that a first child directly follows its parent.
  struct Range {
    std::uint32_t first, last, depth, trail, parent;
  };
  constexpr std::uint32_t kNone = ~0u;
  std::vector<Range> todo{{0, static_cast<std::uint32_t>(order.size()), 0, 0, kNone}};
  while (!todo.empty()) {
    const Range range = todo.back();
    todo.pop_back();
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    if (range.parent != kNone) nodes_[range.parent].right = index;
    nodes_.emplace_back();
    if (range.last - range.first == 1) {
      nodes_[index].light = lights[order[range.first]];
      nodes_[index].emitter = EmitterId(order[range.first]);
      trails_[order[range.first]] = range.trail;
      continue;
    }
    Bounds3f centers;
    for (std::uint32_t i = range.first; i < range.last; ++i)
      centers.extend(lights[order[i]].bounds.center());
    const int axis = centers.longest_axis();
    const std::uint32_t middle = (range.first + range.last) / 2;
    std::nth_element(order.begin() + range.first, order.begin() + middle,
                     order.begin() + range.last, [&](std::uint32_t a, std::uint32_t b) {
                       const float ca = lights[a].bounds.center()[axis];
                       const float cb = lights[b].bounds.center()[axis];
                       return ca != cb ? ca < cb : a < b;
                     });
    todo.push_back({middle, range.last, range.depth + 1, range.trail | (1u << range.depth), index});
    todo.push_back({range.first, middle, range.depth + 1, range.trail, kNone});
  }
  for (std::size_t i = nodes_.size(); i-- > 0;)
    if (nodes_[i].right != 0)
      nodes_[i].light = unite(nodes_[i + 1].light, nodes_[nodes_[i].right].light);
}

std::optional<LightTree::Choice> LightTree::choose(const Vec3& p, const Vec3& n, float u) const {
  if (nodes_.empty() || irradiance_estimate(nodes_[0].light, p, n) <= 0.f) return std::nullopt;
  float probability = 1.f;
  std::uint32_t at = 0;
  while (nodes_[at].right != 0) {
    const float left = irradiance_estimate(nodes_[at + 1].light, p, n);
    const float right = irradiance_estimate(nodes_[nodes_[at].right].light, p, n);
    if (!(left + right > 0.f)) return std::nullopt;
    const float share = left / (left + right);
    const bool take_left = u < share;
    u = take_left ? u / share : (u - share) / (1.f - share);
    u = std::min(u, 0x1.fffffep-1f);
    probability *= take_left ? share : 1.f - share;
    at = take_left ? at + 1 : nodes_[at].right;
  }
  return Choice{nodes_[at].emitter, probability};
}

float LightTree::probability(EmitterId emitter, const Vec3& p, const Vec3& n) const {
  if (irradiance_estimate(nodes_[0].light, p, n) <= 0.f) return 0.f;
  float probability = 1.f;
  std::uint32_t at = 0;
  for (std::uint32_t trail = trails_[emitter.value]; nodes_[at].right != 0; trail >>= 1) {
    const float left = irradiance_estimate(nodes_[at + 1].light, p, n);
    const float right = irradiance_estimate(nodes_[nodes_[at].right].light, p, n);
    if (!(left + right > 0.f)) return 0.f;
    const bool take_right = (trail & 1u) != 0;
    const float share = left / (left + right);
    probability *= take_right ? 1.f - share : share;
    at = take_right ? nodes_[at].right : at + 1;
  }
  return probability;
}

}  // namespace halflight
