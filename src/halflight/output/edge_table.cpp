#include "halflight/output/edge_table.h"

#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

// Light darker than this share of the mean irradiance is judged relative to this share.
constexpr float kDarkest = 0.1f;
constexpr float kUnlit = 1e-4f;
// Indirect light off the straight line by less than this share is interpolated from there on.
constexpr float kSmoothIndirect = 0.04f;

template <class IdT>
std::uint64_t pair_key(IdT a, IdT b) {
  return mix_bits(std::uint64_t{std::min(a, b).value} << 32 | std::max(a, b).value);
}

}  // namespace

bool EdgeTable::longer(EdgeId a, EdgeId b) const {
  const float la = edges[a].length, lb = edges[b].length;
  return la != lb ? la > lb : a > b;
}

std::size_t EdgeTable::direction(const FineSheet& s, std::size_t k) const {
  const auto& corners = mesh_.sheets[s.sheet].corners;
  return mesh_.site(corners[k]) < mesh_.site(corners[(k + 1) % 3]) ? 0 : 1;
}

SiteId EdgeTable::middle(const FineSheet& s, std::size_t k) const {
  return site_edges[s.site_edges[k]].middle[direction(s, k)];
}

void EdgeTable::enter(std::span<FineSheet> sheets) {
  for (FineSheet& s : sheets) {
    const auto& corners = mesh_.sheets[s.sheet].corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const LitVertexId v = corners[k], w = corners[(k + 1) % 3];
      const PointId p = mesh_.point(v), q = mesh_.point(w);
      const float length = glm::distance(mesh_.points[p], mesh_.points[q]);
      if (!(length > finest_) || p == q) continue;
      const auto [edge_entry, new_edge] = edge_of_.try_emplace(pair_key(p, q), EdgeId());
      if (new_edge) {
        edge_entry.value() = edges.push_back(
            {.ends = {p, q}, .middle = {}, .length = length, .longest_wanted = s.longest_wanted});
      }
      s.edges[k] = edge_entry->second;
      Edge& edge = edges[s.edges[k]];
      edge.longest_wanted = std::min(edge.longest_wanted, s.longest_wanted);
      if (s.primary && edge.triangles < 3) ++edge.triangles;

      const auto [entry, is_new] =
          site_edge_of_.try_emplace(pair_key(mesh_.site(v), mesh_.site(w)), SiteEdgeId());
      if (is_new) entry.value() = site_edges.push_back({.edge = s.edges[k], .middle = {}});
      s.site_edges[k] = entry->second;
      std::uint8_t& users = site_edges[s.site_edges[k]].users[direction(s, k)];
      if (users < 2) ++users;
    }
  }
}

std::size_t EdgeTable::read_middles(std::span<const FineSheet> sheets, float feature_size,
                                    float mean_irradiance, const LightReader& read) {
  std::vector<ReadingPoint> places;
  std::vector<std::array<LitVertexId, 2>> ends;  // of the sides that the places halve
  const std::size_t first_new = mesh_.sites.size();
  for (const FineSheet& s : sheets) {
    const Sheet& sheet = mesh_.sheets[s.sheet];
    for (std::size_t k = 0; k < 3; ++k) {
      if (!s.edges[k].valid()) continue;
      SiteEdge& site_edge = site_edges[s.site_edges[k]];
      SiteId& middle = site_edge.middle[direction(s, k)];
      if (middle.valid()) continue;
      const bool continues = site_edge.users[0] == 1 && site_edge.users[1] == 1 &&
                             edges[site_edge.edge].triangles == 2;
      const LitVertexId a = sheet.corners[k], b = sheet.corners[(k + 1) % 3];
      const Vec3 p = 0.5f * (mesh_.position(a) + mesh_.position(b));
      const Vec3 normal_sum = mesh_.sites[mesh_.site(a)].normal + mesh_.sites[mesh_.site(b)].normal;
      const float length = glm::length(normal_sum);
      const Vec3 normal = length > 1e-3f ? normal_sum / length : mesh_.sites[mesh_.site(a)].normal;
      middle = mesh_.sites.push_back({{}, normal, {}, {}});
      ReadingPoint place{.position = p,
                         .normal = normal,
                         .triangle = sheet.source,
                         .direct_only = s.smooth_indirect};
      if (continues)
        site_edge.middle = {middle, middle};
      else {  // read a little inside the surface that ends here
        const Vec3 inwards = mesh_.position(sheet.corners[(k + 2) % 3]) - p;
        place.position += inwards * std::min(1.f / 6.f, feature_size / 8.f / glm::length(inwards));
      }
      places.push_back(place);
      ends.push_back({a, b});
    }
  }
  const std::vector<Reading> light = read(places);
  for (std::size_t i = 0; i < light.size(); ++i) {
    Site& site = mesh_.sites[SiteId(first_new + i)];
    site.light = light[i];
    if (places[i].direct_only)
      site.light.indirect = 0.5f * (mesh_.sites[mesh_.site(ends[i][0])].light.indirect +
                                    mesh_.sites[mesh_.site(ends[i][1])].light.indirect);
  }
  for (const FineSheet& s : sheets)
    for (std::size_t k = 0; k < 3; ++k)
      if (s.edges[k].valid()) rate(s, k, mean_irradiance);
  return places.size();
}

bool EdgeTable::is_indirect_smooth(const FineSheet& s, float mean_irradiance) const {
  const auto& corners = mesh_.sheets[s.sheet].corners;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!s.edges[k].valid()) continue;
    const Rgb a = mesh_.sites[mesh_.site(corners[k])].light.indirect;
    const Rgb b = mesh_.sites[mesh_.site(corners[(k + 1) % 3])].light.indirect;
    const Reading& m = mesh_.sites[middle(s, k)].light;
    const float scale = std::max(max_component(m.irradiance()), kDarkest * mean_irradiance);
    if (max_component(glm::abs(m.indirect - 0.5f * (a + b))) > kSmoothIndirect * scale)
      return false;
  }
  return true;
}

void EdgeTable::rate(const FineSheet& s, std::size_t k, float mean_irradiance) {
  const auto& corners = mesh_.sheets[s.sheet].corners;
  const Rgb a = mesh_.sites[mesh_.site(corners[k])].light.irradiance();
  const Rgb b = mesh_.sites[mesh_.site(corners[(k + 1) % 3])].light.irradiance();
  const Rgb m = mesh_.sites[middle(s, k)].light.irradiance();
  const float here = max_component(0.25f * (a + b) + 0.5f * m);
  const float scale = std::max(here, kDarkest * mean_irradiance);
  Edge& edge = edges[s.edges[k]];
  if (scale > 0.f)
    edge.error = std::max(edge.error, max_component(glm::abs(m - 0.5f * (a + b))) / scale);
  edge.lit |= here > kUnlit * mean_irradiance;
}

}  // namespace halflight
