// The radiosity solver as a value: make_state, then advance by iterations; every state in between
// is a valid result. Hierarchical radiosity with clustering (paper sections 1 and 6; Sillion 1995),
// in iterations as short as the budget asks (paper section 6.2, progressive multi-gridding).
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "halflight/base/progress.h"
#include "halflight/hierarchy/build_hierarchy.h"
#include "halflight/hierarchy/elements.h"
#include "halflight/rays/world.h"
#include "halflight/solve/feature_sizes.h"
#include "halflight/solve/grouped_light.h"
#include "halflight/solve/schedule.h"
#include "halflight/transport/cluster_visibility.h"
#include "halflight/transport/emitter_tree.h"
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
  std::vector<FeatureSizeRule> feature_size_rules{};  // for parts of the scene
  std::optional<PixelFeatureSize> pixels{};    // instead of feature_size, where no rule holds
  std::optional<ViewOfInterest> importance{};  // light elsewhere only counts for what it does there
  // Multires gives way to exact rays where a pilot says that clusters would save nothing; the
  // state's visibility tells what is used.
  VisibilityMode visibility = VisibilityMode::multires;
  bool visibility_pilot = true;
  float error = 0.05f;  // aimed-at relative RMS error of irradiance
  LinkMaker links = LinkMaker::sampled;
  HierarchyKind hierarchy = HierarchyKind::size_grid;  // who groups surfaces into clusters
  // Light on a cluster that receives as one goes to what is seen of it, not to all that faces it.
  bool intra_cluster = true;
  int levels = 3;  // of the threshold, coarse to fine
  std::size_t most_links = 40'000'000;
  std::size_t memory = 0;  // bytes that must do, see memory.h; 0: no limit
};

struct SolverState {
  std::shared_ptr<const World> world;
  std::shared_ptr<const Surfaces> surfaces;
  // Exact as long as `fine_parts_made` is false.
  std::shared_ptr<const Visibility> visibility{};
  std::shared_ptr<const FeatureSizes> feature_size_rules{};
  ElementTree tree;
  SolveOptions options;  // resolved: no zeros that stand for defaults
  // Inside clusters that receive and send as one; null: not asked for, or not made yet.
  std::shared_ptr<const ClusterVisibility> inside{};
  bool fine_parts_made = true;  // what only the solution that is asked for needs: these two

  IdVector<ElementId, float> feature_sizes{};  // s of each element, metres
  // Largest diameter of a cluster that receives as one: s, but none beside emitters, which light
  // what is near them too unevenly.
  IdVector<ElementId, float> receiver_sizes{};
  // Of errors at each element (importance.h); empty: all count alike.
  IdVector<ElementId, float> importance{};
  std::vector<RayHit> seen{};              // in the view that is important
  IdVector<ElementId, float> opacity{};    // of cells: share of the light that they stop
  IdVector<ElementId, Rgb> reflectance{};  // of cells, of all light that falls on them
  IdVector<ElementId, Rgb> exitance{};     // pi L of cells, times their opacity
  // 0: the light comes by refined links, which carry all of it. Else by sampled links of that
  // round, of the element or of one around it; they carry reflected light only.
  IdVector<ElementId, std::uint8_t> sampled{};
  // Irradiance of leaf cells that links do not carry: by punctual lights and the sky, and where
  // links are sampled by emitting surfaces too.
  IdVector<ElementId, Rgb> given_light{};
  // What is given to all of a cell, as a share of that given to the part that lies open, which is
  // what the cell is seen to reflect.
  IdVector<ElementId, float> given_share{};
  IdVector<ElementId, std::uint8_t> given_light_known{};
  IdVector<ElementId, Rgb> outer_light{};  // its part by punctual lights and the sky; empty: none
  IdVector<ElementId, Rgb> irradiance{};   // E of cells, from all links above and at them
  // By what the threshold on errors is multiplied where an element receives: 1, less in the dark.
  IdVector<ElementId, float> tolerance{};
  IdVector<ElementId, Rgb> radiosity{};  // B = rho E + pi L, mean over the element's area
  LinkTable links{};                     // refined
  LinkTable sampled_links{};             // take the place of the others receiver by receiver
  // By what the light of links is multiplied on leaf cells; see sweep.cpp. Empty: to be found anew.
  IdVector<ElementId, float> row_limits{};
  std::shared_ptr<const EmitterTree> emitters{};  // made when the first links are sampled

  GroupedLight grouped{};  // empty: the light is only known as a whole

  Schedule schedule{};
  CostModel costs{};
  std::vector<IterationRecord> history{};

  bool done() const { return schedule.stage == Stage::done; }
  std::size_t link_total() const { return links.size() + sampled_links.size(); }
};

// Options with defaults put in for what is left open.
SolveOptions resolved(SolveOptions options, const World& world);

enum class Beginning {
  as_asked,  // aims at the error that is asked for
  coarse,    // at first at complete coarse solutions, out of which the one asked for grows
};

SolverState make_state(const std::shared_ptr<const World>& world, const SolveOptions& options,
                       Beginning beginning = Beginning::as_asked);
// The same where it is known which sides can see light (hierarchy/live_sides.h).
SolverState make_state(const std::shared_ptr<const World>& world,
                       const std::shared_ptr<const Surfaces>& surfaces,
                       const IdVector<SideId, std::uint8_t>& live, const SolveOptions& options,
                       Beginning beginning = Beginning::as_asked);

// What one iteration may cost. Without limits an iteration goes to the next level of the threshold.
struct IterationBudget {
  double seconds = std::numeric_limits<double>::infinity();     // kept as well as can be predicted
  std::size_t links = std::numeric_limits<std::size_t>::max();  // refined or sampled: the paper's k
  bool limited() const;
};

// Runs one iteration: refine links at the present radiosities, or sample some, then sweep; until
// convergence when there is no limit. Which links are chosen depends on the number of links alone,
// so a limit in seconds gives results that depend on the machine's speed.
void advance(SolverState& state, const Progress& progress, const IterationBudget& budget = {});

// Sets out for an error smaller by a factor above 1, once done: finer elements, more rays.
void aim_finer(SolverState& state, float factor);
// The error that the links being made aim at.
float aimed_error(const SolverState& state);

// What the shortest iteration would take at least, as learnt so far.
double least_iteration_seconds(const SolverState& state);

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
