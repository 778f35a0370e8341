// Part: what can be placed: a model, a group of placed parts, or a ground on which a placer puts parts. Parts nest as
// deep as wished; each placement has its own key, so a forest can be of distinct trees or of a few variants.
// Built once at load, then read-only: any thread.
#pragma once

#include "geometry/base/motion.h"
#include "geometry/cells/individual_bounds.h"
#include "geometry/cells/model.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace meristem {

class Footprint;
struct Part;
// What a part is in each of equally long moments while the shutter is open; never empty.
using PartMoments = std::vector<std::shared_ptr<const Part>>;

struct Placement {
  std::shared_ptr<const Part> part;
  Affine3d to_parent;
  Key individual = 0;      // salts the keys of the part: another plant of the same kind
  bool is_shared = false;  // others with this part and individual stand elsewhere: they share expanded cells where the
                           // wanted level of detail agrees
  bool in_full = false;    // whatever the footprint
  bool is_one_of_many = false;  // and is_shared: shares them even where levels fade in, which then do so by steps
  Bounds3f known_bounds = {};   // of this individual, in its own frame, if known better than the part's; else empty
  // What is seen smaller than so many footprints is shown as this individual instead, which shares expanded cells with
  // others as above; 0: never.
  Key stand_in = 0;
  double stand_in_below = 0;
  // While the shutter is open. `motion`: in place of to_parent, which is its first key; null: it stands still.
  // `moments`: in place of the part, which is the first of them; null: it stays as it is.
  std::shared_ptr<const Motion> motion = nullptr;
  std::shared_ptr<const PartMoments> moments = nullptr;
};

// Bounds in the parent's frame that hold at all times what lies in `box` of the placed part.
Bounds3f bounds_in_parent(const Placement& placement, const Bounds3f& box);
// Of a part at all moments (null: it has one), conservative, in its own frame.
Bounds3f bounds_of_moments(const Part& part, const PartMoments* moments);

// How far what a placer places reaches from where it stands, as boxes around the origin: all of it, and each kind at a
// scale of 1, by the placer's own numbers. No kinds: all that is known is the box.
struct PlacedReach {
  Bounds3f all;
  std::vector<Bounds3f> kinds = {};
};

// What stands on the owned faces of a cell of ground; keeps what it needs of the mesh. Immutable; any thread.
class Furnishing {
 public:
  virtual ~Furnishing() = default;
  virtual std::uint32_t face_count() const = 0;
  // How many stand on a face at most.
  virtual std::uint32_t most_on(std::uint32_t face) const = 0;
  // Of the ground of all faces; and of what stands on those from `begin` up to `end`.
  virtual Bounds3f ground_bounds() const = 0;
  virtual Bounds3f bounds(std::uint32_t begin, std::uint32_t end, const PlacedReach& reach) const = 0;
  // Adds what stands on these faces.
  virtual void place(std::uint32_t begin, std::uint32_t end, std::vector<Placement>& placements) const = 0;
  virtual std::size_t bytes() const = 0;
};

// Puts parts on the faces of a mesh.
class Placer {
 public:
  virtual ~Placer() = default;
  // Of a cell of the ground's final mesh. A pure function of each face; the same for every thread. `individual` as
  // given to the part. The placer must outlive it.
  virtual std::unique_ptr<const Furnishing> furnish(const CellMesh& ground, Key individual) const = 0;
  // Whether nothing stands on ground that lies in this box, whatever its shape.
  virtual bool leaves_bare(const Bounds3f& ground) const = 0;
  // Of whatever is placed, and for decisions that need not be exact,
  virtual Bounds3f reach() const = 0;
  virtual Bounds3f typical_reach() const { return reach(); }
  // and closer, of what is placed on ground in that box where it is seen with that footprint (null: in full).
  virtual std::shared_ptr<const PlacedReach> reach_on(const Bounds3f& ground, const Footprint* footprint,
                                                      Key individual) const = 0;
  // As Part::enlarges: then reach_on() holds for all footprints up to a constant one.
  virtual bool enlarges() const { return false; }
};

// Bounds of what is placed on a ground with those bounds.
Bounds3f bounds_with_reach(const Bounds3f& ground, const Bounds3f& reach);

struct Part {
  explicit Part(std::shared_ptr<const Model> shown);
  // The ground is not shown itself; its settings must keep leaf meshes.
  Part(std::shared_ptr<const Model> ground, std::shared_ptr<const Placer> on_it);
  explicit Part(std::vector<Placement> group);

  const std::shared_ptr<const Model> model;    // null: a group
  const std::shared_ptr<const Placer> placer;  // null: the model itself is shown
  const std::vector<Placement> members;        // of a group
  const Bounds3f bounds;                       // conservative, in the part's frame, of everything that comes of it
  const bool derives = false;  // whether an individual's own bounds are closer than these: model_bounds() knows them
  // Whether it derives nothing, and is larger where it thins than in full, as `typical` holds it;
  // bounds_of_individual() knows how much by the footprint.
  const bool enlarges = false;
  const Bounds3f typical;                      // of one individual, for decisions that need not be exact
  mutable IndividualBounds individual_bounds;  // if it derives: for bounds_of_individual()
};

}  // namespace meristem
