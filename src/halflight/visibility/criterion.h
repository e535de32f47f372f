// When a cluster may stand for its contents (paper section 3.2, figures 5 and 6): when no shadow of
// its contents is wider than the feature size s on the receiver.
//
//   emitter of width d_e      blocker of size b            receiver
//        |-------- D1 -------------|-------- D2 --------------|
//
//   The extreme tangents of both leave an umbra of width
//   u = b + (b - d_e) D2 / D1 = d_e + (b - d_e) D / D1,   D = D1 + D2,
//   negative when there is none. A sun of angular diameter theta: u = b - theta D2.
//
// With r = D2 / D, u <= s is b <= s + (d_e - s) r: no division, and linear in the distance from the
// receiver, as for the sun.
#pragma once

#include "halflight/base/vec.h"

namespace halflight {

// From the receiver to the emitter: direction * reach is the way between them.
struct VisibilityRay {
  Vec3 receiver{0.f};
  Vec3 direction{0.f, 0.f, 1.f};
  float reach = kInfinity;
};

inline float umbra_width(float blocker, float emitter, float d1, float d2) {
  return blocker + (blocker - emitter) * d2 / d1;
}

// A cluster whose middle is `distance` from the receiver may stand for its contents when its
// blocker size is at most at_receiver + growth * distance. Distances are in units of the ray's
// direction vector.
struct StopRule {
  float at_receiver = 0.f;  // s
  float growth = 0.f;

  // Rays whose direction reaches from the receiver to the emitter.
  static StopRule between(float feature_size, float emitter_size) {
    return {feature_size, emitter_size - feature_size};
  }
  // Rays of unit direction, from an emitter at infinity, or of a bundle that widens by this angle.
  static StopRule widening(float feature_size, float angle) { return {feature_size, angle}; }
  // Nothing stops before the end of the tree.
  static StopRule never() { return {-1.f, 0.f}; }

  float largest_blocker(float distance) const { return at_receiver + growth * distance; }
};

}  // namespace halflight
