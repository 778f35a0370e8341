// What a placed part is seen as in its own frame: its footprint, and which individual of its kind it is. What rays
// meet and what is exported agree because both ask here. Pure functions; any thread.
#pragma once

#include "geometry/cells/footprint.h"
#include "geometry/cells/part.h"

#include <optional>

namespace meristem {

// What decisions take for its bounds: those of one individual of the part, unless they are known.
const Bounds3f& placed_bounds(const Placement& placement);

// In the frame of a part whose parent's footprint is given (null, and a part in full: null). Where it hardly varies
// over the part it is constant, the least of it, so that other placements can share what is expanded. Where levels
// fade in, only of one of many, since a shared one changes by steps.
std::shared_ptr<const Footprint> placed_footprint(const std::shared_ptr<const Footprint>& parent,
                                                  const Placement& placement);

// A placement as it is shown where the footprint is given: that of its stand-in, if it is seen that small.
struct ShownPlacement {
  Placement placement;
  std::shared_ptr<const Footprint> footprint;  // placed_footprint() of it
};
ShownPlacement shown_placement(const Placement& placement, const std::shared_ptr<const Footprint>& footprint);

// Constant footprints that are shared come in steps: the number of the step in which a size falls, and the size that
// stands for the step, its least.
int footprint_step(double size);
double size_of_step(int step);
// Where a footprint has such bounds it counts as constant, as placed_footprint() decides.
bool is_about_constant(const Footprint::Range& range);

// A placement of which the size of its constant footprint is known by bounds on its parent's over the box by which that
// is decided: as whom it is shown, and that size. None: shown_placement() has to decide.
struct SharedPlacement {
  Key individual;
  double size;
};
std::optional<SharedPlacement> shared_placement(const Placement& placement, const Footprint::Range& parent);

// Of an individual of a part in its own frame, before it is expanded; `otherwise`, of it in full, where nothing closer
// can be had, and further by what is enlarged with that footprint where things thin.
// Most of what is placed is never met: so not from all that grows on it.
Bounds3f bounds_of_individual(const Part& part, const Footprint* footprint, Key individual, const Bounds3f& otherwise);

// Of a part that is placed in an individual.
Key placed_individual(Key parent, const Placement& placement);

// Whether all placements of this part and individual with this footprint (of placed_footprint) are the same geometry.
bool can_share(const Placement& placement, const Footprint* footprint);
// That of a constant footprint; 0 of none.
double constant_size(const Footprint* footprint);

}  // namespace meristem
