#include "halflight/hierarchy/surface_shape.h"

#include "halflight/base/parallel.h"

namespace halflight {

std::vector<SurfaceShape> surface_shapes(const Surfaces& surfaces) {
  std::vector<SurfaceShape> shapes(surfaces.surfaces.size());
  parallel_for(shapes.size(), 4096, [&](std::size_t i) {
    const Surface& s = surfaces[SurfaceId(i)];
    shapes[i] = {s.box, s.normal, s.area,
                 surfaces.bodies.of_triangle[surfaces.triangles[s.first_triangle]].value};
  });
  return shapes;
}

}  // namespace halflight
