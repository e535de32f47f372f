// Camera files: JSON with the keys position, forward (or target), up and fov_y_deg, on their own or
// in an object "camera"; width and height propose the size of the picture.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "halflight/base/result.h"
#include "halflight/scene/geometry.h"

namespace halflight {

struct View {
  PlacedCamera camera;  // world
  int width = 0;        // pixels; 0: not said
  int height = 0;
};

// Coordinates in the file are those of the scene file; `to_world` is Scene::to_world.
Result<View> read_camera_file(const std::filesystem::path& path, const Mat4& to_world);
// `where` names the text in messages.
Result<View> parse_camera(std::string_view text, const Mat4& to_world, const std::string& where);

}  // namespace halflight
