// Irradiance at a point by rays that go where the light changes: one through each cell of a grid
// over the hemisphere, then many more through cells that differ from their neighbours (edges of
// windows, small bright things).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "halflight/base/vec.h"
#include "halflight/rays/sampling.h"

namespace halflight {

// With fewer rays cells are too large for neighbours to tell anything.
inline constexpr int kLeastAdaptiveRays = 256;

// Point of the unit disc: the square's cells keep their area and nearly their shape (Shirley and
// Chiu 1997).
inline Vec2 concentric_disc(Vec2 u) {
  const Vec2 p = 2.f * u - Vec2(1.f);
  if (p.x == 0.f && p.y == 0.f) return p;
  const bool wide = std::abs(p.x) > std::abs(p.y);
  const float r = wide ? p.x : p.y;
  const float angle = wide ? kPi / 4.f * (p.y / p.x) : kPi / 2.f - kPi / 4.f * (p.x / p.y);
  return r * Vec2(std::cos(angle), std::sin(angle));
}

// What a ray has seen. Where it is an estimate with noise, the grid goes by the guide instead,
// which must know nothing of that noise: rays that are added where it is large would make it
// smaller on average, and the mean wrong.
struct SeenLight {
  Rgb light{0.f};
  Rgb guide{0.f};
  SeenLight() = default;
  SeenLight(const Rgb& exact) : light(exact), guide(exact) {}  // NOLINT: is one
  SeenLight(const Rgb& noisy, const Rgb& instead) : light(noisy), guide(instead) {}
};

// Mean over directions w about +Z with density cos(theta) / pi of the light `seen(w, rays)`, where
// `rays` is how many such rays would fill the hemisphere. At most twice `rays` are asked, and a
// few.
template <class Seen>
class AdaptiveCosineMean {
 public:
  AdaptiveCosineMean(int rays, Vec2 shift, const Seen& seen)
      : seen_(seen),
        shift_(shift),
        side_(static_cast<std::size_t>(std::sqrt(static_cast<float>(std::max(1, rays))))),
        values_(side_ * side_),
        finer_(values_.size(), 0) {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = mean_of_cell(i, 1);
    const float enough = kContrast * average(mean().guide);
    std::vector<std::size_t> mixed;
    for (std::size_t i = 0; i < values_.size(); ++i)
      if (differs(i, enough)) mixed.push_back(i);
    if (mixed.empty()) return;
    // Half of what may be spent goes to these, and the rest along the edges that they find.
    const std::size_t cells = values_.size();
    const float room = 0.5f * static_cast<float>(cells) / static_cast<float>(mixed.size());
    const auto finer =
        std::clamp(static_cast<std::size_t>(std::sqrt(room)), std::size_t{2}, kMostFiner);
    for (std::size_t spent = 0, i = 0; i < mixed.size() && spent < cells; ++i) {
      const std::size_t cell = mixed[i];
      if (finer_[cell] != 0) continue;
      values_[cell] = mean_of_cell(cell, finer);
      finer_[cell] = 1;
      spent += finer * finer;
      each_neighbour(cell, [&](std::size_t k) {
        if (finer_[k] == 0 && contrast(cell, k) > enough) mixed.push_back(k);
      });
    }
  }

  SeenLight mean() const {
    SeenLight sum;
    for (const SeenLight& value : values_) add(value, sum);
    return divided(sum, values_.size());
  }

 private:
  static constexpr float kContrast = 0.5f;  // of neighbours, in means of the hemisphere
  static constexpr std::size_t kMostFiner = 8;

  static void add(const SeenLight& value, SeenLight& sum) {
    sum.light += value.light;
    sum.guide += value.guide;
  }
  static SeenLight divided(const SeenLight& sum, std::size_t count) {
    return {sum.light / static_cast<float>(count), sum.guide / static_cast<float>(count)};
  }
  // Of `finer` x `finer` rays through a cell.
  SeenLight mean_of_cell(std::size_t cell, std::size_t finer) const {
    const std::size_t across = side_ * finer;
    SeenLight sum;
    for (std::size_t i = 0; i < finer * finer; ++i) {
      const std::size_t column = cell % side_ * finer + i % finer;
      const std::size_t row = cell / side_ * finer + i / finer;
      const Vec2 corner(static_cast<float>(column), static_cast<float>(row));
      const auto index = static_cast<std::uint32_t>(cell * finer * finer + i);
      const Vec2 disc =
          concentric_disc((corner + r2_sequence(index, shift_)) / static_cast<float>(across));
      const float z = std::sqrt(std::max(0.f, 1.f - glm::dot(disc, disc)));
      add(seen_(Vec3(disc, z), static_cast<float>(across * across)), sum);
    }
    return divided(sum, finer * finer);
  }
  float contrast(std::size_t i, std::size_t k) const {
    return average(glm::abs(values_[i].guide - values_[k].guide));
  }
  template <class Visit>
  void each_neighbour(std::size_t i, const Visit& visit) const {
    if (i % side_ > 0) visit(i - 1);
    if (i % side_ + 1 < side_) visit(i + 1);
    if (i >= side_) visit(i - side_);
    if (i + side_ < values_.size()) visit(i + side_);
  }
  bool differs(std::size_t i, float enough) const {
    bool any = false;
    each_neighbour(i, [&](std::size_t k) { any = any || contrast(i, k) > enough; });
    return any;
  }

  const Seen& seen_;
  Vec2 shift_;
  std::size_t side_;
  std::vector<SeenLight> values_;
  std::vector<std::uint8_t> finer_;
};

// The same; few rays are spread evenly.
template <class Seen>
Rgb adaptive_cosine_mean(int rays, Vec2 shift, const Seen& seen) {
  if (rays >= kLeastAdaptiveRays) return AdaptiveCosineMean<Seen>(rays, shift, seen).mean().light;
  const auto count = static_cast<float>(rays);
  Rgb sum(0.f);
  for (int k = 0; k < rays; ++k)
    sum +=
        SeenLight(seen(cosine_hemisphere(r2_sequence(static_cast<std::uint32_t>(k), shift)), count))
            .light;
  return sum / count;
}

}  // namespace halflight
