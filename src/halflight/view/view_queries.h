// Questions about a live solution at one place: what a ray meets, and where its light comes from.
#pragma once

#include <optional>
#include <string>

#include "halflight/view/view_session.h"

namespace halflight {

struct ProbeRay {
  Vec3 origin{0.f};
  Vec3 direction{0.f, 0.f, -1.f};
  bool exact = false;  // also reads the light as a sensor would
};

// {"origin": [..], "direction": [..], "exact": true}
Result<ProbeRay> parse_probe_ray(std::string_view text);

// JSON: place, light, element and what the scene calls it; {"hit": false} where the ray leaves.
std::string probe(const LiveSolution& live, const ProbeRay& ray);

// Packet: lines from an element's middle to the sources of its strongest links, with the irradiance
// that each brings; links of the clusters above it count as its own.
Result<std::string> links_packet(const LiveSolution& live, ElementId element);

// Packet: the boxes below which the ray from an element to its strongest source does not look, and
// whether each is taken as a medium.
Result<std::string> cut_packet(const LiveSolution& live, ElementId element);

}  // namespace halflight
