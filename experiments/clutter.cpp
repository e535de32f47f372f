#include "experiments/clutter.h"

#include <fmt/format.h>

#include "experiments/figures.h"
#include "halflight/features/error_metric.h"
#include "halflight/features/feature_mask.h"
#include "halflight/output/false_colour.h"
#include "halflight/scene/procedural/office.h"

namespace halflight::experiments {
namespace {

constexpr int kCount = 600;   // small things: 61,000 triangles
constexpr int kPixels = 240;  // 3 cm each
constexpr float kError = 0.05f;
constexpr float kFromHeight = 0.8f;  // of the room's: below the lamps
constexpr std::uint32_t kMaskSamples = 32;
constexpr float kWhite = 1.6f;       // times the mean irradiance
constexpr float kErrorScale = 0.3f;  // of the mean irradiance: yellow

// The paper's method as it stands: clusters are media wherever the criterion lets them, whether or
// not that pays, and links come from the oracle alone.
SolveOptions options_of(float feature_size, float error) {
  SolveOptions options;
  options.error = error;
  options.links = LinkMaker::refined;
  options.visibility = VisibilityMode::multires;
  options.visibility_pilot = false;
  options.feature_size = feature_size;
  return options;
}

Image shown(const Image& irradiance, double mean) {
  Image picture = irradiance;
  for (Rgb& p : picture.pixels)
    p = glm::clamp(p / (kWhite * static_cast<float>(mean)), Rgb(0.f), Rgb(1.f));
  return picture;
}

Image shown_mask(const BinaryImage& mask) {
  Image picture(mask.width(), mask.height(), Rgb(1.f));
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x)
      if (mask.at(x, y)) picture.at(x, y) = Rgb(0.f);
  return picture;
}

std::string name_of(const ClutterStudy& study, std::size_t i) {
  if (i == 0) return "reference";
  return fmt::format("s = {:g} % ({:.0f} cm)", 100.0 * kClutterShares[i - 1],
                     100.f * study.solutions[i].feature_size);
}

void show_view(const ClutterStudy& study, std::size_t v, Section& section) {
  const FlatView& view = study.views[v];
  const Image& reference = study.solutions.front().pictures[v];
  const double mean = mean_of(reference);
  PictureRow lit{fmt::format("The {}: irradiance", view.name), {}};
  PictureRow errors{fmt::format("The {}: difference from the reference, from 0 (dark blue) to "
                                "{:g} % of the mean irradiance (yellow)",
                                view.name, 100.f * kErrorScale),
                    {}};
  PictureRow masks{fmt::format("The {}: shadows, and those wider than s", view.name), {}};
  masks.pictures.push_back(
      {fmt::format("clutter-{}-shadow", view.name), shown_mask(study.shadows[v]), "all shadows"});
  for (std::size_t i = 0; i < study.solutions.size(); ++i) {
    const StudySolution& s = study.solutions[i];
    lit.pictures.push_back({fmt::format("clutter-{}-{}", view.name, i), shown(s.pictures[v], mean),
                            name_of(study, i)});
    if (i == 0) continue;
    const std::vector<float> error = local_error(difference(reference, s.pictures[v]), 2);
    errors.pictures.push_back(
        {fmt::format("clutter-{}-error-{}", view.name, i),
         false_colour_image(error, view.width, view.height, kErrorScale * static_cast<float>(mean)),
         name_of(study, i)});
    const double pixels = static_cast<double>(s.feature_size / view.pixel);
    masks.pictures.push_back({fmt::format("clutter-{}-mask-{}", view.name, i),
                              shown_mask(feature_mask(study.shadows[v], pixels)),
                              name_of(study, i)});
  }
  section.blocks.insert(section.blocks.end(), {lit, errors, masks});
}

std::string percent(double share) { return fmt::format("{:.2f} %", 100.0 * share); }

}  // namespace

ClutterStudy study_clutter(int count, int pixels, float error, const Progress& progress) {
  const auto world = make_world(office_scene({.count = count}));
  const PathTracer tracer(*world);
  ClutterStudy study;
  study.triangles = world->geometry.triangles.size();
  study.diagonal = world->geometry.bounds.diagonal();
  study.views = {view_of_floor(*world, kFromHeight, pixels), view_of_wall(*world, pixels)};
  for (const FlatView& view : study.views)
    study.shadows.push_back(shadow_in(view, tracer, kMaskSamples));
  for (std::size_t i = 0; i <= kClutterShares.size() && !progress.cancelled(); ++i) {
    const double share = i == 0 ? 0.0 : kClutterShares[i - 1];
    progress.report("clutter", static_cast<double>(i) / (1.0 + kClutterShares.size()));
    study.solutions.push_back(
        solve_and_look(world, options_of(static_cast<float>(share) * study.diagonal, error),
                       study.views, kMeshReading, Progress()));
    const StudySolution& s = study.solutions.back();
    std::vector<StudyError>& errors = study.errors.emplace_back();
    for (std::size_t v = 0; v < study.views.size(); ++v)
      errors.push_back(judge(study.views[v], study.solutions.front().pictures[v], s.pictures[v],
                             study.shadows[v], s.feature_size));
  }
  return study;
}

Result<Section> run_clutter(const Progress& progress) {
  const ClutterStudy study = study_clutter(kCount, kPixels, kError, progress);
  if (progress.cancelled()) return system_error("interrupted", "clutter");
  Section section{"clutter", "A cluttered office: cost and error by feature size", {}, {}};
  Table costs{"Cost of solving, and of reading the pictures",
              {"feature size", "time, s", "rays", "links", "elements", "pictures, s"},
              {}};
  Table norms{"L2 and FBEM (with the same feature size), as shares of the mean irradiance",
              {"feature size"},
              {}};
  for (const FlatView& view : study.views)
    for (const char* column : {"L2", "FBEM", "features' area"})
      norms.head.push_back(view.name + ": " + column);
  for (std::size_t i = 0; i < study.solutions.size(); ++i) {
    const StudySolution& s = study.solutions[i];
    costs.rows.push_back({name_of(study, i), fmt::format("{:.2f}", s.cost.seconds),
                          fmt::format("{}", s.cost.rays), fmt::format("{}", s.cost.links),
                          fmt::format("{}", s.cost.elements),
                          fmt::format("{:.2f}", s.cost.reading_seconds)});
    nlohmann::ordered_json number{{"feature_size", s.feature_size},
                                  {"seconds", s.cost.seconds},
                                  {"rays", s.cost.rays},
                                  {"links", s.cost.links},
                                  {"elements", s.cost.elements},
                                  {"picture_seconds", s.cost.reading_seconds}};
    if (i > 0) {
      norms.rows.push_back({name_of(study, i)});
      for (std::size_t v = 0; v < study.views.size(); ++v) {
        const StudyError& e = study.errors[i][v];
        for (const double share : {e.l2, e.fbem, e.mask_share})
          norms.rows.back().push_back(percent(share));
        number[study.views[v].name] = {
            {"l2", e.l2}, {"fbem", e.fbem}, {"mask_share", e.mask_share}};
      }
    }
    section.numbers.push_back(number);
  }
  section.blocks = {
      fmt::format(
          "An office of {} triangles, solved whole. The reference keeps every shadow exact "
          "(s = 0); the others take clusters as media where their umbra is below s, split no "
          "cell below s / 2 and link clusters up to s as one. Feature sizes are shares of "
          "the room's diagonal of {:.1f} m.",
          study.triangles, study.diagonal),
      costs, norms};
  for (std::size_t v = 0; v < study.views.size(); ++v) show_view(study, v, section);
  return section;
}

}  // namespace halflight::experiments
