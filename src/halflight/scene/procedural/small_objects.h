// Small things in number: books, binders, pens, paper.
#pragma once

#include <vector>

#include "halflight/scene/procedural/random.h"
#include "halflight/scene/scene.h"

namespace halflight {

// Books of several colours, as unit boxes to be scaled to thickness (x), height (y) and depth (z);
// the spine faces +z.
std::vector<MeshId> add_books(Scene& scene);

// Binders are unit boxes like books. Pens stand on the origin along +Y. Paper lies centred on the
// origin, its long side along z; pens and paper have their real size.
struct SmallObjects {
  std::vector<MeshId> books;
  std::vector<MeshId> binders;
  std::vector<MeshId> pens;
  MeshId paper_stack;
  MeshId sheet;
  std::vector<MeshId> notes;
};
SmallObjects add_small_objects(Scene& scene, std::uint64_t seed);

// Thickness, height and depth of a book, in metres.
Vec3 random_book_size(Random& random);
// Lays a standing book on its side: its cover faces up, its footprint is centred on `position`.
Mat4 lying_book(const Vec3& position, const Vec3& size, float turn);

}  // namespace halflight
