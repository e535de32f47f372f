// The edges of a mesh in refinement, and the light at their middles.
#pragma once

#include <array>
#include <vector>

#include <tsl/robin_map.h>

#include "halflight/output/work_mesh.h"

namespace halflight {

using EdgeId = Id<struct EdgeTag>;
using SiteEdgeId = Id<struct SiteEdgeTag>;

inline constexpr std::uint32_t kNoUse = ~0u;

// A pair of points. It is split for all its triangles or for none, so no crack can open.
struct Edge {
  std::array<PointId, 2> ends;
  PointId middle;  // valid once split
  float length = 0.f;
  float longest_wanted = 0.f;        // split unconditionally when longer, if there is any light
  float error = 0.f;                 // of linear interpolation, relative
  std::uint32_t first_use = kNoUse;  // list of the sheet sides that run along it
  std::uint8_t triangles = 0;        // input surfaces that share it (counts to 3)
  bool lit = false;
  bool split = false;
};

// A pair of sites: the edge as one smooth surface sees it. Where the surface ends at the edge, the
// triangles on both sides of it have middles of their own.
struct SiteEdge {
  EdgeId edge;
  std::array<std::uint8_t, 2> users{0, 0};  // sheets that run along it upwards, downwards
  std::array<SiteId, 2> middle;             // for those sheets; equal where the surface continues
};

// A sheet in refinement.
struct FineSheet {
  SheetId sheet;
  float longest_wanted = 0.f;
  bool smooth_indirect = false;  // a sheet it came from showed indirect light to be linear
  bool primary = true;           // false: the back of a triangle whose front is shown as well
  std::array<EdgeId, 3> edges;   // side k from corner k to k + 1; invalid when too short to split
  std::array<SiteEdgeId, 3> site_edges;
  std::array<std::uint32_t, 3> next_use{kNoUse, kNoUse, kNoUse};  // side k of sheet i is 3 i + k
  bool affected = false;                                          // has a side that is being split
};

class EdgeTable {
 public:
  EdgeTable(WorkMesh& mesh, float finest) : mesh_(mesh), finest_(finest) {}

  IdVector<EdgeId, Edge> edges;
  IdVector<SiteEdgeId, SiteEdge> site_edges;

  // Enters the sides of new sheets that are longer than `finest`. New edges go to the end of
  // `edges`.
  void enter(std::span<FineSheet> sheets);
  // Adds a site in the middle of every side of the new sheets that has none, with its light, and
  // rates the edges. Returns the number of readings.
  std::size_t read_middles(std::span<const FineSheet> sheets, float feature_size,
                           float mean_irradiance, const LightReader& read);
  // Indirect light is linear along all sides that could be split.
  bool is_indirect_smooth(const FineSheet& s, float mean_irradiance) const;
  // The site in the middle of side k; its point is that of the split edge.
  SiteId middle(const FineSheet& s, std::size_t k) const;
  // Longer edges first; equal lengths by id.
  bool longer(EdgeId a, EdgeId b) const;

 private:
  std::size_t direction(const FineSheet& s, std::size_t k) const;
  void rate(const FineSheet& s, std::size_t k, float mean_irradiance);

  WorkMesh& mesh_;
  float finest_;
  tsl::robin_map<std::uint64_t, EdgeId> edge_of_;
  tsl::robin_map<std::uint64_t, SiteEdgeId> site_edge_of_;
};

}  // namespace halflight
