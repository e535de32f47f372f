#include "halflight/io/load_scene.h"

#include <algorithm>
#include <cctype>
#include <new>

#include "halflight/io/placed_scene.h"
#include "halflight/io/read_failure.h"
#include "halflight/io/read_gltf.h"
#include "halflight/io/read_obj.h"

namespace halflight {
namespace {

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

Scene read(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  if (extension == ".obj") return read_obj(path);
  if (extension == ".gltf" || extension == ".glb") return read_gltf(path);
  fail_reading("'" + extension + "' is not a scene format that can be read", path.string(),
               "convert it to .glb, .gltf or .obj");
}

// z up: (x, y, z) becomes (x, z, -y), a quarter turn about X.
Mat4 to_world(const LoadOptions& options) {
  const double s = options.metres_per_unit;
  Mat4 m(s);
  if (options.up == UpAxis::z) {
    m[1] = {0.0, 0.0, -s, 0.0};
    m[2] = {0.0, s, 0.0, 0.0};
  }
  m[3][3] = 1.0;
  return m;
}

}  // namespace

Result<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options) {
  if (!(options.metres_per_unit > 0.0) || !std::isfinite(options.metres_per_unit))
    return input_error("the unit is not a positive length", path.string(),
                       "use m, cm, mm, in or ft");
  try {
    Scene scene = read(path);
    scene.to_world = to_world(options);
    check_placed_size(scene, path.string());
    return scene;
  } catch (const ReadFailure& failure) {
    return tl::unexpected(failure.error);
  } catch (const std::bad_alloc&) {
    return system_error("there is not enough memory to read the scene", path.string(),
                        "use a smaller scene or a larger machine");
  }
}

}  // namespace halflight
