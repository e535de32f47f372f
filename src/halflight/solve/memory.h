// A limit on memory, kept by counting: what a solve holds follows from the numbers of triangles,
// surfaces, elements and links, not from threads or the allocator, so that the same limit gives the
// same bytes. The constants are upper bounds that were measured, see docs/design/memory.md.
#pragma once

#include <cstddef>

#include "halflight/solve/solver.h"

namespace halflight {

// The program, the scene as read and flattened, and what rays ask.
std::size_t bytes_of_world(const World& world);
// Surfaces, clusters, visibility, and the elements to begin with.
std::size_t bytes_of_hierarchy(std::size_t triangles, std::size_t surfaces);
// Of a lit mesh with so many vertices until its file is written; the input's own are always kept,
// on both sides of surfaces if both are lit.
std::size_t bytes_of_lit_mesh(std::size_t vertices);
std::size_t most_vertices_of_input(const World& world);

// What may still be made under the limit of the options; without one there is no end.
struct MemoryRoom {
  std::size_t elements;       // in all, before anything is made coarser
  std::size_t refined_links;  // in all, at the worst moment of an iteration
  std::size_t sampled_links;  // to be added
};
MemoryRoom memory_room(const SolverState& state);

// What counts of the state by now, bytes.
std::size_t counted_bytes(const SolverState& state);

// Frees the links: the light is known and is only to be read from here on.
void drop_links(SolverState& state);

}  // namespace halflight
