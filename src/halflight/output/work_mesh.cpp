#include "halflight/output/work_mesh.h"

#include "halflight/base/parallel.h"
#include "halflight/output/disjoint_sets.h"

namespace halflight {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr float kCosCrease = 0.866f;        // 30 degrees between faces without normals: rounded
constexpr float kCosSameNormal = 0.985f;    // 10 degrees between given normals: the same surface
constexpr float kCosGivenNormal = 0.7071f;  // a given normal further off its face is not believed

// One corner of one sheet, before corners are joined to sites.
struct Corner {
  Vec3 normal{0.f};    // shading normal, on the shown side
  bool given = false;  // from the file
  float angle = 0.f;
  Vec3 inwards{0.f};  // unit, to the centroid
};

struct Corners {
  std::vector<Corner> all;                    // corner k of sheet i at 3 i + k
  IdVector<TriangleId, SheetId> front, back;  // invalid where a side is not shown
};

// Corner k of a sheet is this corner of its source triangle: backs run the other way round.
std::size_t source_corner(const Sheet& s, std::size_t k) { return s.back ? (3 - k) % 3 : k; }

void add_sheets(const Geometry& g, const IdVector<TriangleId, ShownSides>& shown, WorkMesh& mesh,
                Corners& corners) {
  corners.front.resize(g.triangles.size());
  corners.back.resize(g.triangles.size());
  for (std::size_t i = 0; i < g.triangles.size(); ++i) {
    const TriangleId t(i);
    if (shown[t].front) corners.front[t] = mesh.sheets.push_back({{}, t, false});
    if (shown[t].back) corners.back[t] = mesh.sheets.push_back({{}, t, true});
  }
}

Corner measure_corner(const Geometry& g, const Sheet& s, std::size_t k) {
  const auto p = g.corners(s.source);
  const std::size_t at = source_corner(s, k);
  const float side = s.back ? -1.f : 1.f;
  const Vec3 face = side * glm::normalize(g.scaled_normal(s.source));
  const Vec3 to_next = glm::normalize(p[(at + 1) % 3] - p[at]);
  const Vec3 to_last = glm::normalize(p[(at + 2) % 3] - p[at]);
  const Vec3 given = side * g.normals[g.triangles[s.source][at]];
  Corner c;
  c.given = glm::dot(given, face) > kCosGivenNormal;
  c.normal = c.given ? given : face;
  c.angle = std::acos(std::clamp(glm::dot(to_next, to_last), -1.f, 1.f));
  c.inwards = glm::normalize(to_next * glm::distance(p[(at + 1) % 3], p[at]) +
                             to_last * glm::distance(p[(at + 2) % 3], p[at]));
  return c;
}

bool continues(const Corner& a, const Corner& b) {
  return glm::dot(a.normal, b.normal) > (a.given || b.given ? kCosSameNormal : kCosCrease);
}

// Joins the corners at both ends of every edge across which a shown surface continues.
void join_corners(const SharedEdges& edges, const Corners& corners, DisjointSets& sets,
                  std::vector<std::array<bool, 3>>& continues_at) {
  const auto join = [&](SheetId s, std::uint32_t s_side, SheetId r, std::uint32_t r_side) {
    const std::uint32_t s_start = 3 * s.value + s_side, s_end = 3 * s.value + (s_side + 1) % 3;
    const std::uint32_t r_start = 3 * r.value + r_side, r_end = 3 * r.value + (r_side + 1) % 3;
    if (!continues(corners.all[s_start], corners.all[r_end]) ||
        !continues(corners.all[s_end], corners.all[r_start]))
      return;
    sets.join(s_start, r_end);
    sets.join(s_end, r_start);
    continues_at[s.value][s_side] = continues_at[r.value][r_side] = true;
  };
  // Side k of a source triangle is side 2 - k of its back sheet (corners 0, 2, 1).
  edges.for_each([&](std::span<const TriangleSide> sides) {
    if (sides.size() != 2) return;
    const TriangleSide a = sides[0], b = sides[1];
    const bool same_winding = a.upwards != b.upwards;
    const SheetId front_a = corners.front[a.triangle], back_a = corners.back[a.triangle];
    const SheetId front_b = corners.front[b.triangle], back_b = corners.back[b.triangle];
    const std::uint32_t a_back = 2u - a.side, b_back = 2u - b.side;
    if (same_winding) {
      if (front_a.valid() && front_b.valid()) join(front_a, a.side, front_b, b.side);
      if (back_a.valid() && back_b.valid()) join(back_a, a_back, back_b, b_back);
    } else {
      if (front_a.valid() && back_b.valid()) join(front_a, a.side, back_b, b_back);
      if (back_a.valid() && front_b.valid()) join(back_a, a_back, front_b, b.side);
    }
  });
}

// What the corners of a site add up to.
struct SiteShape {
  Vec3 inwards{0.f};  // mean direction into the surface, weighted by angle
  bool on_border = false;
  std::uint32_t reading_corner = 0;  // the corner that holds the reading point
  float reading_fit = -kInfinity;
};

// A reading exactly on a crease is ill-defined: half of its rays may start inside the other wall.
// So sites on the border of their surface are read a little inside of it.
ReadingPoint reading_point(const Geometry& g, const WorkMesh& mesh, const Corners& corners,
                           const SiteShape& shape, const Site& site, float feature_size) {
  const Sheet& sheet = mesh.sheets[SheetId(shape.reading_corner / 3)];
  ReadingPoint point{mesh.points[site.point], site.normal, sheet.source};
  if (!shape.on_border) return point;
  const auto p = g.corners(sheet.source);
  const std::size_t at = source_corner(sheet, shape.reading_corner % 3);
  const Vec3 face = glm::normalize(g.scaled_normal(sheet.source));
  const Vec3 e1 = p[(at + 1) % 3] - p[at], e2 = p[(at + 2) % 3] - p[at];
  const float reach =
      std::min(feature_size / 8.f, std::min(glm::length(e1), glm::length(e2)) / 4.f);
  const Vec3 along = shape.inwards - glm::dot(shape.inwards, face) * face;
  const float length = glm::length(along);
  if (length > 0.f) {
    const Vec3 pulled = along * (reach / length);
    // Barycentric coordinates of the pulled point about this corner.
    const float doubled_area = glm::dot(glm::cross(e1, e2), face);
    const float b1 = glm::dot(glm::cross(pulled, e2), face) / doubled_area;
    const float b2 = glm::dot(glm::cross(e1, pulled), face) / doubled_area;
    if (b1 >= 0.f && b2 >= 0.f && b1 + b2 < 0.5f) {
      point.position += pulled;
      return point;
    }
  }
  const float to_centroid = glm::length(e1 + e2) / 3.f;
  point.position += corners.all[shape.reading_corner].inwards * std::min(reach, to_centroid / 2.f);
  return point;
}

}  // namespace

LitVertexId WorkMesh::find_or_add_vertex(SiteId site_id, InstanceId instance, bool back,
                                         const std::array<Vec2, 2>& uvs) {
  Site& site = sites[site_id];
  for (LitVertexId v = site.first_vertex; v.valid(); v = vertices[v].next)
    if (vertices[v].instance == instance && vertices[v].back == back && vertices[v].uvs == uvs)
      return v;
  site.first_vertex = vertices.push_back({site_id, instance, back, uvs, site.first_vertex});
  return site.first_vertex;
}

WorkMesh make_work_mesh(const Geometry& g, WeldedPoints points, const SharedEdges& edges,
                        const IdVector<TriangleId, ShownSides>& shown, float feature_size,
                        const LightReader& read) {
  WorkMesh mesh;
  Corners corners;
  add_sheets(g, shown, mesh, corners);
  corners.all.resize(3 * mesh.sheets.size());
  parallel_for(corners.all.size(), kGrain, [&](std::size_t i) {
    corners.all[i] = measure_corner(g, mesh.sheets[SheetId(i / 3)], i % 3);
  });
  DisjointSets sets(corners.all.size());
  std::vector<std::array<bool, 3>> continues_at(mesh.sheets.size(), {false, false, false});
  join_corners(edges, corners, sets, continues_at);

  mesh.points = std::move(points.positions);
  std::vector<SiteId> site_of(corners.all.size());
  std::vector<SiteShape> shapes;
  for (std::uint32_t i = 0; i < corners.all.size(); ++i) {
    Sheet& sheet = mesh.sheets[SheetId(i / 3)];
    const VertexId v = g.triangles[sheet.source][source_corner(sheet, i % 3)];
    const std::uint32_t root = sets.root(i);
    if (root == i) {
      site_of[i] = mesh.sites.push_back({points.of_vertex[v], Vec3(0.f), {}, {}});
      shapes.push_back({});
    }
    const SiteId site = site_of[i] = site_of[root];
    const Corner& c = corners.all[i];
    mesh.sites[site].normal += c.angle * c.normal;
    SiteShape& shape = shapes[site.value];
    shape.inwards += c.angle * c.inwards;
    shape.on_border |= !continues_at[i / 3][i % 3] || !continues_at[i / 3][(i + 2) % 3];
    sheet.corners[i % 3] = mesh.find_or_add_vertex(site, g.instances[sheet.source], sheet.back,
                                                   {g.uvs[0][v], g.uvs[1][v]});
  }
  for (std::uint32_t i = 0; i < corners.all.size(); ++i) {
    SiteShape& shape = shapes[site_of[i].value];
    const Corner& c = corners.all[i];
    const float fit = glm::dot(c.inwards, shape.inwards);
    if (fit > shape.reading_fit) shape.reading_fit = fit, shape.reading_corner = i;
  }
  std::vector<ReadingPoint> places(mesh.sites.size());
  parallel_for(places.size(), kGrain, [&](std::size_t i) {
    Site& site = mesh.sites[SiteId(i)];
    const float length = glm::length(site.normal);
    site.normal =
        length > 1e-3f ? site.normal / length : corners.all[shapes[i].reading_corner].normal;
    places[i] = reading_point(g, mesh, corners, shapes[i], site, feature_size);
  });
  const std::vector<Reading> light = read(places);
  for (std::size_t i = 0; i < light.size(); ++i) mesh.sites[SiteId(i)].light = light[i];
  return mesh;
}

}  // namespace halflight
