#include "halflight/transport/cluster_visibility.h"

#include "halflight/base/parallel.h"
#include "halflight/transport/item_buffer.h"

namespace halflight {
namespace {

constexpr std::size_t kMostTested = 32;  // items, for lying before each other
constexpr float kFlat = 1e-4f;           // of the cluster's diameter
constexpr float kLeastHidden = 0.05f;   // of what faces the first directions, or all counts as seen
constexpr float kPixelsPerItem = 32.f;  // keeps the time linear in the contents
constexpr int kLeastResolution = 32;
// What covers fewer pixels is judged from elsewhere.
constexpr std::uint32_t kLeastPixels = 1;
// Items that face away by more than this face no direction of the cell.
constexpr float kFacesAway = -0.5f;
// How far a direction is tilted towards the normal of an item that it sees edge on.
constexpr std::array<float, 3> kTilts{0.5f, 1.f, 2.f};
// Light that the picture along the middle of a cell hardly lets in is not heaped on the little that
// it shows.
constexpr float kMostConcentration = 20.f;

void collect_sides(const ElementTree& tree, ElementId cluster,
                   std::vector<ClusterVisibility::Item>& items) {
  std::vector<ElementId> open{cluster};
  while (!open.empty()) {
    const ElementId e = open.back();
    open.pop_back();
    if (!tree[e].is_cluster()) {
      items.push_back({e, tree.normal(e), tree[e].area});
      continue;
    }
    for (const ElementId child : tree[e].children()) open.push_back(child);
  }
}

// Whether something of the cluster may lie before one of its items: by their planes.
bool may_hide_itself(const ElementTree& tree, ElementId cluster,
                     std::span<const ClusterVisibility::Item> items) {
  if (items.size() > kMostTested) return true;
  const float flat = kFlat * tree[cluster].diameter();
  std::vector<Vec3> corners;
  for (const ClusterVisibility::Item& item : items)
    tree.for_each_piece(item.cell, [&](std::span<const Vec3> piece) {
      corners.insert(corners.end(), piece.begin(), piece.end());
    });
  return std::any_of(items.begin(), items.end(), [&](const ClusterVisibility::Item& item) {
    const Vec3 origin = tree.surfaces()[tree[item.cell].side].origin;
    return std::any_of(corners.begin(), corners.end(),
                       [&](const Vec3& p) { return glm::dot(p - origin, item.normal) > flat; });
  });
}

float share_of(const ItemPixels& p) {
  return static_cast<float>(p.seen) / static_cast<float>(std::max(p.covered, 1u));
}

// Zero stays nothing, and nothing else becomes it.
std::uint8_t quantise_share(float share) {
  if (!(share > 0.f)) return 0;
  return static_cast<std::uint8_t>(std::clamp(std::lround(255.f * share), 1L, 255L));
}

// The pixels of all items of a cluster along all directions.
class Survey {
 public:
  Survey(const ElementTree& tree, std::span<const ClusterVisibility::Item> items)
      : items_(items), pixels_(items.size() * kDirectionCells) {
    std::vector<ElementId> parents;
    for (const ClusterVisibility::Item& item : items) parents.push_back(tree[item.cell].parent);
    std::vector<ElementId> pools = parents;
    std::sort(pools.begin(), pools.end());
    pools.erase(std::unique(pools.begin(), pools.end()), pools.end());
    pools_ = pools.size() + 1;
    for (const ElementId parent : parents)
      pool_of_.push_back(static_cast<std::size_t>(
          std::lower_bound(pools.begin(), pools.end(), parent) - pools.begin()));
    pooled_.resize(pools_ * kDirectionCells);
  }

  void add(std::size_t item, int cell, const ItemPixels& seen) {
    const auto c = static_cast<std::size_t>(cell);
    pixels_[item * kDirectionCells + c] = seen;
    for (const std::size_t pool : {pool_of_[item], pools_ - 1}) {
      pooled_[pool * kDirectionCells + c].covered += seen.covered;
      pooled_[pool * kDirectionCells + c].seen += seen.seen;
    }
  }

  const ItemPixels& at(std::size_t item, int cell) const {
    return pixels_[item * kDirectionCells + static_cast<std::size_t>(cell)];
  }

  float share(std::size_t i, int cell) const {
    if (at(i, cell).covered >= kLeastPixels) return share_of(at(i, cell));
    const Vec3 d = direction_of_cell(cell);
    if (glm::dot(items_[i].normal, d) < kFacesAway) return 0.f;
    for (const float tilt : kTilts) {
      const ItemPixels& tilted = at(i, direction_cell(d + tilt * items_[i].normal));
      if (tilted.covered >= kLeastPixels) return share_of(tilted);
    }
    return share_of_neighbourhood(i, cell);
  }

 private:
  // Items below a pixel share what is seen of the sub-cluster that they belong to, or of all.
  float share_of_neighbourhood(std::size_t i, int cell) const {
    const ItemPixels& near = pool(pool_of_[i], cell);
    if (near.covered >= kLeastPixels) return share_of(near);
    const ItemPixels& all = pool(pools_ - 1, cell);
    return all.covered > 0 ? share_of(all) : 1.f;
  }
  const ItemPixels& pool(std::size_t p, int cell) const {
    return pooled_[p * kDirectionCells + static_cast<std::size_t>(cell)];
  }

  std::span<const ClusterVisibility::Item> items_;
  std::vector<ItemPixels> pixels_;
  // Sums over the items of each sub-cluster, and over all at the end.
  std::vector<std::size_t> pool_of_;
  std::size_t pools_ = 1;
  std::vector<ItemPixels> pooled_;
};

// What is known of a cluster.
struct Contents {
  ElementId cluster;
  std::vector<ClusterVisibility::Item> items;
  std::vector<std::uint8_t> shares;
};

// One picture shows a direction and the opposite one. The first few are spread.
std::vector<int> picture_cells() {
  std::vector<int> cells, others;
  for (int cell = 0; cell < kDirectionCells; ++cell) {
    if (opposite_cell(cell) < cell) continue;
    const bool first = cell % (2 * kCellsPerEdge * kCellsPerEdge) == 0;
    (first ? cells : others).push_back(cell);
  }
  cells.insert(cells.end(), others.begin(), others.end());
  return cells;
}
constexpr std::size_t kFirstPictures = 3;

// False when too little is hidden to matter.
bool look_from_all_sides(const ElementTree& tree, const IdVector<ElementId, float>& opacity,
                         Contents& contents) {
  static const std::vector<int> picture_order = picture_cells();
  const auto& items = contents.items;
  std::vector<ElementId> cells;
  float smallest = kInfinity;
  for (const ClusterVisibility::Item& item : items) {
    cells.push_back(item.cell);
    smallest = std::min(smallest, item.area);
  }
  const int affordable =
      static_cast<int>(std::sqrt(kPixelsPerItem * static_cast<float>(items.size())));
  const int resolution = std::min(item_resolution(tree[contents.cluster].box, smallest),
                                  std::max(kLeastResolution, affordable));
  ItemBuffer buffer(tree, cells, opacity, resolution);
  Survey survey(tree, items);
  std::vector<ItemPixels> pixels(items.size());
  std::size_t covered = 0, seen = 0;
  for (std::size_t picture = 0; picture < picture_order.size(); ++picture) {
    if (picture == kFirstPictures &&
        static_cast<float>(covered - seen) < kLeastHidden * static_cast<float>(covered))
      return false;
    const int cell = picture_order[picture], opposite = opposite_cell(cell);
    const Vec3 d = direction_of_cell(cell);
    buffer.look_along(d, pixels);
    for (std::size_t i = 0; i < items.size(); ++i) {
      survey.add(i, glm::dot(items[i].normal, d) > 0.f ? cell : opposite, pixels[i]);
      covered += pixels[i].covered;
      seen += std::min(pixels[i].seen, pixels[i].covered);
    }
  }
  contents.shares.reserve(items.size() * kDirectionCells);
  for (std::size_t i = 0; i < items.size(); ++i)
    for (int cell = 0; cell < kDirectionCells; ++cell)
      contents.shares.push_back(quantise_share(survey.share(i, cell)));
  return true;
}

}  // namespace

ClusterVisibility::ClusterVisibility(const ElementTree& tree,
                                     const IdVector<ElementId, float>& opacity,
                                     std::span<const ElementId> elements)
    : number_(tree.initial_size(), kUnknown) {
  const auto known = parallel_collect<Contents>(
      elements.size(), 16, [&](std::size_t i, std::vector<Contents>& found) {
        if (!tree[elements[i]].is_cluster()) return;
        Contents contents{elements[i], {}, {}};
        collect_sides(tree, elements[i], contents.items);
        if (may_hide_itself(tree, elements[i], contents.items) &&
            look_from_all_sides(tree, opacity, contents))
          found.push_back(std::move(contents));
      });
  first_.push_back(0);
  for (const Contents& c : known) {
    number_[c.cluster.value] = static_cast<std::uint32_t>(clusters_.size());
    clusters_.push_back(c.cluster);
    for (const Item& item : c.items) {
      number_[item.cell.value] = static_cast<std::uint32_t>(items_.size());
      items_.push_back(item);
    }
    shares_.insert(shares_.end(), c.shares.begin(), c.shares.end());
    first_.push_back(static_cast<std::uint32_t>(items_.size()));
  }
  silhouette_.resize(clusters_.size());
  parallel_for(clusters_.size(), 64, [&](std::size_t c) {
    for (int cell = 0; cell < kDirectionCells; ++cell)
      silhouette_[c] =
          std::max(silhouette_[c], facing_area(clusters_[c], direction_of_cell(cell)).seen);
  });
}

ClusterVisibility::FacingArea ClusterVisibility::facing_area(ElementId cluster,
                                                             const Vec3& w) const {
  const int cell = direction_cell(w);
  const std::span<const Item> items = this->items(cluster);
  FacingArea sum;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const float facing = items[i].area * std::max(0.f, glm::dot(items[i].normal, w));
    sum.all += facing;
    sum.seen += facing * share(cluster, i, cell);
  }
  return sum;
}

float ClusterVisibility::concentration(ElementId cluster, const Vec3& w, bool hidden) const {
  const FacingArea area = facing_area(cluster, w);
  const float part = hidden ? area.all - area.seen : area.seen;
  return std::min(area.all / std::max(part, 1e-30f), kMostConcentration);
}

Rgb ClusterVisibility::seen_radiosity(ElementId cluster, int cell,
                                      const IdVector<ElementId, Rgb>& radiosity) const {
  const Vec3 w = direction_of_cell(cell);
  const std::span<const Item> items = this->items(cluster);
  Rgb power(0.f);
  float area = 0.f;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const float seen =
        items[i].area * std::max(0.f, glm::dot(items[i].normal, w)) * share(cluster, i, cell);
    power += seen * radiosity[items[i].cell];
    area += seen;
  }
  return area > 0.f ? power / area : radiosity[cluster];
}

std::vector<Rgb> hand_out(const ClusterVisibility& inside, ElementId cluster,
                          std::span<const Arrival> light) {
  const std::span<const ClusterVisibility::Item> items = inside.items(cluster);
  std::vector<Rgb> irradiance(items.size(), Rgb(0.f));
  for (const Arrival& a : light) {
    const int cell = direction_cell(a.towards_source);
    for (std::size_t i = 0; i < items.size(); ++i) {
      const float cosine = glm::dot(items[i].normal, a.towards_source);
      if (!(cosine > 0.f)) continue;
      irradiance[i] += cosine * inside.share(cluster, i, cell) * a.facing;
    }
  }
  return irradiance;
}

DirectionalIrradiance directional_irradiance(std::span<const Arrival> light) {
  DirectionalIrradiance sum;
  for (const Arrival& a : light) sum.add(a.towards_source, a.facing);
  return sum;
}

}  // namespace halflight
