// Part: what can be placed: a model, a group of placed parts, or a ground on which a placer puts parts. Parts nest as
// deep as wished; each placement has its own key, so a forest can be of distinct trees or of a few variants.
// Built once at load, then read-only: any thread.
#pragma once

#include "geometry/base/transform.h"
#include "geometry/cells/model.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace meristem {

struct Part;

struct Placement {
  std::shared_ptr<const Part> part;
  Affine3d to_parent;
  Key individual = 0;      // salts the keys of the part: another plant of the same kind
  bool is_shared = false;  // others with this part and individual stand elsewhere: they share expanded cells where the
                           // wanted level of detail agrees
  bool in_full = false;    // whatever the footprint
  Bounds3f known_bounds = {};  // of this individual, in its own frame, if known better than the part's; else empty
};

// Puts parts on the faces of a mesh.
class Placer {
 public:
  virtual ~Placer() = default;
  // What stands on the owned faces of a cell of the ground's final mesh. A pure function of each face; the same for
  // every thread. `individual` as given to the part.
  virtual void place(const CellMesh& ground, Key individual, std::vector<Placement>& placements) const = 0;
  // No placed part reaches further than this beyond the ground's bounds.
  virtual double reach() const = 0;
};

struct Part {
  explicit Part(std::shared_ptr<const Model> shown);
  // The ground is not shown itself; its settings must keep leaf meshes.
  Part(std::shared_ptr<const Model> ground, std::shared_ptr<const Placer> on_it);
  explicit Part(std::vector<Placement> group);

  const std::shared_ptr<const Model> model;    // null: a group
  const std::shared_ptr<const Placer> placer;  // null: the model itself is shown
  const std::vector<Placement> members;        // of a group
  const Bounds3f bounds;                       // conservative, in the part's frame, of everything that comes of it
};

}  // namespace meristem
