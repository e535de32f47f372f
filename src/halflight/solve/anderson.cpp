#include "halflight/solve/anderson.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "halflight/base/parallel.h"
#include "halflight/solve/sweep.h"

namespace halflight {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr double kLeastIndependence = 1e-8;  // of two differences: 1 - cos^2 of what they enclose

// Sums over leaf cells, weighted by area: of d0 = f - f0, d1 = f - f1 and the change f itself.
struct Products {
  glm::dvec3 d0d0{0.0}, d0d1{0.0}, d1d1{0.0}, d0f{0.0}, d1f{0.0};
  Products& operator+=(const Products& p) {
    d0d0 += p.d0d0, d0d1 += p.d0d1, d1d1 += p.d1d1, d0f += p.d0f, d1f += p.d1f;
    return *this;
  }
};

// The (a, b) for which |f - a d0 - b d1| is least.
std::pair<double, double> least_change(const Products& p, int channel) {
  const double d0d0 = p.d0d0[channel], d0d1 = p.d0d1[channel], d1d1 = p.d1d1[channel];
  const double d0f = p.d0f[channel], d1f = p.d1f[channel];
  const double determinant = d0d0 * d1d1 - d0d1 * d0d1;
  if (determinant > kLeastIndependence * d0d0 * d1d1)
    return {(d0f * d1d1 - d1f * d0d1) / determinant, (d1f * d0d0 - d0f * d0d1) / determinant};
  return {d0d0 > 0.0 ? d0f / d0d0 : 0.0, 0.0};
}

}  // namespace

void AndersonMixing::mix(SolverState& state) {
  const std::size_t n = state.tree.size();
  Past &last = past_[0], &before = past_[1];
  if (known_ == 0)
    for (Past& past : past_) past = {IdVector<ElementId, Rgb>(n), IdVector<ElementId, Rgb>(n)};
  const auto products_at = [&](std::size_t i) {
    const ElementId e(i);
    if (!state.tree[e].is_leaf_cell()) return Products{};
    const glm::dvec3 f = change_of_radiosity(state, e), d0 = f - glm::dvec3(last.change[e]);
    const glm::dvec3 d1 = known_ > 1 ? f - glm::dvec3(before.change[e]) : glm::dvec3(0.0);
    const double area = static_cast<double>(state.tree[e].area);
    return Products{area * d0 * d0, area * d0 * d1, area * d1 * d1, area * d0 * f, area * d1 * f};
  };
  Rgb a(0.f), b(0.f);
  if (known_ > 0) {
    const Products products = parallel_sum(n, kGrain, Products{}, products_at);
    for (int c = 0; c < 3; ++c) std::tie(a[c], b[c]) = least_change(products, c);
  }
  // The present takes the place of the sweep before the last.
  parallel_for(n, kGrain, [&](std::size_t i) {
    const ElementId e(i);
    if (!state.tree[e].is_leaf_cell()) return;
    const Rgb found = state.irradiance[e], change = change_of_radiosity(state, e);
    if (known_ > 0) {
      const Rgb mixed =
          found - a * (found - last.irradiance[e]) - b * (found - before.irradiance[e]);
      // Where that goes below what there is at least, it has gone astray.
      const Rgb least = state.given_light[e];
      for (int c = 0; c < 3; ++c)
        state.irradiance[e][c] = mixed[c] >= least[c] ? mixed[c] : found[c];
    }
    before.irradiance[e] = found;
    before.change[e] = change;
  });
  std::swap(last, before);
  known_ = std::min(known_ + 1, 2);
}

}  // namespace halflight
