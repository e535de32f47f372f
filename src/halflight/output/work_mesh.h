// The lit mesh while it is being built. Three things meet at a corner of a triangle:
//   point    a place in space, the same for everything that touches it
//   site     a point on one smooth surface: light is read once per site
//   vertex   a site with the texture coordinates of one side of a primitive instance
#pragma once

#include <array>
#include <vector>

#include "halflight/output/light_reader.h"
#include "halflight/output/shown_sides.h"
#include "halflight/output/weld.h"

namespace halflight {

using SiteId = Id<struct SiteTag>;
using LitVertexId = Id<struct LitVertexTag>;
using SheetId = Id<struct SheetTag>;

struct Site {
  PointId point;
  Vec3 normal{0.f};  // shading normal, towards the side that is shown
  Reading light;
  LitVertexId first_vertex;  // head of the list of its vertices
};

struct LitVertex {
  SiteId site;
  InstanceId instance;
  bool back = false;
  std::array<Vec2, 2> uvs;
  LitVertexId next;  // of the same site
};

// A shown side of a triangle, its corners counter-clockwise seen from that side.
struct Sheet {
  std::array<LitVertexId, 3> corners;
  TriangleId source;
  bool back = false;
};

struct WorkMesh {
  IdVector<PointId, Vec3> points;
  IdVector<SiteId, Site> sites;
  IdVector<LitVertexId, LitVertex> vertices;
  IdVector<SheetId, Sheet> sheets;

  SiteId site(LitVertexId v) const { return vertices[v].site; }
  PointId point(LitVertexId v) const { return sites[vertices[v].site].point; }
  const Vec3& position(LitVertexId v) const { return points[point(v)]; }
  LitVertexId find_or_add_vertex(SiteId site, InstanceId instance, bool back,
                                 const std::array<Vec2, 2>& uvs);
};

// Builds points, sites, vertices and sheets from the input's triangles, and reads the light at
// every site. Corners share a site where their surfaces continue smoothly: across an edge that
// exactly two triangles share, with nearly the same shading normal. Where a third surface meets the
// edge (a thin wall on a floor), the light may differ on both sides, and so do the sites.
WorkMesh make_work_mesh(const Geometry& geometry, WeldedPoints points, const SharedEdges& edges,
                        const IdVector<TriangleId, ShownSides>& shown, float feature_size,
                        const LightReader& read);

}  // namespace halflight
