// Reads a scene file: OBJ/MTL, glTF 2.0 or GLB, told apart by its name.
#pragma once

#include <filesystem>

#include "halflight/base/result.h"
#include "halflight/io/read_file.h"
#include "halflight/scene/scene.h"

namespace halflight {

enum class UpAxis { y, z };

struct LoadOptions {
  double metres_per_unit = 1.0;  // OBJ has no unit
  UpAxis up = UpAxis::y;         // OBJ has no up axis
};

// Bad input returns an Error that names the file, the place in it and the remedy; what could be
// tolerated is in Scene::warnings.
Result<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options = {});

// The same of a file that was read already. What it refers to is looked for beside `path`.
Result<Scene> parse_scene(Bytes file, const std::filesystem::path& path,
                          const LoadOptions& options = {});

}  // namespace halflight
