// Figure 1: four groups of cubes, their coarse solutions, and L2 errors that hardly differ.
#include <fmt/format.h>

#include "experiments/cube_wall.h"
#include "experiments/figures.h"
#include "halflight/features/compare.h"
#include "halflight/features/visibility_error.h"
#include "halflight/output/false_colour.h"

namespace halflight::experiments {
namespace {

constexpr int kSeed = 1;
constexpr int kCell = 25;            // pixels: the mesh of the coarse solutions
constexpr float kErrorScale = 30.f;  // grey levels: yellow in the error pictures

struct Rows {
  PictureRow references{"Reference images: illumination of the wall", {}};
  PictureRow coarse{"Approximate images on a coarse mesh", {}};
  PictureRow errors{
      fmt::format("Error of every pixel, from 0 (dark blue) to {:g} (yellow)", kErrorScale), {}};
  Table norms{"Norms per area, in grey levels (the lit wall has 40 in its middle)",
              {"group", "shadow size, px", "mean visibility", "L1", "L2",
               "L1 of averaging a point light over the whole wall, 2 v (1 - v)",
               "L2 of the same, sqrt(v (1 - v))"},
              {}};
};

void add_group(int group, Rows& rows, nlohmann::ordered_json& numbers) {
  const CubeWall wall = light_cube_wall(group, kSeed);
  const Image coarse = averaged_over_cells(wall.reference, kCell);
  const Comparison c = compare(wall.reference, coarse, wall.shadow, {});
  const double size = kShadowSizes[static_cast<std::size_t>(group - 1)];
  const double v = mean_of(wall.visibility);
  const std::string caption = fmt::format("group {}, shadows of {:g} px", group, size);
  const auto errors = local_error(difference(wall.reference, coarse), 2);
  rows.references.pictures.push_back(
      {fmt::format("figure1-reference-{}", group), grey_picture(wall.reference), caption});
  rows.coarse.pictures.push_back(
      {fmt::format("figure1-coarse-{}", group), grey_picture(coarse), caption});
  rows.errors.pictures.push_back({fmt::format("figure1-error-{}", group),
                                  false_colour_image(errors, kWallPixels, kWallPixels, kErrorScale),
                                  fmt::format("L2 = {:.2f}", c.l2)});
  rows.norms.rows.push_back({fmt::format("{}", group), fmt::format("{:g}", size),
                             fmt::format("{:.3f}", v), fmt::format("{:.2f}", c.l1),
                             fmt::format("{:.2f}", c.l2),
                             fmt::format("{:.2f}", kFullLight * averaging_error_l1(v)),
                             fmt::format("{:.2f}", kFullLight * averaging_error_l2(v))});
  numbers.push_back({{"group", group},
                     {"shadow_size", size},
                     {"mean_visibility", v},
                     {"l1", c.l1},
                     {"l2", c.l2}});
}

}  // namespace

Result<Section> run_figure1(const Progress& progress) {
  Rows rows;
  Section section{"figure1", "Figure 1: plain norms do not see the size of what is lost", {}, {}};
  for (int group = 1; group <= kGroups; ++group) {
    if (progress.cancelled()) return system_error("interrupted", "figure1");
    progress.report("figure1", static_cast<double>(group - 1) / kGroups);
    add_group(group, rows, section.numbers);
  }
  section.blocks = {
      fmt::format(
          "Four groups of cubes, each of one size, before a wall and a small light. The coarse "
          "solutions hold one mean value for each cell of {} x {} pixels. Their norms are alike "
          "although the shadows that they hide are not; appendix A shows why: the norm of an "
          "average depends on the mean visibility v alone.",
          kCell, kCell),
      rows.references, rows.coarse, rows.errors, rows.norms};
  return section;
}

}  // namespace halflight::experiments
