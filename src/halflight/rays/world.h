// A scene made ready for queries: what every renderer of it shares. Immutable and at a fixed
// address, since its parts refer to each other.
#pragma once

#include <memory>

#include "halflight/rays/ray_scene.h"
#include "halflight/scene/geometry.h"
#include "halflight/scene/scene.h"

namespace halflight {

struct World {
  explicit World(Scene s) : scene(std::move(s)), geometry(flatten(scene)), rays(scene, geometry) {}
  // The same world under other light: `relit` is its scene but for what materials, punctual lights
  // and the sky emit. Shares what rays ask.
  World(const std::shared_ptr<const World>& other, Scene relit)
      : scene(std::move(relit)),
        geometry(with_lights_of(scene, other->geometry)),
        rays(other->rays, other) {}
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  const Scene scene;
  const Geometry geometry;
  const RayScene rays;
};

inline std::shared_ptr<const World> make_world(Scene scene) {
  return std::make_shared<const World>(std::move(scene));
}

}  // namespace halflight
