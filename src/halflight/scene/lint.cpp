#include "halflight/scene/lint.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>

#include <fmt/format.h>

#include "halflight/base/one_line.h"

namespace halflight {
namespace {

using Severity = Finding::Severity;

// Rooms to city blocks; beyond, another unit is likelier. Metres.
constexpr float kSmallScene = 0.3f;
constexpr float kLargeScene = 300.f;
// Light dies by a factor per bounce; at 0.95 it takes 90 bounces to lose 99 %.
constexpr float kNearlyWhite = 0.95f;
// Below this, W/m2/sr or nits, an emitter lights nothing that anyone would see.
constexpr float kDimRadiance = 1e-3f;
// Rays begin off surfaces by the rounding error of the farthest corners: more than this share of
// the size of most of the scene, and shadows as small as those of the default feature size get
// lost.
constexpr float kLargestLift = 1e-3f;
constexpr std::size_t kSampledTriangles = 4096;

std::string name_of(const Scene& scene, MaterialId id) {
  const std::string& name = scene.materials[id].name;
  return name.empty() ? fmt::format("material {}", id.value)
                      : fmt::format("material '{}'", one_line(name, 100));
}

std::string sizes_by_unit(float diagonal) {
  return fmt::format("as cm it would be {:.3g} m, as mm {:.3g} m, as inches {:.3g} m",
                     0.01f * diagonal, 0.001f * diagonal, 0.0254f * diagonal);
}

void check_size(const Bounds3f& bounds, std::vector<Finding>& findings) {
  const float diagonal = bounds.diagonal();
  if (diagonal > kLargeScene)
    findings.push_back(
        {Severity::warning, "suspicious-size",
         fmt::format("the scene is {:.4g} m across; {}", diagonal, sizes_by_unit(diagonal)),
         "give its unit with --unit"});
  if (diagonal < kSmallScene)
    findings.push_back({Severity::warning, "suspicious-size",
                        fmt::format("the scene is only {:.4g} m across", diagonal),
                        "give its unit with --unit"});
}

// Across most of the scene: what lies far outside on any axis is left out.
float size_of_most(const Geometry& g) {
  const std::size_t n = g.triangles.size();
  const std::size_t step = std::max<std::size_t>(1, n / kSampledTriangles);
  Vec3 extent(0.f);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> places;
    for (std::size_t i = 0; i < n; i += step)
      for (const Vec3& corner : g.corners(TriangleId(i))) places.push_back(corner[axis]);
    const auto at = [&](double share) {
      const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(places.size() - 1));
      std::nth_element(places.begin(), places.begin() + k, places.end());
      return places[static_cast<std::size_t>(k)];
    };
    extent[axis] = at(0.9) - at(0.1);
  }
  return glm::length(extent);
}

void check_fixtures(const Geometry& g, std::vector<Finding>& findings) {
  if (g.lights_without_place > 0)
    findings.push_back(
        {Severity::warning, "light-without-place",
         fmt::format("{} lights have no direction or no usable place and are left out",
                     g.lights_without_place),
         "give their nodes a scale of 1"});
  const auto blind = std::ranges::count_if(g.cameras, std::not_fn(can_look));
  if (blind > 0)
    findings.push_back({Severity::warning, "camera-without-place",
                        fmt::format("{} cameras have no direction or no usable place", blind),
                        "give their nodes a scale of 1"});
}

// Nothing of the scene lies before the plane of an emitter that shines to the front only.
bool faces_away(const Scene& scene, const Geometry& g, TriangleId t) {
  if (scene.materials[g.materials[t]].double_sided) return false;
  const Vec3 normal = glm::normalize(g.scaled_normal(t));
  const Vec3 corner = g.corners(t)[0];
  const Vec3 farthest(normal.x > 0.f ? g.bounds.upper.x : g.bounds.lower.x,
                      normal.y > 0.f ? g.bounds.upper.y : g.bounds.lower.y,
                      normal.z > 0.f ? g.bounds.upper.z : g.bounds.lower.z);
  return glm::dot(farthest - corner, normal) <= 1e-4f * g.bounds.diagonal();
}

void check_emitters(const Scene& scene, const Geometry& g, const SceneSummary& summary,
                    std::vector<Finding>& findings) {
  IdVector<MaterialId, std::size_t> away(scene.materials.size());
  for (std::size_t i = 0; i < g.triangles.size(); ++i) {
    const TriangleId t(i);
    if (scene.materials[g.materials[t]].emits() && faces_away(scene, g, t)) ++away[g.materials[t]];
  }
  for (const EmitterSummary& emitter : summary.emitters) {
    const std::string name = name_of(scene, emitter.material);
    if (away[emitter.material] > 0)
      findings.push_back({Severity::warning, "emitter-faces-away",
                          fmt::format("{} of {} emitting triangles of {} face away from the scene",
                                      away[emitter.material], emitter.triangles, name),
                          "flip them or make the material double-sided"});
    if (max_component(emitter.radiance) < kDimRadiance)
      findings.push_back(
          {Severity::warning, "dim-emitter",
           fmt::format("{} emits only {:.2g} W/m2/sr", name, max_component(emitter.radiance)),
           "check the unit of its emission"});
  }
}

void check_light(const Scene& scene, const Geometry& g, const SceneSummary& summary,
                 std::vector<Finding>& findings) {
  const bool lit = max_component(summary.emitted_power) > 0.f || max_component(scene.sky) > 0.f ||
                   std::ranges::any_of(g.lights, [](const PunctualLight& light) {
                     return max_component(light.intensity) > 0.f;
                   });
  if (!lit)
    findings.push_back({Severity::warning, "no-light", "nothing in the scene gives light",
                        "give a material emission, add a light, or use --sky 1,1,1"});
}

void check_reflectance(const Scene& scene, const SceneSummary& summary,
                       std::vector<Finding>& findings) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const float most = max_component(scene.materials[MaterialId(i)].reflectance);
    if (most > 1.f)
      findings.push_back({Severity::warning, "reflectance-above-one",
                          fmt::format("{} reflects {:.3g} times what it receives; 1 is used",
                                      name_of(scene, MaterialId(i)), most),
                          "give it a colour between 0 and 1"});
  }
  if (max_component(summary.reflectance) > kNearlyWhite)
    findings.push_back(
        {Severity::warning, "nearly-white",
         fmt::format("the surfaces reflect {:.3g} on average; where they enclose light, it hardly "
                     "dies out",
                     max_component(summary.reflectance)),
         "give the materials real colours, 0.8 for white paint"});
}

void check_textures(const Scene& scene, std::vector<Finding>& findings) {
  const auto missing = std::ranges::count_if(
      scene.textures, [](const Texture& texture) { return texture.texels.empty(); });
  if (missing > 0)
    findings.push_back({Severity::warning, "missing-texture",
                        fmt::format("{} of {} textures have no picture; 1 is used", missing,
                                    scene.textures.size()),
                        "put the pictures where the scene looks for them"});
}

void check_triangles(const Geometry& g, std::vector<Finding>& findings) {
  if (g.degenerate_triangles > 0)
    findings.push_back({Severity::note, "degenerate-triangles",
                        fmt::format("{} triangles have no area or no usable place and are left out",
                                    g.degenerate_triangles),
                        ""});
  if (const std::size_t n = count_duplicate_triangles(g); n > 0)
    findings.push_back({Severity::warning, "duplicate-triangles",
                        fmt::format("{} triangles lie exactly on others", n),
                        "remove the copies: which of them is lit is left to chance"});
}

}  // namespace

std::size_t count_duplicate_triangles(const Geometry& g) {
  // -0 and 0 are one place, so the sum with 0 makes them one pattern of bits.
  using Key = std::array<std::uint32_t, 9>;
  std::vector<Key> keys(g.triangles.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    std::array<std::array<std::uint32_t, 3>, 3> corners{};
    const auto positions = g.corners(TriangleId(i));
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = positions[k] + Vec3(0.f);
      std::memcpy(corners[k].data(), &p, sizeof p);
    }
    std::ranges::sort(corners);
    std::memcpy(keys[i].data(), corners.data(), sizeof corners);
  }
  std::ranges::sort(keys);
  std::size_t duplicates = 0;
  for (std::size_t i = 1; i < keys.size(); ++i) duplicates += keys[i] == keys[i - 1] ? 1 : 0;
  return duplicates;
}

std::optional<Finding> far_corners(const Geometry& geometry) {
  if (geometry.triangles.empty()) return std::nullopt;
  const float lift = lift_distance(geometry.bounds);
  if (!(lift > kLargestLift * size_of_most(geometry))) return std::nullopt;
  return Finding{Severity::warning, "far-from-origin",
                 fmt::format("corners lie up to {:.4g} m from the origin, so light is lost where "
                             "surfaces are nearer than {:.2g} m",
                             geometry.bounds.farthest(), lift),
                 "move the scene to the origin, or take away what lies far outside of it"};
}

std::vector<Finding> lint(const Scene& scene, const Geometry& g, const SceneSummary& summary) {
  std::vector<Finding> findings;
  if (g.triangles.empty()) {
    findings.push_back({Severity::warning, "empty", "there is no triangle in the scene",
                        "export it again with its meshes"});
    return findings;
  }
  check_light(scene, g, summary, findings);
  check_emitters(scene, g, summary, findings);
  check_reflectance(scene, summary, findings);
  check_textures(scene, findings);
  check_triangles(g, findings);
  check_fixtures(g, findings);
  check_size(g.bounds, findings);
  if (auto finding = far_corners(g)) findings.push_back(std::move(*finding));
  return findings;
}

}  // namespace halflight
