#include <array>

#include "experiments/experiment.h"
#include "experiments/figures.h"

namespace halflight::experiments {

std::span<const Experiment> all_experiments() {
  static constexpr std::array kExperiments{
      Experiment{"figure1", "plain norms cannot tell the sizes of lost shadows apart", run_figure1},
      Experiment{"figure2", "erosion and expansion of a binary image", run_figure2},
      Experiment{"figure3", "erosions followed by as many expansions", run_figure3},
      Experiment{"figure4", "feature masks of the four groups of cubes", run_figure4},
      Experiment{"figure7", "surface visibility with each hierarchy", run_figure7},
      Experiment{"figure8", "average visibility with each hierarchy, and the shadow under desks",
                 run_figure8},
      Experiment{"figure9", "cost and error of multi-resolution visibility, by feature size",
                 run_figure9},
      Experiment{"figure10",
                 "one link onto a shelf of books, with and without visibility inside it",
                 run_figure10},
      Experiment{"clutter", "a cluttered office solved whole: cost and error, by feature size",
                 run_clutter},
      Experiment{"multigrid", "iterations of a wanted length, predicted and real",
                 run_multigrid_section},
      Experiment{"table1", "the feature-based error metric of the four groups", run_table1},
  };
  return kExperiments;
}

}  // namespace halflight::experiments
