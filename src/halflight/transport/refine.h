// Refinement: from a list of element pairs to links whose estimated error is small enough.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "halflight/base/progress.h"
#include "halflight/hierarchy/elements.h"
#include "halflight/transport/link.h"
#include "halflight/transport/transfer.h"

namespace halflight {

// The feature gate: cells are not split below half their feature size, nor below the finest there
// are.
inline float smallest_cell(float feature_size, float finest_cell) {
  return std::max(0.5f * feature_size, finest_cell);
}

struct RefineOptions {
  // A link of irradiance error e on a receiver of area A is accepted when
  // e * sqrt(A / scene area) <= tolerance * irradiance_threshold (W/m2), with the receiver's own
  // tolerance: independent errors add in the square, weighted by the area they fall on, so this
  // equalises what links add to the RMS error.
  float irradiance_threshold = 0.f;
  // s of each element: the smallest shadow that counts there, metres. Clusters are not opened
  // below it: what is inside is smaller than any shadow asked for, and receives and sends as one.
  const IdVector<ElementId, float>* feature_sizes = nullptr;
  // By what feature sizes are multiplied as long as coarse elements will do. Pairs that only this
  // keeps from being refined are links that a later call finds to fail.
  float feature_scale = 1.f;
  // Cells are not split below half their feature size, nor below this (smallest_cell).
  float finest_cell = 0.f;
  // Cells larger than this many of the smallest ones are split whatever their samples say, as
  // samples can miss a shadow.
  float largest_blind_cell = kInfinity;

  // Only the shape of the elements is wanted: pairs are judged, cells are split, no link is made.
  bool shape_only = false;
  // Inside clusters that exchange light as one; null: not known.
  const ClusterVisibility* inside = nullptr;
  std::size_t most_links = 40'000'000;  // beyond it pairs are accepted as they are, and counted
  std::size_t most_elements = std::numeric_limits<std::size_t>::max();  // the same
};

struct RefineCounts {
  std::uint64_t pairs = 0;           // visited
  std::uint64_t accepted_early = 0;  // because a limit was reached
};

struct ElementPair {
  ElementId receiver, source;
};

// Told when cells were split, so that per-element data can follow: old and new element count.
using SplitListener = std::function<void(const std::vector<ElementId>& split_cells)>;

// Processes pairs until none is left and appends the links in a fixed order. Pairs whose source is
// dark are kept as unsampled links. Deterministic for any thread count.
void refine(ElementTree& tree, const Visibility& visibility,
            const IdVector<ElementId, Rgb>& radiosity, const IdVector<ElementId, float>& opacity,
            const IdVector<ElementId, float>& tolerance, std::vector<ElementPair> pairs,
            const RefineOptions& options, const SplitListener& on_split, const Progress& progress,
            std::vector<ReceiverLink>& links, RefineCounts& counts);

// Error of a link in irradiance at its receiver, in the units of irradiance_threshold.
float weighted_error(const ElementTree& tree, const ClusterVisibility* inside, ElementId receiver,
                     const Link& link, const IdVector<ElementId, Rgb>& radiosity);

}  // namespace halflight
