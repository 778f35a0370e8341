// ShownSurfaces: everything that a list of objects shows, each distinct surface once with all the places where it
// stands: for what looks at geometry as a whole, such as export. The world expands the same cells to the same bits.
#pragma once

#include "geometry/cells/expansion.h"
#include "geometry/cells/part.h"

#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

namespace meristem {

// More of something than was allowed.
class TooMany : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct ShownSurface {
  std::shared_ptr<const Model> model;
  std::shared_ptr<const Footprint> footprint;  // null: in full
  Key individual = 0;
  std::vector<Affine3d> places;
};

// The surfaces of objects in a frame whose footprint is given (null: everything in full), in the order in which they
// are placed first. Expands the grounds on which other parts stand, and nothing else. Throws TooMany beyond
// `most_places` in all.
std::vector<ShownSurface> shown_surfaces(const std::vector<Placement>& objects,
                                         const std::shared_ptr<const Footprint>& footprint, std::size_t most_places);

// Expands a surface cell by cell, depth first, so that no more is held than a path of the tree of cells; calls `visit`
// with each final cell and the part of the surface, roughly, that is then done: 1 at the last.
void for_each_tessellation(const ShownSurface& surface,
                           const std::function<void(const Tessellation& cell, double done)>& visit);

}  // namespace meristem
