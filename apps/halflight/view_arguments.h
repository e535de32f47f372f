// The arguments that every sub-command which makes a picture shares.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include <CLI/App.hpp>

#include "command_files.h"
#include "halflight/base/image.h"
#include "halflight/base/result.h"
#include "halflight/io/camera_file.h"
#include "halflight/output/tone_map.h"

namespace halflight::app {

struct ViewArguments {
  std::string camera = "auto";
  std::string size;               // WxH; empty: what the camera proposes
  std::string exposure = "auto";  // EV
  ToneMap tone_map = ToneMap::agx;
  std::filesystem::path output;
};

// `arguments` must live until the command has run.
void add_view_arguments(CLI::App& command, ViewArguments& arguments);

// Complains about what can be known to be wrong before any work is done.
Result<void> check(const ViewArguments& arguments);

void add_files(CommandFiles& files, const ViewArguments& arguments);

// The camera, and the size of the picture in pixels.
Result<View> choose_view(const ViewArguments& arguments, const Scene& scene,
                         const Geometry& geometry, const std::function<PlacedCamera()>& automatic);

// PNG: exposed and tone-mapped. EXR: the radiance itself, in the scene's unit.
Result<void> write_picture(const ViewArguments& arguments, const Image& radiance);

}  // namespace halflight::app
