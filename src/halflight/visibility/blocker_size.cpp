#include "halflight/visibility/blocker_size.h"

#include <vector>

#include "halflight/features/widths.h"
#include "halflight/rays/sampling.h"
#include "halflight/visibility/extinction.h"

namespace halflight {
namespace {

constexpr int kPixels = 64;
constexpr float kLeastWidth = 3.f;      // pixels
constexpr std::uint32_t kChords = 128;  // that extinction is fitted to; some miss the box
constexpr float kOpaqueShare = 0.5f;

// Places a direction's picture over the projection of a box.
struct Easel {
  Frame frame;
  Vec2 lower{0.f};
  float pixel = 0.f;
  int width = 1, height = 1;

  Easel(const Bounds3f& box, const Vec3& direction)
      : frame(Frame::from_normal(glm::normalize(direction))) {
    Vec2 upper(-kInfinity);
    lower = Vec2(kInfinity);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec2 p = flat(corner_of(box, corner));
      lower = glm::min(lower, p);
      upper = glm::max(upper, p);
    }
    const Vec2 extent = upper - lower;
    pixel = std::max(std::max(extent.x, extent.y), 1e-20f) / kPixels;
    width = std::clamp(static_cast<int>(std::ceil(extent.x / pixel)), 1, kPixels);
    height = std::clamp(static_cast<int>(std::ceil(extent.y / pixel)), 1, kPixels);
  }

  static Vec3 corner_of(const Bounds3f& box, int i) {
    return {i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y,
            i & 4 ? box.upper.z : box.lower.z};
  }
  Vec2 flat(const Vec3& p) const {
    return {glm::dot(p, frame.tangent), glm::dot(p, frame.bitangent)};
  }
  Vec2 to_pixels(const Vec3& p) const { return (flat(p) - lower) / pixel; }
  // A point of the line through the centre of a pixel.
  Vec3 from_pixel(int x, int y) const {
    const Vec2 p = lower + pixel * Vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    return p.x * frame.tangent + p.y * frame.bitangent;
  }
};

float doubled_area(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }

// Calls draw(x, y, weights of the 2nd and 3rd corner) for the pixels whose centres are inside.
template <class Draw>
void for_covered_pixels(const Easel& easel, const std::array<Vec3, 3>& corners, const Draw& draw) {
  const Vec2 a = easel.to_pixels(corners[0]), b = easel.to_pixels(corners[1]),
             c = easel.to_pixels(corners[2]);
  const float whole = doubled_area(b - a, c - a);
  if (whole == 0.f) return;
  const Vec2 lower = glm::min(a, glm::min(b, c)), upper = glm::max(a, glm::max(b, c));
  const int x0 = std::max(0, static_cast<int>(std::ceil(lower.x - 0.5f)));
  const int y0 = std::max(0, static_cast<int>(std::ceil(lower.y - 0.5f)));
  const int x1 = std::min(easel.width - 1, static_cast<int>(std::floor(upper.x - 0.5f)));
  const int y1 = std::min(easel.height - 1, static_cast<int>(std::floor(upper.y - 0.5f)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const Vec2 p(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const float v = doubled_area(p - a, c - a) / whole, w = doubled_area(b - a, p - a) / whole;
      if (v >= 0.f && w >= 0.f && v + w <= 1.f) draw(x, y, Vec2(v, w));
    }
}

BinaryImage picture_box(const Easel& easel, const Bounds3f& box) {
  // Corners of the six sides, by the bits of their coordinates.
  static constexpr int kSides[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
  BinaryImage image(easel.width, easel.height);
  for (const auto& side : kSides)
    for (int half = 0; half < 2; ++half)
      for_covered_pixels(easel,
                         {Easel::corner_of(box, side[0]), Easel::corner_of(box, side[1 + half]),
                          Easel::corner_of(box, side[2 + half])},
                         [&](int x, int y, Vec2) { image.set(x, y); });
  return image;
}

BinaryImage intersect(const BinaryImage& a, const BinaryImage& b) {
  return complement(unite(complement(a), complement(b)));
}

float chord_length(const Bounds3f& box, const Vec3& p, const Vec3& direction) {
  float near = -kInfinity, far = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) < 1e-6f) continue;  // such a line stays between the two sides
    const float a = (box.lower[axis] - p[axis]) / direction[axis];
    const float b = (box.upper[axis] - p[axis]) / direction[axis];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return std::max(far - near, 0.f);
}

float fit_to_picture(const Easel& easel, const Bounds3f& box, const BinaryImage& inside,
                     float coverage) {
  std::vector<float> chords;
  chords.reserve(kChords);
  for (std::uint32_t i = 0; i < kChords; ++i) {
    const Vec2 p =
        r2_sequence(i) * Vec2(static_cast<float>(easel.width), static_cast<float>(easel.height));
    const int x = static_cast<int>(p.x), y = static_cast<int>(p.y);
    if (inside.at(x, y))
      chords.push_back(chord_length(box, easel.from_pixel(x, y), easel.frame.normal));
  }
  return fit_extinction(chords, 1.f - coverage);
}

}  // namespace

const std::array<Vec3, kPictureDirections>& picture_directions() {
  static const std::array<Vec3, kPictureDirections> directions = [] {
    std::array<Vec3, kPictureDirections> d{
        Vec3(1, 0, 0),  Vec3(0, 1, 0),  Vec3(0, 0, 1), Vec3(1, 1, 0),  Vec3(1, -1, 0),
        Vec3(1, 0, 1),  Vec3(1, 0, -1), Vec3(0, 1, 1), Vec3(0, 1, -1), Vec3(1, 1, 1),
        Vec3(1, 1, -1), Vec3(1, -1, 1), Vec3(-1, 1, 1)};
    for (Vec3& v : d) v = glm::normalize(v);
    return d;
  }();
  return directions;
}

int nearest_picture_direction(const Vec3& d) {
  const auto& all = picture_directions();
  int nearest = 0;
  for (int i = 1; i < kPictureDirections; ++i)
    if (std::abs(glm::dot(all[i], d)) > std::abs(glm::dot(all[nearest], d))) nearest = i;
  return nearest;
}

float ClusterPicture::blocker_size() const {
  return std::max({blocked, free, kLeastWidth * pixel});
}

ClusterPicture picture_cluster(const Scene& scene, const Geometry& g,
                               std::span<const TriangleId> contents, const Bounds3f& box,
                               const Vec3& direction) {
  const Easel easel(box, direction);
  BinaryImage blocked(easel.width, easel.height);
  for (const TriangleId t : contents) {
    const bool opaque = !may_be_transparent(scene.materials[g.materials[t]]);
    for_covered_pixels(easel, g.corners(t), [&](int x, int y, Vec2 barycentric) {
      if (opaque || opacity_at(scene, g, t, barycentric) >= kOpaqueShare) blocked.set(x, y);
    });
  }
  const BinaryImage inside = picture_box(easel, box);
  ClusterPicture picture;
  picture.pixel = easel.pixel;
  picture.blocked = static_cast<float>(blocked_width(blocked)) * easel.pixel;
  // Beyond the box nothing is free, or every gap at its border would be without end.
  picture.free =
      static_cast<float>(blocked_width(intersect(inside, complement(blocked)))) * easel.pixel;
  const std::size_t pixels = inside.count();
  if (pixels > 0)
    picture.coverage =
        std::min(1.f, static_cast<float>(blocked.count()) / static_cast<float>(pixels));
  picture.extinction = fit_to_picture(easel, box, inside, picture.coverage);
  return picture;
}

float BlockerSizes::isotropic() const {
  float sum = 0.f;
  for (const ClusterPicture& picture : pictures) sum += picture.blocker_size();
  return sum / static_cast<float>(pictures.size());
}

BlockerSizes measure_blocker_sizes(const Scene& scene, const Geometry& g,
                                   std::span<const TriangleId> contents, const Bounds3f& box) {
  BlockerSizes sizes;
  for (int i = 0; i < kPictureDirections; ++i)
    sizes.pictures[i] = picture_cluster(scene, g, contents, box, picture_directions()[i]);
  return sizes;
}

}  // namespace halflight
