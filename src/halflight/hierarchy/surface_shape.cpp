#include "halflight/hierarchy/surface_shape.h"

#include "halflight/base/parallel.h"
#include "halflight/hierarchy/bodies.h"

namespace halflight {

std::vector<SurfaceShape> surface_shapes(const Geometry& geometry, const Surfaces& surfaces) {
  const Bodies bodies = find_bodies(geometry);
  std::vector<SurfaceShape> shapes(surfaces.surfaces.size());
  parallel_for(shapes.size(), 4096, [&](std::size_t i) {
    const Surface& s = surfaces[SurfaceId(i)];
    shapes[i] = {s.box, s.normal, s.area,
                 bodies.of_triangle[surfaces.triangles[s.first_triangle]].value};
  });
  return shapes;
}

}  // namespace halflight
