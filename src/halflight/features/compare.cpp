#include "halflight/features/compare.h"

#include <algorithm>
#include <cmath>

#include "halflight/features/feature_mask.h"

namespace halflight {
namespace {

double norm_over(const std::vector<float>& local, int picture_width, const Rectangle& part,
                 double p) {
  std::vector<float> cut;
  for (int y = part.top; y < part.top + part.height; ++y) {
    const auto row = local.begin() + static_cast<std::ptrdiff_t>(y) * picture_width + part.left;
    cut.insert(cut.end(), row, row + part.width);
  }
  return norm(cut, p);
}

// Every region of the mask with its norm, those with the largest integral of |error|^p first.
std::vector<RegionError> worst_regions(const std::vector<float>& local, const BinaryImage& mask,
                                       double p, std::size_t count) {
  const Regions found = connected_regions(mask);
  std::vector<double> power(found.regions.size(), 0);
  for (std::size_t i = 0; i < local.size(); ++i)
    if (found.label[i] != 0) power[found.label[i] - 1] += std::pow(double{local[i]}, p);

  std::vector<std::size_t> order(power.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return power[a] > power[b]; });
  order.resize(std::min(count, order.size()));

  std::vector<RegionError> worst;
  for (const std::size_t i : order) {
    const Region& region = found.regions[i];
    worst.push_back({region, std::pow(power[i] / static_cast<double>(region.pixels), 1 / p)});
  }
  return worst;
}

ErrorAtSize error_at(double s, const Image& delta, const std::vector<float>& exact,
                     const BinaryImage& shadow, const CompareOptions& options) {
  const double p = options.p;
  const std::vector<float> averaged = averaged_error(delta, s, p);
  ErrorAtSize result;
  result.feature_size = s;
  result.mask = feature_mask(shadow, s, options.connectivity);
  result.shadows = feature_error(exact, averaged, result.mask, p);
  result.symmetric =
      feature_error(exact, averaged, symmetric_feature_mask(shadow, s, options.connectivity), p);
  if (!options.keep_maps && options.parts.empty() && options.worst_regions == 0) {
    result.mask = {};
    return result;
  }
  result.local = select_error(exact, averaged, result.mask);
  for (const Rectangle& part : options.parts)
    result.parts.push_back(norm_over(result.local, delta.width, part, p));
  if (options.worst_regions > 0)
    result.regions = worst_regions(result.local, result.mask, p, options.worst_regions);
  if (!options.keep_maps) result.mask = {}, result.local = {};
  return result;
}

}  // namespace

Comparison compare(const Image& reference, const Image& test, const BinaryImage& shadow,
                   const CompareOptions& options) {
  const Image delta = difference(reference, test);
  const std::vector<float> exact = local_error(delta, options.p);
  const std::vector<float> exact1 = local_error(delta, 1);
  const std::vector<float> exact2 = options.p == 2 ? exact : local_error(delta, 2);
  Comparison result{norm(exact1, 1), norm(exact2, 2), norm(exact, options.p), {}, {}};
  for (const Rectangle& part : options.parts)
    result.parts.push_back(
        {norm_over(exact1, delta.width, part, 1), norm_over(exact2, delta.width, part, 2)});
  for (const double s : options.feature_sizes)
    result.at_sizes.push_back(error_at(s, delta, exact, shadow, options));
  return result;
}

}  // namespace halflight
