// What is likely wrong with a scene, found before time is spent on lighting it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "halflight/scene/geometry.h"
#include "halflight/scene/scene.h"
#include "halflight/scene/summary.h"

namespace halflight {

struct Finding {
  enum class Severity { note, warning };
  Severity severity = Severity::warning;
  std::string code;     // stable name for programs, e.g. "no-light"
  std::string message;  // one line: what, where, how many
  std::string remedy;
};

// Codes: empty, no-light, emitter-faces-away, dim-emitter, reflectance-above-one, nearly-white,
// missing-texture, degenerate-triangles, duplicate-triangles, light-without-place,
// camera-without-place, suspicious-size, far-from-origin.
std::vector<Finding> lint(const Scene& scene, const Geometry& geometry,
                          const SceneSummary& summary);

// The finding far-from-origin, which costs all of the scene light and shadows.
std::optional<Finding> far_corners(const Geometry& geometry);

// Triangles that cover exactly the same three points as an earlier one, whichever way round.
std::size_t count_duplicate_triangles(const Geometry& geometry);

}  // namespace halflight
