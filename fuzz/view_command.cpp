// What the live view's page asks for, as JSON.
#include "halflight/view/view_command.h"
#include "fuzz_target.h"
#include "halflight/view/view_queries.h"

namespace halflight::fuzz {
namespace {

void look_at(const ViewOfInterest& view) {
  const PlacedCamera& c = view.camera;
  require(is_finite(c.position), "a view is somewhere");
  require(std::abs(glm::length(c.forward) - 1.f) < 1e-5f, "it looks somewhere");
  require(is_finite(c.up) && glm::length(glm::cross(c.forward, c.up)) > 0.f, "it has an up");
  require(view.width > 0 && view.height > 0, "its picture has sides");
}

void look_at(const ViewCommand& command) {
  if (command.important) look_at(*command.important);
  if (command.offset) require(is_finite(*command.offset), "offsets are finite");
  for (const auto& [name, factor] : command.groups)
    require(is_finite(factor) && min_component(factor) >= 0.f, "factors are light");
}

void look_at(const ProbeRay& ray) {
  require(is_finite(ray.origin), "a ray begins somewhere");
  require(std::abs(glm::length(ray.direction) - 1.f) < 1e-5f, "it goes somewhere");
}

template <class T>
void look_at(const Result<T>& parsed) {
  if (parsed)
    look_at(*parsed);
  else
    require_clear(parsed.error());
}

}  // namespace
}  // namespace halflight::fuzz

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  const std::string_view text = fuzz::text_of(data, size);
  fuzz::look_at(parse_view_command(text));
  fuzz::look_at(parse_view_of_interest(text));
  fuzz::look_at(parse_probe_ray(text));
  return 0;
}
