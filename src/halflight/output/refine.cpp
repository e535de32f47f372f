#include "halflight/output/refine.h"

#include "halflight/output/edge_table.h"

namespace halflight {
namespace {

// A single input triangle is not cut into more than this many pieces along its longest side without
// a reason: ground planes reach far beyond the scene that stands on them.
constexpr float kUnconditionalPieces = 64.f;
// Surfaces without light get edges this much longer.
constexpr float kUnlitFactor = 8.f;

class Refiner {
 public:
  Refiner(WorkMesh& mesh, const LitMeshOptions& options)
      : mesh_(mesh), options_(options), table_(mesh, options.finest) {}

  EdgeTable& table() { return table_; }
  std::vector<FineSheet>& sheets() { return sheets_; }

  // Longest sides first, then where interpolation errs most; nothing below the tolerance.
  float urgency(const Edge& e) const {
    if (e.split) return 0.f;
    const float wanted = e.lit ? e.longest_wanted : kUnlitFactor * e.longest_wanted;
    if (e.length > wanted) return 1e6f * e.length / wanted;
    return e.error > options_.tolerance ? e.error : 0.f;
  }

  std::vector<EdgeId> wanted() const;
  // Chooses the most urgent edges that the vertex limit has room for; false when there are none.
  bool choose();
  // Replaces every sheet with a split side by its parts. Returns the new ones, which follow the
  // others in `sheets`.
  std::span<FineSheet> subdivide();

 private:
  std::size_t close_over_longest();
  void replace(std::size_t i, std::vector<FineSheet>& created);
  LitVertexId middle_vertex(const FineSheet& s, std::size_t k);

  WorkMesh& mesh_;
  const LitMeshOptions& options_;
  EdgeTable table_;
  std::vector<FineSheet> sheets_;  // those with a side that can be split
  std::vector<EdgeId> split_now_;
};

// In a triangle with a split side the longest side is split too. Returns the number of triangle
// sides that are split now, an upper bound of the vertices to come.
std::size_t Refiner::close_over_longest() {
  for (bool changed = true; changed;) {
    changed = false;
    for (const FineSheet& s : sheets_) {
      EdgeId longest;
      bool any = false;
      for (const EdgeId e : s.edges) {
        if (!e.valid()) continue;
        any |= table_.edges[e].split;
        if (!longest.valid() || table_.longer(e, longest)) longest = e;
      }
      if (!any || table_.edges[longest].split) continue;
      table_.edges[longest].split = true;
      split_now_.push_back(longest);
      changed = true;
    }
  }
  std::size_t sides = 0;
  for (const FineSheet& s : sheets_)
    for (const EdgeId e : s.edges) sides += e.valid() && table_.edges[e].split;
  return sides;
}

std::vector<EdgeId> Refiner::wanted() const {
  std::vector<EdgeId> edges;
  for (std::uint32_t i = 0; i < table_.edges.size(); ++i)
    if (urgency(table_.edges[EdgeId(i)]) > 0.f) edges.push_back(EdgeId(i));
  return edges;
}

bool Refiner::choose() {
  std::vector<EdgeId> edges = wanted();
  const std::size_t in_use = mesh_.vertices.size();
  const std::size_t room = options_.max_vertices > in_use ? options_.max_vertices - in_use : 0;
  for (std::size_t count = edges.size(); count > 0; count /= 2) {
    if (count < edges.size())
      std::stable_sort(edges.begin(), edges.end(), [&](EdgeId a, EdgeId b) {
        return urgency(table_.edges[a]) > urgency(table_.edges[b]);
      });
    edges.resize(count);
    split_now_ = edges;
    for (const EdgeId e : split_now_) table_.edges[e].split = true;
    if (close_over_longest() <= room) return true;
    for (const EdgeId e : split_now_) table_.edges[e].split = false;
  }
  split_now_.clear();
  return false;
}

LitVertexId Refiner::middle_vertex(const FineSheet& s, std::size_t k) {
  const auto& corners = mesh_.sheets[s.sheet].corners;
  const LitVertex a = mesh_.vertices[corners[k]], b = mesh_.vertices[corners[(k + 1) % 3]];
  const SiteId site = table_.middle(s, k);
  mesh_.sites[site].point = table_.edges[s.edges[k]].middle;
  return mesh_.find_or_add_vertex(site, a.instance,
                                  {0.5f * (a.uvs[0] + b.uvs[0]), 0.5f * (a.uvs[1] + b.uvs[1])});
}

// Templates for the triangle a b c, turned so that a b is its longest side: that is always split,
// at x. With y in the middle of b c and z in the middle of c a:
//   x        a x c, x b c
//   x y      a x c, x b y, x y c
//   x z      x b c, a x z, x c z
//   x y z    a x z, x b y, and z y c, x y z (four alike), or x y c, x c z where c is obtuse
void Refiner::replace(std::size_t i, std::vector<FineSheet>& created) {
  const FineSheet s = sheets_[i];
  const Sheet old = mesh_.sheets[s.sheet];
  std::size_t first = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (s.edges[k].valid() &&
        (!s.edges[first].valid() || table_.longer(s.edges[k], s.edges[first])))
      first = k;
  const auto side = [&](std::size_t k) { return (first + k) % 3; };
  const auto is_split = [&](std::size_t k) {
    return s.edges[side(k)].valid() && table_.edges[s.edges[side(k)]].split;
  };
  if (!is_split(0)) return;
  const LitVertexId a = old.corners[side(0)], b = old.corners[side(1)], c = old.corners[side(2)];
  const LitVertexId x = middle_vertex(s, side(0));
  bool is_first = true;
  const auto emit = [&](LitVertexId p, LitVertexId q, LitVertexId r) {
    FineSheet part{s.sheet, s.longest_wanted, s.primary, {}, {}};
    if (is_first)
      mesh_.sheets[s.sheet].corners = {p, q, r};
    else
      part.sheet = mesh_.sheets.push_back({{p, q, r}, old.source, old.back});
    is_first = false;
    created.push_back(part);
  };
  if (is_split(1) && is_split(2)) {
    const LitVertexId y = middle_vertex(s, side(1)), z = middle_vertex(s, side(2));
    emit(a, x, z);
    emit(x, b, y);
    const Vec3 ca = mesh_.position(a) - mesh_.position(c),
               cb = mesh_.position(b) - mesh_.position(c);
    if (glm::dot(ca, cb) < 0.f) {
      emit(x, y, c);
      emit(x, c, z);
    } else {
      emit(z, y, c);
      emit(x, y, z);
    }
  } else if (is_split(1)) {
    const LitVertexId y = middle_vertex(s, side(1));
    emit(a, x, c);
    emit(x, b, y);
    emit(x, y, c);
  } else if (is_split(2)) {
    const LitVertexId z = middle_vertex(s, side(2));
    emit(x, b, c);
    emit(a, x, z);
    emit(x, c, z);
  } else {
    emit(a, x, c);
    emit(x, b, c);
  }
}

std::span<FineSheet> Refiner::subdivide() {
  for (const EdgeId e : split_now_) {
    Edge& edge = table_.edges[e];
    edge.middle =
        mesh_.points.push_back(0.5f * (mesh_.points[edge.ends[0]] + mesh_.points[edge.ends[1]]));
  }
  const auto is_affected = [&](const FineSheet& s) {
    return std::any_of(s.edges.begin(), s.edges.end(),
                       [&](EdgeId e) { return e.valid() && table_.edges[e].split; });
  };
  std::vector<FineSheet> kept, created;
  for (std::size_t i = 0; i < sheets_.size(); ++i) {
    if (is_affected(sheets_[i]))
      replace(i, created);
    else
      kept.push_back(sheets_[i]);
  }
  const auto can_be_split = [&](const FineSheet& s) {
    const auto& v = mesh_.sheets[s.sheet].corners;
    for (std::size_t k = 0; k < 3; ++k)
      if (glm::distance(mesh_.position(v[k]), mesh_.position(v[(k + 1) % 3])) > options_.finest)
        return true;
    return false;
  };
  const std::size_t first_new = kept.size();
  for (const FineSheet& s : created)
    if (can_be_split(s)) kept.push_back(s);
  sheets_ = std::move(kept);
  split_now_.clear();
  return std::span(sheets_).subspan(first_new);
}

float longest_side(const WorkMesh& mesh, const Sheet& s) {
  float longest = 0.f;
  for (std::size_t k = 0; k < 3; ++k)
    longest = std::max(
        longest, glm::distance(mesh.position(s.corners[k]), mesh.position(s.corners[(k + 1) % 3])));
  return longest;
}

}  // namespace

void refine(WorkMesh& mesh, const IdVector<TriangleId, ShownSides>& shown, const LightReader& read,
            const LitMeshOptions& options, float mean_irradiance, const Progress& progress,
            LitMesh& result) {
  Refiner refiner(mesh, options);
  for (std::size_t i = 0; i < mesh.sheets.size(); ++i) {
    const Sheet& s = mesh.sheets[SheetId(i)];
    const float longest = longest_side(mesh, s);
    if (!(longest > options.finest)) continue;
    const bool primary = !s.back || !shown[s.source].front;
    refiner.sheets().push_back(
        {SheetId(i), std::max(options.coarse, longest / kUnconditionalPieces), primary, {}, {}});
  }
  EdgeTable& table = refiner.table();
  std::span<FineSheet> created = refiner.sheets();
  for (;;) {
    table.enter(created);
    result.readings += table.read_middles(created, options.feature_size, mean_irradiance, read);
    if (progress.cancelled() || !refiner.choose()) break;
    created = refiner.subdivide();
    ++result.rounds;
    progress.report("lit mesh", 1.0 - 1.0 / static_cast<double>(result.rounds + 1));
  }
  for (const EdgeId e : refiner.wanted()) {
    result.limited = true;
    result.largest_error_left = std::max(result.largest_error_left, table.edges[e].error);
  }
}

}  // namespace halflight
