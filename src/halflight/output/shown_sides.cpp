#include "halflight/output/shown_sides.h"

#include "halflight/output/disjoint_sets.h"
#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr std::size_t kMostSamples = 16;
// Share of the mean irradiance below which a side counts as unlit: less than a display can show,
// more than the rounding of a reader.
constexpr float kUnlit = 1e-4f;

// Triangles of each connected piece, one piece after the other.
struct Pieces {
  std::vector<TriangleId> triangles;
  std::vector<std::uint32_t> first;  // of each piece, and the end
  std::size_t size() const { return first.size() - 1; }
};

Pieces connected_pieces(const Geometry& g, const SharedEdges& edges) {
  DisjointSets sets(g.triangles.size());
  edges.for_each([&](std::span<const TriangleSide> sides) {
    if (sides.size() != 2 || sides[0].upwards == sides[1].upwards) return;
    const TriangleId a = sides[0].triangle, b = sides[1].triangle;
    if (g.instances[a] == g.instances[b]) sets.join(a.value, b.value);
  });
  Pieces pieces;
  std::vector<std::uint32_t> piece(g.triangles.size()), count;
  for (std::uint32_t t = 0; t < piece.size(); ++t) {
    const std::uint32_t root = sets.root(t);  // never after t
    if (root == t) count.push_back(0);
    piece[t] = root == t ? static_cast<std::uint32_t>(count.size() - 1) : piece[root];
    ++count[piece[t]];
  }
  pieces.first.assign(1, 0);
  for (const std::uint32_t n : count) pieces.first.push_back(pieces.first.back() + n);
  std::vector<std::uint32_t> next(pieces.first.begin(), pieces.first.end() - 1);
  pieces.triangles.resize(piece.size());
  for (std::uint32_t t = 0; t < piece.size(); ++t)
    pieces.triangles[next[piece[t]]++] = TriangleId(t);
  return pieces;
}

// Well spread places on a piece, in equal shares of its area; a few on a piece that is smaller than
// the feature size. Each is read from the front and from the back.
void add_samples(const Geometry& g, std::span<const TriangleId> piece, float feature_size,
                 std::vector<ReadingPoint>& out) {
  std::vector<double> area_before(1, 0.0);
  for (const TriangleId t : piece) area_before.push_back(area_before.back() + g.area(t));
  const bool is_small = area_before.back() < static_cast<double>(feature_size * feature_size);
  const std::size_t samples = is_small ? std::min<std::size_t>(2, piece.size()) : kMostSamples;
  for (std::size_t i = 0; i < samples; ++i) {
    const double share =
        area_before.back() * (static_cast<double>(i) + 0.5) / static_cast<double>(samples);
    const auto after = std::upper_bound(area_before.begin() + 1, area_before.end() - 1, share);
    const TriangleId t = piece[static_cast<std::size_t>(after - area_before.begin()) - 1];
    const Vec2 at = uniform_triangle(r2_sequence(static_cast<std::uint32_t>(i)));
    const Vec3 n = glm::normalize(g.scaled_normal(t));
    const Vec3 p = g.point(t, at);
    out.push_back({p, n, t});
    out.push_back({p, -n, t});
  }
}

}  // namespace

IdVector<TriangleId, ShownSides> choose_shown_sides(const Scene& scene, const Geometry& g,
                                                    const SharedEdges& edges, float feature_size,
                                                    const LightReader& read) {
  const Pieces pieces = connected_pieces(g, edges);
  std::vector<ReadingPoint> places;
  std::vector<std::size_t> first_place;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    first_place.push_back(places.size());
    const std::span all(pieces.triangles);
    add_samples(g, all.subspan(pieces.first[i], pieces.first[i + 1] - pieces.first[i]),
                feature_size, places);
  }
  first_place.push_back(places.size());
  const std::vector<Reading> light = read(places);
  double sum = 0.0;
  for (const Reading& r : light) sum += static_cast<double>(max_component(r.irradiance()));
  const float unlit =
      kUnlit *
      static_cast<float>(sum / static_cast<double>(std::max<std::size_t>(1, light.size())));

  IdVector<TriangleId, ShownSides> shown(g.triangles.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    bool lit[2] = {false, false};
    for (std::size_t k = first_place[i]; k < first_place[i + 1]; ++k)
      lit[k % 2] |= max_component(light[k].irradiance()) > unlit;
    for (std::uint32_t k = pieces.first[i]; k < pieces.first[i + 1]; ++k) {
      const TriangleId t = pieces.triangles[k];
      const Material& m = scene.materials[g.materials[t]];
      shown[t].back = lit[1] || (m.emits() && m.double_sided);
      shown[t].front = lit[0] || m.emits() || !shown[t].back;
    }
  }
  return shown;
}

}  // namespace halflight
