#include "halflight/transport/transfer.h"

#include <algorithm>

#include "halflight/rays/sampling.h"
#include "halflight/transport/form_factor.h"

namespace halflight {
namespace {

// A cell nearer than this many of its diameters is integrated in closed form.
constexpr float kNearDiameters = 3.f;
// Tries to find a sampled point above the other's horizon.
constexpr std::uint32_t kAttempts = 4;

float distance_between(const Bounds3f& a, const Bounds3f& b) {
  const Vec3 gap = glm::max(glm::max(a.lower - b.upper, b.lower - a.upper), Vec3(0.f));
  return glm::length(gap);
}

// Largest signed distance of a box's corners from the plane of a cell.
float height_above(const ElementTree& tree, ElementId cell, const Bounds3f& box) {
  const Vec3 n = tree.normal(cell);
  const Vec3 farthest(n.x > 0.f ? box.upper.x : box.lower.x, n.y > 0.f ? box.upper.y : box.lower.y,
                      n.z > 0.f ? box.upper.z : box.lower.z);
  return glm::dot(farthest - tree.surfaces()[tree[cell].side].origin, n);
}

struct CellSample {
  ElementId cell;
  Vec3 position{0.f};
  Vec3 normal{0.f};
};

// A point of an element, chosen down the tree in proportion to share(child); `choice` in [0, 1).
template <class Share>
CellSample sample_element(const ElementTree& tree, ElementId from, float choice, Vec2 u,
                          const Share& share) {
  ElementId at = from;
  while (tree[at].is_cluster()) {
    float total = 0.f;
    for (const ElementId child : tree[at].children()) total += share(child);
    float wanted = choice * total;
    ElementId chosen = tree[at].children()[0];
    for (const ElementId child : tree[at].children()) {
      const float s = share(child);
      if (s <= 0.f) continue;
      chosen = child;
      if (wanted < s) break;
      wanted -= s;
    }
    choice = std::clamp(wanted / std::max(share(chosen), 1e-30f), 0.f, 0.999999f);
    at = chosen;
  }
  // Within a side, power may vary from cell to cell: follow it down.
  while (!tree[at].is_leaf()) {
    const auto children = tree[at].children();
    if (children.size() == 1) {
      at = children[0];
      continue;
    }
    const float first = share(children[0]), both = first + share(children[1]);
    const float split = both > 0.f ? first / both : 0.5f;
    if (u.x < split) {
      u.x = split > 0.f ? std::min(u.x / split, 0.999999f) : 0.f;
      at = children[0];
    } else {
      u.x = std::min((u.x - split) / std::max(1.f - split, 1e-30f), 0.999999f);
      at = children[1];
    }
  }
  return {at, tree.sample(at, u).position, tree.normal(at)};
}

float cell_form_factor(const ElementTree& tree, const Vec3& x, const Vec3& n, ElementId cell) {
  float sum = 0.f;
  tree.for_each_piece(
      cell, [&](std::span<const Vec3> piece) { sum += polygon_form_factor(x, n, piece); });
  return std::min(sum, 1.f);
}

}  // namespace

TransferBounds bound_transfer(const ElementTree& tree, const ClusterVisibility* inside,
                              ElementId receiver, ElementId source) {
  const Element &r = tree[receiver], &s = tree[source];
  TransferBounds bounds;
  const float near = distance_between(r.box, s.box);
  const float far = glm::length(r.center() - s.center());
  bounds.touching = !(near > 0.f);
  if (bounds.touching) {
    bounds.largest_weight = 1.f;
    return bounds;
  }
  float facing = 1.f;
  if (!s.is_cluster()) facing *= std::clamp(height_above(tree, source, r.box) / near, 0.f, 1.f);
  if (!r.is_cluster()) facing *= std::clamp(height_above(tree, receiver, s.box) / near, 0.f, 1.f);
  const float area = inside && inside->knows(source) ? inside->largest_silhouette(source) : s.area;
  bounds.largest_weight = std::min(1.f, facing * area / (kPi * near * near));
  bounds.kernel_variation = std::min(1.f, (r.diameter() + s.diameter()) / far);
  return bounds;
}

namespace {

// Of the whole surface that a cell belongs to: the smaller the parts of a sender the larger their
// own umbras, which then overlap.
float sender_width(const ElementTree& tree, ElementId cell) {
  const Vec2 extent =
      tree.surfaces()[tree[cell].side].uv_upper - tree.surfaces()[tree[cell].side].uv_lower;
  return std::min(extent.x, extent.y);
}

}  // namespace

bool back_facing(const ElementTree& tree, ElementId receiver, ElementId source) {
  const Element &r = tree[receiver], &s = tree[source];
  const float flat = 1e-6f * (r.diameter() + s.diameter());
  return (!r.is_cluster() && height_above(tree, receiver, s.box) <= flat) ||
         (!s.is_cluster() && height_above(tree, source, r.box) <= flat);
}

TransferEstimate estimate_transfer(const TransferScene& scene, ElementId receiver, ElementId source,
                                   int samples, std::uint64_t stream) {
  const ElementTree& tree = scene.tree;
  const Element &r = tree[receiver], &s = tree[source];
  const auto area = [&](ElementId e) { return tree[e].area; };
  const auto power = [&](ElementId e) { return average(scene.radiosity[e]) * tree[e].area; };

  const RayScene& rays = scene.visibility.world().rays;
  // Share of a sampled cell that its own cluster leaves unhidden.
  const bool receiver_known = scene.inside && scene.inside->knows(receiver);
  const bool source_known = scene.inside && scene.inside->knows(source);
  const auto seen = [&](bool known, const CellSample& at, const Vec3& w) {
    return known ? scene.inside->share(tree.side_root(tree[at.cell].side), direction_cell(w)) : 1.f;
  };
  const float source_width = s.box.middle_side();
  const bool to_cell = !r.is_cluster();
  const bool near_cell =
      !s.is_cluster() && distance_between(r.box, s.box) < kNearDiameters * s.diameter();
  const std::uint64_t seed = hash(receiver.value, source.value, stream);
  const Vec2 shift_r = random_shift(seed), shift_s = random_shift(hash(seed, 3));
  const float choice_r = to_unit_float(hash(seed, 5)), choice_s = to_unit_float(hash(seed, 7));

  // Points of a receiving cluster count by their cosine, so that what is handed out to its cells
  // adds up to what arrives.
  float weights = 0.f, squared_weights = 0.f;
  float sum = 0.f, sum_of_squares = 0.f, unoccluded = 0.f;
  Vec3 direction(0.f);
  for (int k = 0; k < samples; ++k) {
    const auto index = static_cast<std::uint32_t>(k);
    const float stratum = static_cast<float>(k) / static_cast<float>(samples);
    const auto choice = [&](float offset) {
      const float c = stratum + offset;
      return c < 1.f ? c : c - 1.f;
    };
    CellSample x =
        sample_element(tree, receiver, choice(choice_r), r2_sequence(index, shift_r), area);
    CellSample y =
        sample_element(tree, source, choice(choice_s), companion_sequence(index, shift_s), power);
    // A receiving cluster is represented by cells that face the source, a near cell by the part
    // above the receiver's horizon, which is what the closed form integrates.
    for (std::uint32_t attempt = 0;
         attempt < kAttempts && glm::dot(x.normal, y.position - x.position) <= 0.f; ++attempt) {
      const std::uint64_t again = hash(seed, k, attempt);
      if (!to_cell)
        x = sample_element(tree, receiver, to_unit_float(again), random_shift(again), area);
      else if (near_cell)
        y = sample_element(tree, source, 0.f, random_shift(again), power);
      else
        break;
    }

    const Vec3 between = y.position - x.position;
    const float squared = glm::dot(between, between);
    if (!(squared > 0.f)) continue;
    const Vec3 w = between / std::sqrt(squared);
    const float cosine_r = glm::dot(x.normal, w), cosine_s = -glm::dot(y.normal, w);
    const float weight = to_cell ? 1.f : std::max(0.f, cosine_r);
    weights += weight;
    squared_weights += weight * weight;
    if (cosine_r <= 0.f || cosine_s <= 0.f) continue;

    float kernel;
    const Element& cell = tree[y.cell];
    if (near_cell && to_cell)
      kernel = cell_form_factor(tree, x.position, x.normal, source);
    else if (squared < kNearDiameters * kNearDiameters * cell.diameter() * cell.diameter())
      kernel =
          cell_form_factor(tree, x.position, to_cell ? x.normal : w, y.cell) * s.area / cell.area;
    else
      kernel = cosine_s * (to_cell ? cosine_r : 1.f) * s.area / (kPi * squared);
    if (!(kernel > 0.f)) continue;
    const float width = std::max(source_width, sender_width(tree, y.cell));
    const float value = kernel * scene.visibility.transmittance({rays.lift(x.position, x.normal),
                                                                 rays.lift(y.position, y.normal),
                                                                 scene.feature_size, width});
    unoccluded += weight * kernel * seen(receiver_known, x, w) * seen(source_known, y, -w);
    sum += weight * value;
    sum_of_squares += weight * value * value;
    direction += weight * value * w;
  }

  TransferEstimate estimate;
  if (!(weights > 0.f)) return estimate;
  estimate.weight = sum / weights;
  estimate.unoccluded = unoccluded / weights;
  const float effective = weights * weights / squared_weights;  // number of samples
  if (effective > 1.001f) {
    const float variance = sum_of_squares / weights - estimate.weight * estimate.weight;
    estimate.deviation = std::sqrt(std::max(0.f, variance * effective / (effective - 1.f)));
  }
  if (source_known) {
    const float sent =
        average(sent_radiosity(tree, scene.inside, scene.radiosity, source, receiver));
    const float per_sent = sent > 0.f ? average(scene.radiosity[source]) / sent : 0.f;
    estimate.weight *= per_sent;
    estimate.unoccluded *= per_sent;
    estimate.deviation *= per_sent;
  }
  if (!to_cell && glm::dot(direction, direction) > 0.f)
    estimate.direction = PackedDirection(glm::normalize(direction));
  return estimate;
}

TransferEstimate estimate_touching_transfer(const TransferScene& scene, ElementId receiver,
                                            ElementId source, int samples, std::uint64_t stream) {
  const ElementTree& tree = scene.tree;
  const auto area = [&](ElementId e) { return tree[e].area; };
  const RayScene& rays = scene.visibility.world().rays;
  const float sent = average(sent_radiosity(tree, scene.inside, scene.radiosity, source, receiver));
  const std::uint64_t seed = hash(receiver.value, source.value, stream);
  const Vec2 shift_x = random_shift(seed), shift_w = random_shift(hash(seed, 3));
  const float choice = to_unit_float(hash(seed, 5));
  float sum = 0.f;
  for (int k = 0; k < samples; ++k) {
    const auto index = static_cast<std::uint32_t>(k);
    const float stratum = (static_cast<float>(k) + choice) / static_cast<float>(samples);
    const CellSample x = sample_element(tree, receiver, stratum, r2_sequence(index, shift_x), area);
    const Vec3 w = Frame::from_normal(x.normal).to_world(
        cosine_hemisphere(companion_sequence(index, shift_w)));
    const auto hit = rays.closest_hit(rays.lift(x.position, x.normal), w, kInfinity, hash(seed, k));
    if (!hit) continue;
    ElementId at = tree.leaf_hit(*hit);
    if (!at.valid() || !(scene.opacity[at] > 0.f)) continue;
    // The ray stopped in proportion to the opacity, by which radiosity is already reduced.
    const float radiosity = average(scene.radiosity[at]) / scene.opacity[at];
    while (at.value > source.value) at = tree[at].parent;  // parents have smaller ids
    if (at == source) sum += radiosity / sent;
  }
  TransferEstimate estimate;
  if (sent > 0.f) estimate.weight = sum / static_cast<float>(samples);
  return estimate;
}

}  // namespace halflight
