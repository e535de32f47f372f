// halflight compare: how far a picture is from its reference, judged by feature size.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command_files.h"
#include "commands.h"
#include "compare_output.h"
#include "halflight/base/parallel.h"
#include "halflight/features/feature_mask.h"
#include "halflight/features/shadow_estimate.h"
#include "halflight/io/image_read.h"
#include "halflight/io/image_write.h"
#include "number_checks.h"

namespace halflight::app {
namespace {

constexpr std::size_t kMostListed = 1'000'000'000;  // features

struct Arguments {
  CompareInput input;
  CompareOptions options;
  std::vector<std::string> parts;  // X,Y,W,H
  CompareFiles files;
  bool four_neighbours = false;
  bool json = false;
};

Result<void> check_finite(const Image& image, const std::filesystem::path& path) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Rgb& c = image.at(x, y);
      if (!std::isfinite(c.r + c.g + c.b))
        return input_error(fmt::format("pixel ({}, {}) is not a finite number", x, y),
                           path.string(), "render the picture again or repair the pixel");
    }
  return {};
}

Result<void> check_size(const Image& image, const std::filesystem::path& path,
                        const Image& reference, const std::filesystem::path& reference_path) {
  if (image.width == reference.width && image.height == reference.height) return {};
  return input_error(
      fmt::format("the picture is {} x {} pixels, but {} is {} x {}", image.width, image.height,
                  reference_path.string(), reference.width, reference.height),
      path.string(), "compare pictures of the same size");
}

struct Pictures {
  Image reference, test;
  BinaryImage shadow;
};

// Decoding takes most of the time of a comparison: all files at once.
Result<Pictures> read_pictures(const CompareInput& input) {
  std::array<Result<Image>, 3> images;
  parallel_for(input.visibility_mask.empty() ? 2 : 3, 1, [&](std::size_t i) {
    const std::array paths{&input.reference, &input.test, &input.visibility_mask};
    images[i] = read_float_image(*paths[i], i < 2 ? PngValues::linear : PngValues::as_stored);
    if (!images[i] || i == 2) return;
    if (auto finite = check_finite(*images[i], *paths[i]); !finite)
      images[i] = tl::unexpected(finite.error());
  });
  for (const auto& image : images)
    if (!image) return tl::unexpected(image.error());
  const Image& reference = *images[0];
  if (auto same = check_size(*images[1], input.test, reference, input.reference); !same)
    return tl::unexpected(same.error());
  if (input.visibility_mask.empty()) {
    BinaryImage shadow = estimate_shadow(reference);
    return Pictures{std::move(*images[0]), std::move(*images[1]), std::move(shadow)};
  }
  if (auto same = check_size(*images[2], input.visibility_mask, reference, input.reference); !same)
    return tl::unexpected(same.error());
  std::vector<float> visibility(images[2]->pixels.size());
  parallel_for(visibility.size(), 1 << 14,
               [&](std::size_t i) { visibility[i] = min_component(images[2]->pixels[i]); });
  BinaryImage shadow = shadow_of(visibility, reference.width, reference.height);
  return Pictures{std::move(*images[0]), std::move(*images[1]), std::move(shadow)};
}

Result<Rectangle> parse_part(const std::string& text, const Image& picture) {
  Rectangle r;
  int used = 0;
  const bool read = std::sscanf(text.c_str(), "%d,%d,%d,%d%n", &r.left, &r.top, &r.width, &r.height,
                                &used) == 4 &&
                    static_cast<std::size_t>(used) == text.size();
  const bool inside = read && r.left >= 0 && r.top >= 0 && r.width > 0 && r.height > 0 &&
                      r.left <= picture.width - r.width && r.top <= picture.height - r.height;
  if (inside) return r;
  return input_error(
      "'" + text + "' is no part of the picture", "--part",
      fmt::format("give X,Y,WIDTH,HEIGHT in pixels within {} x {}", picture.width, picture.height));
}

Result<void> check_files(const Arguments& arguments) {
  const CompareFiles& outputs = arguments.files;
  for (const auto* path : {&outputs.mask, &outputs.difference, &outputs.false_colour})
    if (!path->empty())
      if (auto known = check_image_name(*path); !known) return known;
  CommandFiles files;
  files.reads("the reference", arguments.input.reference);
  files.reads("the picture to judge", arguments.input.test);
  files.reads("the visibility mask", arguments.input.visibility_mask);
  files.writes("--difference", outputs.difference);
  const auto& sizes = arguments.options.feature_sizes;
  for (const auto& path : names_for(outputs.mask, sizes)) files.writes("--mask", path);
  for (const auto& path : names_for(outputs.false_colour, sizes))
    files.writes("--false-colour", path);
  return check(files);
}

Result<void> run(Arguments& arguments) {
  if (auto ok = check_files(arguments); !ok) return ok;
  auto pictures = read_pictures(arguments.input);
  if (!pictures) return tl::unexpected(pictures.error());
  for (const std::string& text : arguments.parts) {
    const auto part = parse_part(text, pictures->reference);
    if (!part) return tl::unexpected(part.error());
    arguments.options.parts.push_back(*part);
  }
  if (arguments.four_neighbours) arguments.options.connectivity = Connectivity::four;
  arguments.options.keep_maps = arguments.files.any();
  if (arguments.input.visibility_mask.empty() && !arguments.options.feature_sizes.empty())
    fmt::print(stderr,
               "halflight: no --visibility-mask: shadows are estimated from the brightness of "
               "{}, which also takes dark paint for shadow\n",
               arguments.input.reference.string());
  const Comparison result =
      compare(pictures->reference, pictures->test, pictures->shadow, arguments.options);
  Result<void> written =
      write_pictures(arguments.files, pictures->reference, pictures->test, result);
  const std::string text =
      arguments.json ? json_of(arguments.input, pictures->reference, arguments.options, result)
                     : text_of(arguments.options, result);
  std::fputs(text.c_str(), stdout);
  return written;
}

}  // namespace

void add_compare(CLI::App& cli, int& status) {
  auto* command =
      cli.add_subcommand("compare", "Judge a picture against its reference by feature size");
  const auto a = std::make_shared<Arguments>();
  command->add_option("REF", a->input.reference, "Reference picture, PNG or EXR")->required();
  command->add_option("TEST", a->input.test, "Picture to judge, of the same size")->required();
  CLI::Option* feature_size = command
                                  ->add_option("--feature-size", a->options.feature_sizes,
                                               "Feature size s in pixels; may repeat for a curve")
                                  ->check(from_to(0.0, 1e6).description("0 to 1e6"))
                                  ->allow_extra_args(false);
  command
      ->add_option("--visibility-mask", a->input.visibility_mask,
                   "Share of the light that each pixel of REF sees; white sees all of it. "
                   "Default: estimated from REF")
      ->check(file_name());
  command->add_option("--exponent", a->options.p, "Exponent p of the norm")
      ->check(from_to(1.0, 64.0).description("1 to 64"));
  command->add_flag("--four-neighbours", a->four_neighbours,
                    "Erode and expand with 4 neighbours instead of 8");
  command->add_option("--part", a->parts, "Values of X,Y,WIDTH,HEIGHT alone; may repeat")
      ->allow_extra_args(false);
  command
      ->add_option("--worst", a->options.worst_regions,
                   "List so many features with the largest error")
      ->check(from_to(std::size_t{0}, kMostListed))
      ->needs(feature_size);
  command->add_option("--mask", a->files.mask, "Write the feature mask; black is inside")
      ->check(file_name());
  command
      ->add_option("--difference", a->files.difference,
                   "Write TEST - REF; PNG: grey is 0, white and black are the largest difference")
      ->check(file_name());
  command
      ->add_option("--false-colour", a->files.false_colour,
                   "Write the error of every pixel as colours")
      ->check(file_name());
  command->add_flag("--json", a->json, "Print JSON");
  command->callback([a, &status] {
    const Result<void> done = run(*a);
    status = done ? kGoalMet : fail(done.error());
  });
}

}  // namespace halflight::app
