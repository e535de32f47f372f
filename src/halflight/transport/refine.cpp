#include "halflight/transport/refine.h"

#include <algorithm>

#include "halflight/base/parallel.h"

namespace halflight {
namespace {

constexpr std::size_t kBatch = 1 << 17;  // pairs judged at once
constexpr int kSamples = 4;
constexpr int kBlindSamples = 16;  // on cells above largest_blind_cell
constexpr int kKeptSamples = 16;
constexpr int kFinalSamples = 16;  // of a strong link that cannot be refined
// A pair whose whole transfer is below this share of the threshold gets a single sample.
constexpr float kNegligible = 0.5f;
// A pair whose kernel alone varies by this multiple of the threshold is refined without a ray.
constexpr float kHopeless = 4.f;
// Share of the kernel's variation that is not seen in the spread of samples.
constexpr float kUnseenVariation = 0.1f;

// Streams of samples: to decide with, and to keep.
constexpr std::uint64_t kPilot = 1, kFinal = 2;

struct Verdict {
  enum class Kind : std::uint8_t { drop, accept, split_receiver, split_source, split_both };
  Kind kind = Kind::drop;
  Link link;
};

float gate(const RefineOptions& options, ElementId e) {
  return options.feature_scale * (*options.feature_sizes)[e];
}

// A cell that may still be split.
bool is_large_cell(const ElementTree& tree, const RefineOptions& options, ElementId e) {
  return tree[e].is_leaf_cell() &&
         tree.cell_size(e) > 2.f * smallest_cell(gate(options, e), options.finest_cell);
}

// Elements that are such a cell or have one below them.
IdVector<ElementId, std::uint8_t> hold_large_cells(const ElementTree& tree,
                                                   const RefineOptions& options) {
  IdVector<ElementId, std::uint8_t> hold(tree.size(), 0);
  parallel_for(hold.size(), 4096, [&](std::size_t i) {
    hold[ElementId(i)] = is_large_cell(tree, options, ElementId(i));
  });
  for (std::size_t i = hold.size(); i-- > 1;)  // children come after their parents
    if (hold[ElementId(i)]) hold[tree[ElementId(i)].parent] = 1;
  return hold;
}

// Judges pairs: the oracle of the refinement.
class Oracle {
 public:
  // `hold_large_cells` is only asked for the shape of elements.
  Oracle(const TransferScene& scene, const RefineOptions& options,
         const IdVector<ElementId, float>& tolerance,
         const IdVector<ElementId, std::uint8_t>& hold_large_cells, bool accept_all)
      : scene_(scene),
        options_(options),
        tolerance_(tolerance),
        hold_large_cells_(hold_large_cells),
        accept_all_(accept_all) {
    scene_area_ = scene.tree[scene.tree.root()].area;
  }

  Verdict judge(ElementId r, ElementId s) const {
    const ElementTree& tree = scene_.tree;
    if (r != s && back_facing(tree, r, s)) return {};
    if (options_.shape_only && !can_shape(r)) return {};
    const float radiosity = average(sent_radiosity(tree, scene_.inside, scene_.radiosity, s, r));
    const TransferBounds bounds = bound_transfer(tree, scene_.inside, r, s);
    if (!(radiosity > 0.f)) {
      Link dark;
      dark.source = s;
      dark.weight = Link::kUnsampled;
      dark.error = bounds.largest_weight;
      return {Verdict::Kind::accept, dark};
    }
    const float scale = radiosity * std::sqrt(tree[r].area / scene_area_);
    const Verdict::Kind finer = accept_all_ ? Verdict::Kind::accept : choose_split(r, s);
    const bool can_refine = finer != Verdict::Kind::accept;
    const float threshold = tolerance_[r] * options_.irradiance_threshold;

    if (scale * bounds.largest_weight <= kNegligible * threshold) return accept(r, s, 1, bounds);
    const bool clusters = tree[r].is_cluster() || tree[s].is_cluster();
    if (bounds.touching && clusters && can_refine) return {finer, {}};
    if (can_refine && clusters && bounds.kernel_variation >= 0.5f &&
        scale * bounds.largest_weight * bounds.kernel_variation > kHopeless * threshold)
      return {finer, {}};
    if (!can_refine) {
      Verdict verdict = accept(r, s, kFinalSamples, bounds);
      if (!accept_all_ && options_.feature_scale == 1.f) verdict.link.error = 0.f;
      return verdict;
    }

    TransferEstimate pilot = estimate_transfer(received_by(r), r, s, kSamples, kPilot);
    // A few samples on a large cell that agree may all have missed a shadow, or the light.
    if (is_blind(r) && scale * pilot.deviation <= threshold && scale * pilot.unoccluded > threshold)
      pilot = estimate_transfer(received_by(r), r, s, kBlindSamples, kPilot);
    // What n samples missed may still be one part in n + 1 (rule of succession).
    const float error = std::max(pilot.deviation, pilot.unoccluded / (kBlindSamples + 1)) +
                        kUnseenVariation * bounds.kernel_variation * pilot.weight;
    if (scale * error > threshold) return {finer, {}};
    Verdict verdict = accept(r, s, kKeptSamples, bounds);
    verdict.link.error = error;
    return verdict;
  }

 private:
  // The weight comes from samples that had no say in the decision, now or when the link is tested
  // again: whoever accepts a pair because its samples agree, and keeps those samples,
  // systematically loses what they missed.
  Verdict accept(ElementId r, ElementId s, int samples, const TransferBounds& bounds) const {
    if (options_.shape_only) return {};
    if (accept_all_) samples = 1;
    const bool cells = !scene_.tree[r].is_cluster() && !scene_.tree[s].is_cluster();
    const TransferEstimate t =
        bounds.touching && !cells
            ? estimate_touching_transfer(received_by(r), r, s, samples, kFinal)
            : estimate_transfer(received_by(r), r, s, samples, kFinal);
    Verdict verdict;
    verdict.kind = Verdict::Kind::accept;
    verdict.link.source = s;
    verdict.link.weight = std::min(t.weight, bounds.largest_weight);
    verdict.link.error = bounds.largest_weight / kNegligible;
    verdict.link.direction = t.direction;
    // The weight is a mean over all that faces the source; only what is seen from there gets it.
    if (scene_.inside && scene_.inside->knows(r) && !t.direction.all_around())
      verdict.link.weight *= scene_.inside->concentration(r, t.direction.unpack(), false);
    return verdict;
  }

  float feature_size(ElementId e) const { return (*options_.feature_sizes)[e]; }

  TransferScene received_by(ElementId r) const {
    TransferScene scene = scene_;
    scene.feature_size = feature_size(r);
    return scene;
  }

  bool is_blind(ElementId r) const {
    return !scene_.tree[r].is_cluster() &&
           scene_.tree.cell_size(r) >
               options_.largest_blind_cell * smallest_cell(feature_size(r), options_.finest_cell);
  }

  bool can_split(ElementId e) const {
    const Element& element = scene_.tree[e];
    if (element.is_cluster()) return !element.is_leaf() && element.diameter() > gate(options_, e);
    return !element.is_leaf() || is_large_cell(scene_.tree, options_, e);
  }

  // Light on it asks for smaller cells, if for anything.
  bool can_shape(ElementId receiver) const {
    return hold_large_cells_.contains(receiver) ? hold_large_cells_[receiver] != 0
                                                : can_split(receiver);
  }

  // The larger end first; `accept` when neither end can be split.
  Verdict::Kind choose_split(ElementId r, ElementId s) const {
    if (r == s) return Verdict::Kind::split_both;
    const bool receiver = can_split(r), source = can_split(s);
    if (receiver && (!source || scene_.tree[r].diameter() >= scene_.tree[s].diameter()))
      return Verdict::Kind::split_receiver;
    return source ? Verdict::Kind::split_source : Verdict::Kind::accept;
  }

  const TransferScene& scene_;
  const RefineOptions& options_;
  const IdVector<ElementId, float>& tolerance_;
  const IdVector<ElementId, std::uint8_t>& hold_large_cells_;
  bool accept_all_;
  float scene_area_;
};

// Splits the cells that verdicts ask for, each once, in id order.
void split_cells(ElementTree& tree, const std::vector<ElementPair>& batch,
                 const std::vector<Verdict>& verdicts, const SplitListener& on_split) {
  std::vector<ElementId> wanted;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Verdict::Kind kind = verdicts[i].kind;
    if (kind == Verdict::Kind::split_receiver && tree[batch[i].receiver].is_leaf())
      wanted.push_back(batch[i].receiver);
    if (kind == Verdict::Kind::split_source && tree[batch[i].source].is_leaf())
      wanted.push_back(batch[i].source);
  }
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  for (const ElementId cell : wanted) tree.split(cell);
  if (!wanted.empty()) on_split(wanted);
}

void append_finer_pairs(const ElementTree& tree, const ElementPair& pair, Verdict::Kind kind,
                        std::vector<ElementPair>& out) {
  if (kind == Verdict::Kind::split_receiver) {
    for (const ElementId r : tree[pair.receiver].children()) out.push_back({r, pair.source});
  } else if (kind == Verdict::Kind::split_source) {
    for (const ElementId s : tree[pair.source].children()) out.push_back({pair.receiver, s});
  } else {  // a self-link: all ordered pairs; a plane side does not see itself
    for (const ElementId r : tree[pair.receiver].children())
      for (const ElementId s : tree[pair.receiver].children())
        if (r != s || tree[r].is_cluster()) out.push_back({r, s});
  }
}

}  // namespace

void refine(ElementTree& tree, const Visibility& visibility,
            const IdVector<ElementId, Rgb>& radiosity, const IdVector<ElementId, float>& opacity,
            const IdVector<ElementId, float>& tolerance, std::vector<ElementPair> pairs,
            const RefineOptions& options, const SplitListener& on_split, const Progress& progress,
            std::vector<ReceiverLink>& links, RefineCounts& counts) {
  std::vector<ElementPair> batch;
  std::vector<Verdict> verdicts;
  const auto large_cells =
      options.shape_only ? hold_large_cells(tree, options) : IdVector<ElementId, std::uint8_t>();
  while (!pairs.empty()) {
    const std::size_t n = std::min(pairs.size(), kBatch);
    batch.assign(pairs.end() - static_cast<std::ptrdiff_t>(n), pairs.end());
    pairs.resize(pairs.size() - n);
    const bool accept_all = links.size() > options.most_links ||
                            tree.size() > options.most_elements || progress.cancelled();

    const TransferScene scene{tree, visibility, 0.f, radiosity, opacity, options.inside};
    const Oracle oracle(scene, options, tolerance, large_cells, accept_all);
    verdicts.assign(n, {});
    parallel_for(n, 64, [&](std::size_t i) {
      verdicts[i] = oracle.judge(batch[i].receiver, batch[i].source);
    });

    split_cells(tree, batch, verdicts, on_split);
    for (std::size_t i = 0; i < n; ++i) {
      const Verdict& v = verdicts[i];
      if (v.kind == Verdict::Kind::accept) {
        if (v.link.weight != 0.f || v.link.error > 0.f)
          links.push_back({batch[i].receiver, v.link});
      } else if (v.kind != Verdict::Kind::drop) {
        append_finer_pairs(tree, batch[i], v.kind, pairs);
      }
    }
    counts.pairs += n;
    if (accept_all) counts.accepted_early += n;
  }
}

float weighted_error(const ElementTree& tree, const ClusterVisibility* inside, ElementId receiver,
                     const Link& link, const IdVector<ElementId, Rgb>& radiosity) {
  return link.error * average(sent_radiosity(tree, inside, radiosity, link.source, receiver)) *
         std::sqrt(tree[receiver].area / tree[tree.root()].area);
}

}  // namespace halflight
