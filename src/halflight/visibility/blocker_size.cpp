#include "halflight/visibility/blocker_size.h"

#include <vector>

#include "halflight/features/widths.h"
#include "halflight/rays/sampling.h"
#include "halflight/visibility/extinction.h"
#include "halflight/visibility/orthographic.h"

namespace halflight {
namespace {

constexpr int kPixels = 64;
constexpr float kLeastWidth = 3.f;      // pixels
constexpr std::uint32_t kChords = 128;  // that extinction is fitted to; some miss the box
constexpr float kOpaqueShare = 0.5f;

void set_row(BinaryImage& image, int y, int x0, int x1) {
  static_assert(kPixels <= BinaryImage::kWordBits);
  image.row(y)[0] |= (~BinaryImage::Word{0} >> (BinaryImage::kWordBits - 1 - (x1 - x0))) << x0;
}

void draw_triangle(const Scene& scene, const Geometry& g, TriangleId t, const Easel& easel,
                   BinaryImage& image) {
  const auto corners = g.corners(t);
  const Vec2 a = easel.to_pixels(corners[0]), b = easel.to_pixels(corners[1]),
             c = easel.to_pixels(corners[2]);
  const std::array edges{PictureEdge(a, b), PictureEdge(b, c), PictureEdge(c, a)};
  if (!may_be_transparent(scene.materials[g.materials[t]])) {
    for_each_row(easel, edges, [&](int y, int x0, int x1) { set_row(image, y, x0, x1); });
    return;
  }
  const auto doubled_area = [](Vec2 u, Vec2 v) { return u.x * v.y - u.y * v.x; };
  const float whole = doubled_area(b - a, c - a);
  if (whole == 0.f) return;
  for_each_row(easel, edges, [&](int y, int x0, int x1) {
    for (int x = x0; x <= x1; ++x) {
      const Vec2 p = Vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) - a;
      const Vec2 weights(doubled_area(p, c - a) / whole, doubled_area(b - a, p) / whole);
      if (opacity_at(scene, g, t, weights) >= kOpaqueShare) image.set(x, y);
    }
  });
}

BinaryImage picture_box(const Easel& easel, const Bounds3f& box) {
  BinaryImage image(easel.width, easel.height);
  std::vector<PictureEdge> edges;
  for (int from = 0; from < 8; ++from)
    for (const int axis : {1, 2, 4})
      if ((from & axis) == 0)
        edges.emplace_back(easel.to_pixels(corner_of(box, from)),
                           easel.to_pixels(corner_of(box, from | axis)));
  for_each_row(easel, edges, [&](int y, int x0, int x1) { set_row(image, y, x0, x1); });
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
  const Easel easel(box, direction, kPixels);
  BinaryImage blocked(easel.width, easel.height);
  for (const TriangleId t : contents) draw_triangle(scene, g, t, easel, blocked);
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
