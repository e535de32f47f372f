// The radiosity solver as a value: make_state, then advance pass by pass; every state in between is
// a valid result. Hierarchical radiosity with clustering (paper sections 1 and 6; Sillion 1995).
#pragma once

#include <memory>
#include <vector>

#include "halflight/base/progress.h"
#include "halflight/hierarchy/build_hierarchy.h"
#include "halflight/hierarchy/elements.h"
#include "halflight/rays/world.h"
#include "halflight/transport/link.h"
#include "halflight/transport/refine.h"
#include "halflight/visibility/visibility.h"

namespace halflight {

enum class LinkMaker {
  refined,  // the paper's: from the root's self-link, refined by an error oracle
  sampled,  // refined ones shape the elements, then rays from every receiver take their place
};

struct SolveOptions {
  // s, metres: smallest shadow kept exact. Negative: scene diagonal / 200. 0: all shadows are
  // exact, and only the error decides how fine elements get.
  float feature_size = -1.f;
  // Multires gives way to exact rays where a pilot says that clusters would save nothing; the
  // state's visibility tells what is used.
  VisibilityMode visibility = VisibilityMode::multires;
  bool visibility_pilot = true;
  float error = 0.05f;  // aimed-at relative RMS error of irradiance
  LinkMaker links = LinkMaker::sampled;
  HierarchyKind hierarchy = HierarchyKind::size_grid;  // who groups surfaces into clusters
  int passes = 3;                                      // settings of the threshold, coarse to fine
  std::size_t most_links = 40'000'000;
};

// What one pass did (the report's history).
struct PassRecord {
  float irradiance_threshold = 0.f;
  std::size_t links = 0;
  std::size_t elements = 0;
  std::uint64_t pairs = 0;
  std::uint64_t rays = 0;
  int sweeps = 0;
  double refine_seconds = 0.0;
  double sweep_seconds = 0.0;
};

struct SolverState {
  std::shared_ptr<const World> world;
  std::shared_ptr<const Surfaces> surfaces;
  std::shared_ptr<const Visibility> visibility{};
  ElementTree tree;
  SolveOptions options;  // resolved: no zeros that stand for defaults

  IdVector<ElementId, float> opacity{};    // of cells: share of the light that they stop
  IdVector<ElementId, Rgb> reflectance{};  // of cells, of all light that falls on them
  IdVector<ElementId, Rgb> exitance{};     // pi L of cells, times their opacity
  // Irradiance of leaf cells that links do not carry: by punctual lights and the sky, and with
  // sampled links by emitting surfaces too.
  IdVector<ElementId, Rgb> given_light{};
  IdVector<ElementId, std::uint8_t> given_light_known{};
  IdVector<ElementId, Rgb> outer_light{};  // its part by punctual lights and the sky; empty: none
  bool emission_is_given = false;          // links carry reflected light only
  IdVector<ElementId, Rgb> irradiance{};   // E of cells, from all links above and at them
  // By what the threshold on errors is multiplied where an element receives: 1, less in the dark.
  IdVector<ElementId, float> tolerance{};
  IdVector<ElementId, Rgb> radiosity{};  // B = rho E + pi L, mean over the element's area
  LinkTable links{};
  std::vector<PassRecord> history{};

  bool done() const { return static_cast<int>(history.size()) >= options.passes; }
};

SolverState make_state(const std::shared_ptr<const World>& world, const SolveOptions& options);

// Runs one pass: refine the links at the present radiosities, then sweep to convergence.
void advance(SolverState& state, const Progress& progress);

// Power in W (or lumens) over all cells.
struct EnergyBalance {
  Rgb emitted{0.f};  // by surfaces, plus what punctual lights and the sky bring in
  Rgb absorbed{0.f};
  Rgb escaped{0.f};  // emitted - absorbed: left through openings, or lost by error
};
EnergyBalance energy_balance(const SolverState& state);

// Area-weighted mean irradiance over all cells that receive light.
float mean_irradiance(const SolverState& state);

}  // namespace halflight
