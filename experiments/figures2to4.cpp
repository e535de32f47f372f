// Figures 2 to 4: erosion, expansion, and the feature masks that they make.
#include <fmt/format.h>

#include "experiments/cube_wall.h"
#include "experiments/figures.h"
#include "halflight/features/feature_mask.h"
#include "halflight/features/morphology.h"
#include "halflight/features/widths.h"

namespace halflight::experiments {
namespace {

constexpr int kSeed = 1;
constexpr int kShownGroup = 3;                            // figures 2 and 3
constexpr std::array kSteps{0, 3, 6, 9, 12, 15};          // operations, as in the SIGGRAPH version
constexpr std::array kMaskSizes{12.0, 18.0, 24.0, 30.0};  // pixels; the first three as published

template <class Operator>
PictureRow sequence(const std::string& title, const std::string& file, const BinaryImage& image,
                    Operator operate, nlohmann::ordered_json& numbers) {
  PictureRow row{title, {}};
  for (const int n : kSteps) {
    const BinaryImage result = operate(image, n);
    row.pictures.push_back({fmt::format("{}-{:02}", file, n), mask_picture(result),
                            n == 0 ? "reference" : fmt::format("{} times", n)});
    numbers.push_back({{"times", n}, {"black_pixels", result.count()}});
  }
  return row;
}

BinaryImage shown_shadow() { return light_cube_wall(kShownGroup, kSeed).shadow; }

}  // namespace

Result<Section> run_figure2(const Progress&) {
  const BinaryImage shadow = shown_shadow();
  Section section{"figure2", "Figure 2: erosion and expansion", {}, {}};
  section.blocks = {
      fmt::format(
          "The shadows of group {} (umbra and penumbra black). Each erosion whitens the black "
          "pixels that touch white ones, with 8 neighbours; each expansion does the reverse.",
          kShownGroup),
      sequence(
          "Erosion", "figure2-erosion", shadow,
          [](const BinaryImage& image, int n) { return erode(image, n); },
          section.numbers["erosion"]),
      sequence(
          "Expansion", "figure2-expansion", shadow,
          [](const BinaryImage& image, int n) { return expand(image, n); },
          section.numbers["expansion"])};
  return section;
}

Result<Section> run_figure3(const Progress&) {
  const BinaryImage shadow = shown_shadow();
  Section section{"figure3", "Figure 3: erosions, then as many expansions", {}, {}};
  section.blocks = {
      fmt::format(
          "n erosions followed by n expansions leave the regions wider than 2 n pixels. The "
          "largest square in the reference is {} pixels wide: {} erosions empty the image.",
          largest_square(shadow), erosions_until_empty(shadow, Connectivity::eight)),
      sequence(
          "n erosions and n expansions", "figure3-opening", shadow,
          [](const BinaryImage& image, int n) { return opening(image, n); },
          section.numbers["opening"])};
  return section;
}

Result<Section> run_figure4(const Progress& progress) {
  std::vector<PictureRow> rows{{"Reference images", {}}};
  for (const double s : kMaskSizes) rows.push_back({fmt::format("Feature size {:g}", s), {}});
  Section section{"figure4", "Figure 4: feature masks of the four groups", {}, {}};
  for (int group = 1; group <= kGroups; ++group) {
    if (progress.cancelled()) return system_error("interrupted", "figure4");
    progress.report("figure4", static_cast<double>(group - 1) / kGroups);
    const CubeWall wall = light_cube_wall(group, kSeed);
    rows[0].pictures.push_back({fmt::format("figure4-reference-{}", group),
                                grey_picture(wall.reference),
                                fmt::format("group {}, shadows of {:g} px", group,
                                            kShadowSizes[static_cast<std::size_t>(group - 1)])});
    for (std::size_t i = 0; i < kMaskSizes.size(); ++i) {
      const BinaryImage mask = feature_mask(wall.shadow, kMaskSizes[i]);
      const double share =
          static_cast<double>(mask.count()) / static_cast<double>(mask.pixel_count());
      rows[i + 1].pictures.push_back({fmt::format("figure4-mask-{}-{:g}", group, kMaskSizes[i]),
                                      mask_picture(mask),
                                      fmt::format("{:.0f} % of the wall", 100 * share)});
      section.numbers.push_back(
          {{"group", group}, {"feature_size", kMaskSizes[i]}, {"mask_share", share}});
    }
  }
  section.blocks.push_back(
      std::string("Black: shadows wider than the feature size, that is what an approximation must "
                  "show exactly; "
                  "elsewhere an average will do. Neighbouring shadows that touch count as one."));
  for (PictureRow& row : rows) section.blocks.push_back(std::move(row));
  return section;
}

}  // namespace halflight::experiments
