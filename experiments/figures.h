// The experiments, one file each.
#pragma once

#include "experiments/experiment.h"

namespace halflight::experiments {

Result<Section> run_figure1(const Progress& progress);
Result<Section> run_figure2(const Progress& progress);
Result<Section> run_figure3(const Progress& progress);
Result<Section> run_figure4(const Progress& progress);
Result<Section> run_figure7(const Progress& progress);
Result<Section> run_figure8(const Progress& progress);
Result<Section> run_figure9(const Progress& progress);
Result<Section> run_figure10(const Progress& progress);
Result<Section> run_clutter(const Progress& progress);
Result<Section> run_multigrid_section(const Progress& progress);
Result<Section> run_table1(const Progress& progress);

}  // namespace halflight::experiments
