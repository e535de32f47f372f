#include "halflight/io/load_scene.h"

#include <algorithm>
#include <new>

#include "halflight/base/one_line.h"
#include "halflight/io/placed_scene.h"
#include "halflight/io/read_failure.h"
#include "halflight/io/read_gltf.h"
#include "halflight/io/read_obj.h"
#include "halflight/scene/order_in_space.h"

namespace halflight {
namespace {

// Of the file at `path`: its ending tells what it is.
using SceneReader = Scene (*)(Bytes, const std::filesystem::path&);

SceneReader reader_of(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  if (extension == ".obj") return read_obj;
  if (extension == ".gltf" || extension == ".glb") return read_gltf;
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

// `file_of` gives the bytes, or throws.
template <class FileOf>
Result<Scene> read_scene(const FileOf& file_of, const std::filesystem::path& path,
                         const LoadOptions& options) {
  if (!(options.metres_per_unit > 0.0) || !std::isfinite(options.metres_per_unit))
    return input_error("the unit is not a positive length", path.string(),
                       "use m, cm, mm, in or ft");
  try {
    const SceneReader read = reader_of(path);
    Scene scene = read(file_of(), path);
    scene.to_world = to_world(options);
    check_placed_size(scene, path.string());
    order_in_space(scene);
    return scene;
  } catch (const ReadFailure& failure) {
    return tl::unexpected(failure.error);
  } catch (const std::bad_alloc&) {
    return system_error("there is not enough memory to read the scene", path.string(),
                        "use a smaller scene or a larger machine");
  }
}

}  // namespace

Result<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options) {
  return read_scene([&] { return value_or_fail(read_file(path)); }, path, options);
}

Result<Scene> parse_scene(Bytes file, const std::filesystem::path& path,
                          const LoadOptions& options) {
  return read_scene([&] { return std::move(file); }, path, options);
}

}  // namespace halflight
