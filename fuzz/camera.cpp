// Camera files in JSON.
#include "fuzz_target.h"
#include "halflight/io/camera_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  const auto view = parse_camera(fuzz::text_of(data, size), Mat4(1.0), "camera.json");
  if (!view) {
    fuzz::require_clear(view.error());
    return 0;
  }
  const PlacedCamera& c = view->camera;
  fuzz::require(is_finite(c.position), "a camera is somewhere");
  fuzz::require(std::abs(glm::length(c.forward) - 1.f) < 1e-5f, "it looks somewhere");
  fuzz::require(std::abs(glm::length(c.up) - 1.f) < 1e-5f, "up is somewhere");
  fuzz::require(c.vertical_fov > 0.f && c.vertical_fov < 3.15f, "it sees an angle");
  fuzz::require(c.aspect >= 0.f && std::isfinite(c.aspect), "its picture has sides");
  return 0;
}
