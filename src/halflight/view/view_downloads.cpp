#include "halflight/view/view_downloads.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <unistd.h>

#include "halflight/io/image_write.h"
#include "halflight/io/read_file.h"
#include "halflight/io/write_gltf.h"
#include "halflight/output/exposure.h"
#include "halflight/output/read_light.h"
#include "halflight/output/solution_image.h"

namespace halflight {
namespace {

constexpr int kSamplesPerPixel = 4;

// A folder of its own that nobody else may look into, gone with the object.
class PrivateFolder {
 public:
  PrivateFolder() {
    std::error_code failure;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(failure);
    if (failure) return;
    std::string pattern = (folder / "halflight-XXXXXX").string();
    if (::mkdtemp(pattern.data())) path_ = pattern;
  }
  ~PrivateFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// The bytes that `write` puts into a file of this name.
template <class Write>
Result<std::string> bytes_of(const char* name, const Write& write) {
  const PrivateFolder folder;
  if (folder.path().empty())
    return system_error("no temporary folder can be made", "live view",
                        "free some disk space, or let TMPDIR name a folder");
  const std::filesystem::path file = folder.path() / name;
  if (Result<void> written = write(file); !written) return tl::unexpected(written.error());
  const auto bytes = read_file(file);
  if (!bytes) return tl::unexpected(bytes.error());
  return std::string(as_text(*bytes));
}

LitMeshOptions mesh_options(const SolverState& state) {
  LitMeshOptions options;
  options.feature_size = state.options.feature_size;
  options.finest = finest_mesh_edge(state);
  return options;
}

LitMesh sharp_mesh(const SolverState& state, const Progress& progress) {
  const SolutionReader reader(state, kMeshReading);
  return build_lit_mesh(
      state.world->scene, state.world->geometry,
      [&](std::span<const ReadingPoint> points) { return reader(points, progress); },
      mesh_options(state), progress);
}

}  // namespace

Result<std::string> lit_glb(const SolutionCopy& solution, const Progress& progress) {
  const SolverState& state = solution.state;
  const World& world = *state.world;
  std::optional<LitMesh> made;
  if (!solution.sharp) made = sharp_mesh(state, progress);
  const LitMesh& mesh = solution.sharp ? *solution.sharp : *made;
  const float exposure = automatic_exposure(world.scene, world.geometry, mesh.primitives);
  return bytes_of("lit.glb", [&](const std::filesystem::path& file) {
    return write_lit_glb(file, world.scene, world.geometry, mesh.primitives, exposure);
  });
}

Result<std::string> hdr_picture(const SolutionCopy& solution, const ViewOfInterest& view,
                                const Progress& progress) {
  const SolverState& state = solution.state;
  const int width = std::min(view.width, kLargestPicture);
  const int height = std::min(view.height, kLargestPicture);
  const Image image =
      solution_image(state, mesh_options(state), CameraRays(view.camera, width, height), width,
                     height, kSamplesPerPixel, progress);
  return bytes_of("view.exr",
                  [&](const std::filesystem::path& file) { return write_image(file, image); });
}

}  // namespace halflight
