#include "halflight/features/error_metric.h"

#include <cassert>
#include <cmath>

#include "halflight/base/parallel.h"
#include "halflight/features/box_filter.h"

namespace halflight {
namespace {

constexpr std::size_t kGrain = 1 << 14;  // pixels per task and per partial sum

double power(double v, double p) { return p == 2 ? v * v : p == 1 ? v : std::pow(v, p); }
double root(double v, double p) { return p == 2 ? std::sqrt(v) : p == 1 ? v : std::pow(v, 1 / p); }

float channel_mean(const Rgb& d, double p) {
  return static_cast<float>(
      root((power(std::abs(d.r), p) + power(std::abs(d.g), p) + power(std::abs(d.b), p)) / 3, p));
}

// Sum of e^p over the pixels where the mask has the given value.
double masked_power(const std::vector<float>& local, const BinaryImage& mask, bool value,
                    double p) {
  const auto width = static_cast<std::size_t>(mask.width());
  return parallel_sum(static_cast<std::size_t>(mask.height()), 4, 0.0, [&](std::size_t y) {
    double sum = 0;
    for (std::size_t x = 0; x < width; ++x)
      if (mask.at(static_cast<int>(x), static_cast<int>(y)) == value)
        sum += power(local[y * width + x], p);
    return sum;
  });
}

}  // namespace

Image difference(const Image& reference, const Image& test) {
  assert(reference.width == test.width && reference.height == test.height);
  Image result(reference.width, reference.height);
  parallel_for(result.pixels.size(), kGrain,
               [&](std::size_t i) { result.pixels[i] = test.pixels[i] - reference.pixels[i]; });
  return result;
}

std::vector<float> local_error(const Image& difference, double p) {
  std::vector<float> local(difference.pixels.size());
  parallel_for(local.size(), kGrain,
               [&](std::size_t i) { local[i] = channel_mean(difference.pixels[i], p); });
  return local;
}

std::vector<float> averaged_error(const Image& difference, double feature_size, double p) {
  return local_error(box_filter(difference, feature_size), p);
}

double norm(const std::vector<float>& local, double p) {
  if (local.empty()) return 0;
  const double sum =
      parallel_sum(local.size(), kGrain, 0.0, [&](std::size_t i) { return power(local[i], p); });
  return root(sum / static_cast<double>(local.size()), p);
}

std::vector<float> select_error(const std::vector<float>& exact, const std::vector<float>& averaged,
                                const BinaryImage& mask) {
  assert(exact.size() == mask.pixel_count() && averaged.size() == mask.pixel_count());
  std::vector<float> local(exact.size());
  const auto width = static_cast<std::size_t>(mask.width());
  parallel_for(static_cast<std::size_t>(mask.height()), 16, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x;
      local[i] = mask.at(static_cast<int>(x), static_cast<int>(y)) ? exact[i] : averaged[i];
    }
  });
  return local;
}

FeatureError feature_error(const std::vector<float>& exact, const std::vector<float>& averaged,
                           const BinaryImage& mask, double p) {
  assert(exact.size() == mask.pixel_count() && averaged.size() == mask.pixel_count());
  FeatureError error;
  const double pixels = static_cast<double>(mask.pixel_count());
  if (pixels == 0) return error;
  const double inside = masked_power(exact, mask, true, p) / pixels;
  const double outside = masked_power(averaged, mask, false, p) / pixels;
  error.value = root(inside + outside, p);
  error.features = root(inside, p);
  error.averages = root(outside, p);
  error.mask_share = static_cast<double>(mask.count()) / pixels;
  return error;
}

}  // namespace halflight
