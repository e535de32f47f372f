#include "compare_output.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "halflight/io/image_write.h"
#include "halflight/output/false_colour.h"

namespace halflight::app {
namespace {

using Json = nlohmann::ordered_json;

std::filesystem::path name_with(const std::filesystem::path& path, double feature_size) {
  return path.parent_path() /
         fmt::format("{}-{:g}{}", path.stem().string(), feature_size, path.extension().string());
}

std::filesystem::path name_for(const std::filesystem::path& path, const Comparison& result,
                               const ErrorAtSize& at) {
  return result.at_sizes.size() <= 1 ? path : name_with(path, at.feature_size);
}

Image mask_image(const BinaryImage& mask) {
  Image image(mask.width(), mask.height(), Rgb(1.f));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (mask.at(x, y)) image.at(x, y) = Rgb(0.f);
  return image;
}

// EXR holds the difference itself; PNG maps [-largest, largest] to the stored levels 0 to 255.
Image difference_image(const std::filesystem::path& path, const Image& reference,
                       const Image& test) {
  Image image = difference(reference, test);
  if (path.extension() == ".exr") return image;
  float largest = 0.f;
  for (const Rgb& c : image.pixels) largest = std::max(largest, max_component(glm::abs(c)));
  for (Rgb& c : image.pixels)
    for (int k = 0; k < 3; ++k)
      c[k] = linear_from_srgb(0.5f + (largest > 0.f ? 0.5f * c[k] / largest : 0.f));
  return image;
}

Result<void> write_false_colour(const std::filesystem::path& path, const std::vector<float>& local,
                                const Image& reference) {
  const float largest = local.empty() ? 0.f : *std::max_element(local.begin(), local.end());
  fmt::print(stderr, "{}: dark blue is 0, yellow is {:g}\n", path.string(), largest);
  return write_image(path, false_colour_image(local, reference.width, reference.height,
                                              largest > 0.f ? largest : 1.f));
}

Json error_json(const ErrorAtSize& at) {
  Json json{{"feature_size", at.feature_size},
            {"value", at.shadows.value},
            {"features", at.shadows.features},
            {"averages", at.shadows.averages},
            {"mask_share", at.shadows.mask_share},
            {"symmetric", at.symmetric.value},
            {"symmetric_mask_share", at.symmetric.mask_share}};
  if (!at.parts.empty()) json["parts"] = at.parts;
  for (const RegionError& r : at.regions)
    json["regions"].push_back({{"left", r.region.left},
                               {"top", r.region.top},
                               {"width", r.region.width},
                               {"height", r.region.height},
                               {"pixels", r.region.pixels},
                               {"value", r.value}});
  return json;
}

}  // namespace

std::vector<std::filesystem::path> names_for(const std::filesystem::path& path,
                                             const std::vector<double>& feature_sizes) {
  if (path.empty()) return {};
  if (feature_sizes.size() <= 1) return {path};
  std::vector<double> sizes = feature_sizes;
  std::sort(sizes.begin(), sizes.end());
  sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
  std::vector<std::filesystem::path> names;
  for (const double size : sizes) names.push_back(name_with(path, size));
  return names;
}

Result<void> write_pictures(const CompareFiles& files, const Image& reference, const Image& test,
                            const Comparison& result) {
  Result<void> written;
  if (!files.difference.empty())
    also(written,
         write_image(files.difference, difference_image(files.difference, reference, test)));
  for (const ErrorAtSize& at : result.at_sizes) {
    if (!files.mask.empty())
      also(written, write_image(name_for(files.mask, result, at), mask_image(at.mask)));
    if (!files.false_colour.empty())
      also(written,
           write_false_colour(name_for(files.false_colour, result, at), at.local, reference));
  }
  if (!files.false_colour.empty() && result.at_sizes.empty())
    also(written, write_false_colour(files.false_colour,
                                     local_error(difference(reference, test), 2), reference));
  return written;
}

std::string json_of(const CompareInput& input, const Image& reference,
                    const CompareOptions& options, const Comparison& result) {
  const bool recorded = !input.visibility_mask.empty();
  Json json{{"reference", input.reference.string()},
            {"test", input.test.string()},
            {"width", reference.width},
            {"height", reference.height},
            {"shadow", recorded ? input.visibility_mask.string() : "estimated from the reference"},
            {"exponent", options.p},
            {"l1", result.l1},
            {"l2", result.l2},
            {"lp", result.lp},
            {"fbem", Json::array()}};
  for (const ErrorAtSize& at : result.at_sizes) json["fbem"].push_back(error_json(at));
  for (std::size_t i = 0; i < options.parts.size(); ++i) {
    const Rectangle& r = options.parts[i];
    json["parts"].push_back({{"left", r.left},
                             {"top", r.top},
                             {"width", r.width},
                             {"height", r.height},
                             {"l1", result.parts[i].l1},
                             {"l2", result.parts[i].l2}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string text_of(const CompareOptions& options, const Comparison& result) {
  std::string text = fmt::format("L1 {:.6g}   L2 {:.6g}", result.l1, result.l2);
  if (options.p != 1 && options.p != 2)
    text += fmt::format("   L{:g} {:.6g}", options.p, result.lp);
  text += "\n";
  if (!result.at_sizes.empty())
    text += fmt::format("{:>12} {:>12} {:>12} {:>12} {:>8} {:>12}\n", "feature size", "FBEM",
                        "in features", "in averages", "mask", "symmetric");
  for (const ErrorAtSize& at : result.at_sizes) {
    const FeatureError& e = at.shadows;
    text +=
        fmt::format("{:>12g} {:>12.6g} {:>12.6g} {:>12.6g} {:>7.1f}% {:>12.6g}\n", at.feature_size,
                    e.value, e.features, e.averages, 100 * e.mask_share, at.symmetric.value);
    for (const RegionError& r : at.regions)
      text +=
          fmt::format("{:>12} feature of {} px at ({}, {}), {} x {}: {:.6g}\n", "", r.region.pixels,
                      r.region.left, r.region.top, r.region.width, r.region.height, r.value);
  }
  for (std::size_t i = 0; i < options.parts.size(); ++i) {
    const Rectangle& r = options.parts[i];
    text += fmt::format("part {},{},{},{}: L1 {:.6g}   L2 {:.6g}", r.left, r.top, r.width, r.height,
                        result.parts[i].l1, result.parts[i].l2);
    for (const ErrorAtSize& at : result.at_sizes)
      text += fmt::format("   FBEM({:g}) {:.6g}", at.feature_size, at.parts[i]);
    text += "\n";
  }
  return text;
}

}  // namespace halflight::app
