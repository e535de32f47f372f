#include "halflight/visibility/chords.h"

#include "halflight/rays/sampling.h"

namespace halflight {

// A point uniform over the sides and a direction by the cosine law make lines uniform.
VisibilityRay random_chord(const Bounds3f& box, std::uint64_t seed, std::uint32_t i) {
  const Vec3 e = box.extent();
  const Vec3 areas(e.y * e.z, e.z * e.x, e.x * e.y);
  float choice = to_unit_float(hash(seed, i)) * (areas.x + areas.y + areas.z);
  int axis = 0;
  while (axis < 2 && choice >= areas[axis]) choice -= areas[axis++];
  const bool upper = (hash(seed, i, 1) & 1u) != 0;
  const Vec2 at = r2_sequence(i, random_shift(hash(seed, 2)));
  VisibilityRay chord;
  chord.receiver[axis] = upper ? box.upper[axis] : box.lower[axis];
  chord.receiver[(axis + 1) % 3] = box.lower[(axis + 1) % 3] + e[(axis + 1) % 3] * at.x;
  chord.receiver[(axis + 2) % 3] = box.lower[(axis + 2) % 3] + e[(axis + 2) % 3] * at.y;
  Vec3 inwards(0.f);
  inwards[axis] = upper ? -1.f : 1.f;
  const Vec2 u(to_unit_float(hash(seed, i, 3)), to_unit_float(hash(seed, i, 4)));
  chord.direction = Frame::from_normal(inwards).to_world(cosine_hemisphere(u));
  chord.reach = kInfinity;
  for (int k = 0; k < 3; ++k) {
    const float d = chord.direction[k];
    if (std::abs(d) < 1e-6f) continue;
    const float side = d > 0.f ? box.upper[k] : box.lower[k];
    chord.reach = std::min(chord.reach, std::max((side - chord.receiver[k]) / d, 0.f));
  }
  return chord;
}

}  // namespace halflight
