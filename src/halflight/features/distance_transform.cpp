#include "halflight/features/distance_transform.h"

#include <algorithm>

namespace halflight {
namespace {

// Distances with a frame of one pixel, so that every pixel has all its neighbours.
struct Framed {
  std::size_t stride;
  std::vector<std::uint32_t> distance;
};

Framed start(const BinaryImage& image, Outside outside) {
  const std::size_t stride = static_cast<std::size_t>(image.width()) + 2;
  const std::size_t rows = static_cast<std::size_t>(image.height()) + 2;
  Framed f{stride,
           std::vector<std::uint32_t>(stride * rows, outside == Outside::clear ? 0u : kFarAway)};
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      f.distance[(static_cast<std::size_t>(y) + 1) * stride + static_cast<std::size_t>(x) + 1] =
          image.at(x, y) ? kFarAway : 0u;
  return f;
}

// Relaxes a pixel by its neighbour at `beside` in its row and the up to three at `across` in the
// row already passed. Steps are signed because the second pass runs backwards.
void relax(std::uint32_t* d, std::ptrdiff_t beside, std::ptrdiff_t across, bool diagonals) {
  std::uint32_t nearest = std::min(d[beside], d[across]);
  if (diagonals) nearest = std::min({nearest, d[across - 1], d[across + 1]});
  *d = std::min(*d, nearest + 1);
}

}  // namespace

std::vector<std::uint32_t> distance_to_clear(const BinaryImage& image, Connectivity connectivity,
                                             Outside outside) {
  Framed f = start(image, outside);
  const bool diagonals = connectivity == Connectivity::eight;
  const auto stride = static_cast<std::ptrdiff_t>(f.stride);
  const std::ptrdiff_t width = image.width(), height = image.height();
  for (std::ptrdiff_t y = 1; y <= height; ++y)
    for (std::ptrdiff_t x = 1; x <= width; ++x)
      relax(f.distance.data() + y * stride + x, -1, -stride, diagonals);
  for (std::ptrdiff_t y = height; y >= 1; --y)
    for (std::ptrdiff_t x = width; x >= 1; --x)
      relax(f.distance.data() + y * stride + x, 1, stride, diagonals);

  std::vector<std::uint32_t> result;
  result.reserve(image.pixel_count());
  for (std::ptrdiff_t y = 1; y <= height; ++y) {
    const std::uint32_t* row = f.distance.data() + y * stride + 1;
    for (std::ptrdiff_t x = 0; x < width; ++x) result.push_back(std::min(row[x], kFarAway));
  }
  return result;
}

}  // namespace halflight
