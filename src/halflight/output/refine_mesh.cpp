#include "halflight/output/refine_mesh.h"

#include <optional>

#include "halflight/output/edge_table.h"
#include "halflight/output/split_triangle.h"

namespace halflight {
namespace {

// A single input triangle is not cut into more than this many pieces along its longest side without
// a reason: ground planes reach far beyond the scene that stands on them.
constexpr float kUnconditionalPieces = 64.f;
// Surfaces without light get edges this much longer.
constexpr float kUnlitFactor = 8.f;
// Subdivision ends when less than 1 / 200 of the allowed vertices is left.
constexpr std::size_t kLeastRoom = 200;

class Refiner {
 public:
  Refiner(WorkMesh& mesh, const LitMeshOptions& options, float mean_irradiance)
      : mesh_(mesh),
        options_(options),
        mean_irradiance_(mean_irradiance),
        table_(mesh, options.finest) {}

  // Takes on a sheet unless it is too small to be split.
  void add(FineSheet s);
  // Reads the light along the sheets added since the last call. Returns the number of readings.
  std::size_t read_new(const LightReader& read);
  // Chooses the most urgent edges that the vertex limit has room for; false when there are none.
  bool choose();
  // Replaces every sheet with a split side by its parts.
  void subdivide();
  // The largest error among edges that should be split but were not; nothing when there are none.
  std::optional<float> error_left() const;
  std::vector<Sheet> simple() const;

 private:
  float urgency(EdgeId e) const;
  void use(std::uint32_t sheet, std::size_t k);
  void drop(std::uint32_t sheet, std::size_t k);
  std::size_t split_with_longest();
  void undo_split();
  void replace(std::uint32_t i, std::vector<FineSheet>& parts);
  LitVertexId middle_vertex(const FineSheet& s, std::size_t k);
  bool keep_simple(SheetId id);

  WorkMesh& mesh_;
  const LitMeshOptions& options_;
  float mean_irradiance_;
  EdgeTable table_;
  std::vector<FineSheet> sheets_;  // replaced ones keep their place, unused
  std::size_t first_new_sheet_ = 0;
  std::vector<EdgeId> pending_;  // should be split
  std::vector<EdgeId> split_now_;
  std::vector<std::uint32_t> affected_;        // sheets with a side in split_now_
  std::vector<Sheet> simple_;                  // that were split all the same
  IdVector<SheetId, std::uint8_t> in_simple_;  // lies in one of them
};

float longest_side(const WorkMesh& mesh, const Sheet& s) {
  float longest = 0.f;
  for (std::size_t k = 0; k < 3; ++k)
    longest = std::max(
        longest, glm::distance(mesh.position(s.corners[k]), mesh.position(s.corners[(k + 1) % 3])));
  return longest;
}

void Refiner::add(FineSheet s) {
  const auto& v = mesh_.sheets[s.sheet].corners;
  for (std::size_t k = 0; k < 3; ++k)
    if (glm::distance(mesh_.position(v[k]), mesh_.position(v[(k + 1) % 3])) > options_.finest) {
      sheets_.push_back(s);
      return;
    }
}

void Refiner::use(std::uint32_t sheet, std::size_t k) {
  const EdgeId e = sheets_[sheet].edges[k];
  if (!e.valid()) return;
  sheets_[sheet].next_use[k] = table_.edges[e].first_use;
  table_.edges[e].first_use = 3 * sheet + static_cast<std::uint32_t>(k);
}

void Refiner::drop(std::uint32_t sheet, std::size_t k) {
  const EdgeId e = sheets_[sheet].edges[k];
  if (!e.valid()) return;
  const std::uint32_t gone = 3 * sheet + static_cast<std::uint32_t>(k);
  std::uint32_t* at = &table_.edges[e].first_use;
  while (*at != gone) at = &sheets_[*at / 3].next_use[*at % 3];
  *at = sheets_[sheet].next_use[k];
}

std::size_t Refiner::read_new(const LightReader& read) {
  const std::size_t first_edge = table_.edges.size();
  const auto sheets = std::span(sheets_).subspan(first_new_sheet_);
  table_.enter(sheets);
  for (std::size_t i = first_new_sheet_; i < sheets_.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) use(static_cast<std::uint32_t>(i), k);
  const std::size_t readings =
      table_.read_middles(sheets, options_.feature_size, mean_irradiance_, read);
  for (std::size_t e = first_edge; e < table_.edges.size(); ++e)
    if (urgency(EdgeId(e)) > 0.f) pending_.push_back(EdgeId(e));
  first_new_sheet_ = sheets_.size();
  return readings;
}

// Longest sides first, then where interpolation errs most; nothing below the tolerance.
float Refiner::urgency(EdgeId id) const {
  const Edge& e = table_.edges[id];
  if (e.split) return 0.f;
  const float wanted = e.lit ? e.longest_wanted : kUnlitFactor * e.longest_wanted;
  if (e.length > wanted) return 1e6f * e.length / wanted;
  return e.error > options_.tolerance ? e.error : 0.f;
}

// Splits the edges of split_now_; in a triangle with a split side the longest side joins them.
// Returns the number of sheet sides that are split, an upper bound of the vertices to come.
std::size_t Refiner::split_with_longest() {
  for (const EdgeId e : split_now_) table_.edges[e].split = true;
  std::size_t sides = 0;
  for (std::size_t i = 0; i < split_now_.size(); ++i) {
    const EdgeId e = split_now_[i];
    for (std::uint32_t u = table_.edges[e].first_use; u != kNoUse;
         u = sheets_[u / 3].next_use[u % 3]) {
      ++sides;
      FineSheet& s = sheets_[u / 3];
      if (s.affected) continue;
      s.affected = true;
      affected_.push_back(u / 3);
      EdgeId longest = e;
      for (const EdgeId other : s.edges)
        if (other.valid() && table_.longer(other, longest)) longest = other;
      if (table_.edges[longest].split) continue;
      table_.edges[longest].split = true;
      split_now_.push_back(longest);
    }
  }
  return sides;
}

void Refiner::undo_split() {
  for (const EdgeId e : split_now_) table_.edges[e].split = false;
  for (const std::uint32_t i : affected_) sheets_[i].affected = false;
  split_now_.clear();
  affected_.clear();
}

bool Refiner::choose() {
  std::erase_if(pending_, [&](EdgeId e) { return table_.edges[e].split; });
  const std::size_t in_use = mesh_.vertices.size();
  const std::size_t room = options_.max_vertices > in_use ? options_.max_vertices - in_use : 0;
  if (pending_.empty() || room < options_.max_vertices / kLeastRoom) return false;
  split_now_ = pending_;
  std::size_t sides = split_with_longest();
  if (sides <= room) return true;
  std::stable_sort(pending_.begin(), pending_.end(),
                   [&](EdgeId a, EdgeId b) { return urgency(a) > urgency(b); });
  for (std::size_t count = pending_.size(); sides > room;) {
    undo_split();
    count = std::min(count / 2, count * room / sides);
    if (count == 0) return false;
    split_now_.assign(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(count));
    sides = split_with_longest();
  }
  return true;
}

std::optional<float> Refiner::error_left() const {
  std::optional<float> largest;
  for (const EdgeId e : pending_)
    if (!table_.edges[e].split) largest = std::max(largest.value_or(0.f), table_.edges[e].error);
  return largest;
}

LitVertexId Refiner::middle_vertex(const FineSheet& s, std::size_t k) {
  const auto& corners = mesh_.sheets[s.sheet].corners;
  const LitVertex a = mesh_.vertices[corners[k]], b = mesh_.vertices[corners[(k + 1) % 3]];
  const SiteId site = table_.middle(s, k);
  mesh_.sites[site].point = table_.edges[s.edges[k]].middle;
  return mesh_.find_or_add_vertex(site, a.instance, a.back,
                                  {0.5f * (a.uvs[0] + b.uvs[0]), 0.5f * (a.uvs[1] + b.uvs[1])});
}

void Refiner::replace(std::uint32_t i, std::vector<FineSheet>& parts) {
  const FineSheet whole = sheets_[i];
  const Sheet sheet = mesh_.sheets[whole.sheet];
  std::size_t longest = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (whole.edges[k].valid() &&
        (!whole.edges[longest].valid() || table_.longer(whole.edges[k], whole.edges[longest])))
      longest = k;
  SplitTriangle split;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t side = (longest + k) % 3;
    split.corners[k] = sheet.corners[side];
    if (whole.edges[side].valid() && table_.edges[whole.edges[side]].split)
      split.middles[k] = middle_vertex(whole, side);
  }
  const Vec3 c = mesh_.position(split.corners[2]);
  split.obtuse =
      glm::dot(mesh_.position(split.corners[0]) - c, mesh_.position(split.corners[1]) - c) < 0.f;
  const bool smooth_indirect =
      whole.smooth_indirect || table_.is_indirect_smooth(whole, mean_irradiance_);
  const bool in_simple = keep_simple(whole.sheet);
  bool is_first = true;
  for (const auto& corners : parts_of(split)) {
    FineSheet part;
    part.longest_wanted = whole.longest_wanted;
    part.primary = whole.primary;
    part.smooth_indirect = smooth_indirect;
    part.sheet = is_first ? whole.sheet : mesh_.sheets.push_back({{}, sheet.source, sheet.back});
    mesh_.sheets[part.sheet].corners = corners;
    if (in_simple) {
      in_simple_.resize(mesh_.sheets.size(), 0);
      in_simple_[part.sheet] = 1;
    }
    parts.push_back(part);
    is_first = false;
  }
}

void Refiner::subdivide() {
  for (const EdgeId e : split_now_) {
    Edge& edge = table_.edges[e];
    edge.middle =
        mesh_.points.push_back(0.5f * (mesh_.points[edge.ends[0]] + mesh_.points[edge.ends[1]]));
  }
  std::vector<FineSheet> parts;
  for (const std::uint32_t i : affected_) {
    for (std::size_t k = 0; k < 3; ++k) drop(i, k);
    replace(i, parts);
  }
  for (const FineSheet& part : parts) add(part);
  split_now_.clear();
  affected_.clear();
}

// Before a sheet is split: whether it lies in the simpler mesh, or in a triangle that does.
bool Refiner::keep_simple(SheetId id) {
  if (options_.simple <= 0.f) return false;
  in_simple_.resize(mesh_.sheets.size(), 0);
  if (in_simple_[id] == 0 && longest_side(mesh_, mesh_.sheets[id]) <= options_.simple) {
    simple_.push_back(mesh_.sheets[id]);
    in_simple_[id] = 1;
  }
  return in_simple_[id] != 0;
}

std::vector<Sheet> Refiner::simple() const {
  std::vector<Sheet> all = simple_;
  if (options_.simple <= 0.f) return all;
  for (std::size_t i = 0; i < mesh_.sheets.size(); ++i)
    if (i >= in_simple_.size() || in_simple_[SheetId(i)] == 0)
      all.push_back(mesh_.sheets[SheetId(i)]);
  return all;
}

}  // namespace

std::vector<Sheet> refine_mesh(WorkMesh& mesh, const IdVector<TriangleId, ShownSides>& shown,
                               const LightReader& read, const LitMeshOptions& options,
                               float mean_irradiance, const Progress& progress, LitMesh& result) {
  Refiner refiner(mesh, options, mean_irradiance);
  for (std::size_t i = 0; i < mesh.sheets.size(); ++i) {
    const Sheet& sheet = mesh.sheets[SheetId(i)];
    FineSheet s;
    s.sheet = SheetId(i);
    s.longest_wanted = std::max(options.coarse, longest_side(mesh, sheet) / kUnconditionalPieces);
    s.primary = !sheet.back || !shown[sheet.source].front;
    refiner.add(s);
  }
  result.readings += refiner.read_new(read);
  while (!progress.cancelled() && refiner.choose()) {
    refiner.subdivide();
    result.readings += refiner.read_new(read);
    ++result.rounds;
    progress.report("lit mesh", 1.0 - 1.0 / static_cast<double>(result.rounds + 1));
  }
  const auto error_left = refiner.error_left();
  result.limited = error_left.has_value();
  result.largest_error_left = error_left.value_or(0.f);
  return refiner.simple();
}

}  // namespace halflight
