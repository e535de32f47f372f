#include "halflight/output/weld.h"

#include <tuple>

#include <tsl/robin_map.h>

#include "halflight/base/parallel.h"
#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

constexpr float kUnitsInTheLastPlace = 4.f * 0x1p-23f;

// Points found so far, by cells four tolerances wide. Cells whose hashes collide share a list.
class PointGrid {
 public:
  PointGrid(float tolerance, IdVector<PointId, Vec3>& points)
      : tolerance_(tolerance), points_(points) {}

  PointId find_or_add(const Vec3& p) {
    const glm::dvec3 at = glm::dvec3(p) / (4.0 * static_cast<double>(tolerance_));
    const glm::dvec3 low = glm::floor(at - 0.25), high = glm::floor(at + 0.25);
    for (double x = low.x; x <= high.x; ++x)
      for (double y = low.y; y <= high.y; ++y)
        for (double z = low.z; z <= high.z; ++z)
          if (const PointId found = find(key({x, y, z}), p); found.valid()) return found;
    const PointId added = points_.push_back(p);
    const auto [cell, is_new] = newest_.try_emplace(key(glm::floor(at)), added);
    older_.push_back(is_new ? PointId() : cell->second);
    cell.value() = added;
    return added;
  }

 private:
  static std::uint64_t key(const glm::dvec3& cell) {
    return hash(static_cast<std::uint64_t>(static_cast<std::int64_t>(cell.x)),
                static_cast<std::int64_t>(cell.y), static_cast<std::int64_t>(cell.z));
  }
  PointId find(std::uint64_t cell, const Vec3& p) const {
    const auto entry = newest_.find(cell);
    if (entry == newest_.end()) return {};
    for (PointId i = entry->second; i.valid(); i = older_[i])
      if (glm::all(glm::lessThanEqual(glm::abs(points_[i] - p), Vec3(tolerance_)))) return i;
    return {};
  }

  float tolerance_;
  IdVector<PointId, Vec3>& points_;
  tsl::robin_map<std::uint64_t, PointId> newest_;
  IdVector<PointId, PointId> older_;
};

}  // namespace

WeldedPoints weld(const Geometry& g) {
  WeldedPoints welded;
  welded.of_vertex.resize(g.positions.size());
  if (g.triangles.empty()) return welded;
  PointGrid grid(std::max(g.bounds.farthest() * kUnitsInTheLastPlace, 1e-30f), welded.positions);
  for (const auto& triangle : g.triangles)
    for (const VertexId v : triangle)
      if (!welded.of_vertex[v].valid()) welded.of_vertex[v] = grid.find_or_add(g.positions[v]);
  return welded;
}

SharedEdges::SharedEdges(const Geometry& g, const WeldedPoints& points)
    : first_(points.positions.size() + 1, 0) {
  const auto for_each_side = [&](const auto& visit) {
    for (std::size_t t = 0; t < g.triangles.size(); ++t) {
      const auto corner = points.corners(g, TriangleId(t));
      for (std::uint8_t k = 0; k < 3; ++k) {
        const PointId a = corner[k], b = corner[(k + 1) % 3];
        if (a != b) visit(std::min(a, b), TriangleSide{std::max(a, b), TriangleId(t), k, a < b});
      }
    }
  };
  for_each_side([&](PointId low, const TriangleSide&) { ++first_[low.value + 1]; });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  sides_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for_each_side([&](PointId low, const TriangleSide& side) { sides_[next[low.value]++] = side; });
  parallel_for(points.positions.size(), 1024, [&](std::size_t i) {
    std::sort(sides_.begin() + first_[i], sides_.begin() + first_[i + 1],
              [](const TriangleSide& x, const TriangleSide& y) {
                return std::tie(x.far_end, x.triangle, x.side) <
                       std::tie(y.far_end, y.triangle, y.side);
              });
  });
}

}  // namespace halflight
