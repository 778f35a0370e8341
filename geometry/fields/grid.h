// Grid: a field known by samples, as the function vdb() of expressions sees it; GridSource: what the names in vdb()
// lead to. Both are implemented above (geometry/volumes, renderer/loading).
#pragma once

#include "geometry/base/bounds.h"
#include "geometry/fields/expression.h"

#include <memory>
#include <string>

namespace meristem {

// Immutable; any thread. Same bits on every machine of one build.
class Grid {
 public:
  virtual ~Grid() = default;
  // Trilinear between the samples; far from them one constant, the background. Finite for a finite place.
  virtual float value(Vec3f place) const = 0;
  // Differences of the value over one sample's spacing to both sides.
  virtual Vec3f gradient(Vec3f place) const = 0;
  // Holds every value at places inside the box.
  virtual Interval value_bounds(const Bounds3d& box) const = 0;
  // Holds every component of every gradient at places inside the box.
  virtual Interval gradient_bounds(const Bounds3d& box) const = 0;
};

class GridSource {
 public:
  virtual ~GridSource() = default;
  // The grid called `grid` (empty: the only or first one) of the file, or of the scene's grids, called `name`; the same
  // object at every call. Throws a std::runtime_error that says what is wrong, in words for the user.
  virtual std::shared_ptr<const Grid> open(const std::string& name, const std::string& grid) = 0;
};

// While it lives, vdb() in expressions that this thread compiles asks `source`; without one it is an error. Compiled
// expressions own their grids. Scopes nest.
class GridScope {
 public:
  explicit GridScope(GridSource* source);
  ~GridScope();
  GridScope(const GridScope&) = delete;
  GridScope& operator=(const GridScope&) = delete;

  static GridSource* current();  // null: none

 private:
  GridSource* outer_;
};

}  // namespace meristem
