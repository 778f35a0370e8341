// MajorantGrid: upper bounds of a density over the cells of a box, and the way of a ray through them. What tracking by
// null collisions steps by: the tighter the bounds, the fewer steps. Immutable; any thread.
#pragma once

#include "geometry/accel/surface.h"
#include "geometry/base/bounds.h"
#include "renderer/scene/random_stream.h"

#include <array>
#include <functional>
#include <vector>

namespace meristem {

class MajorantGrid {
 public:
  MajorantGrid() = default;
  // `bound` gives an upper bound for a box. About `cells` of them, as cubic as the box allows.
  MajorantGrid(const Bounds3f& box, int cells, const std::function<float(const Bounds3d&)>& bound);

  const Bounds3f& box() const { return box_; }
  float largest() const;

 private:
  friend class TentativeCollisions;
  float at(const std::array<int, 3>& cell) const {
    return majorants_[(std::size_t(cell[0]) * std::size_t(size_[1]) + std::size_t(cell[1])) * std::size_t(size_[2]) +
                      std::size_t(cell[2])];
  }

  Bounds3f box_;
  std::array<int, 3> size_{};
  Vec3f cell_size_;
  std::vector<float> majorants_;
};

// Where light would collide along a ray if the density were everywhere as large as its bound: of these collisions each
// is real with the probability density / majorant (Woodcock et al. 1965). One random number for each.
class TentativeCollisions {
 public:
  TentativeCollisions(const MajorantGrid& grid, const Ray& ray);
  // The next one before ray.t_max; false if there is none.
  bool next(RandomStream& random, float& t, float& majorant);

 private:
  void enter(const Ray& ray, double start);
  bool leave_cell();

  const MajorantGrid& grid_;
  double t_ = 0, end_ = -1;  // how far the walk has come; where it leaves the box or the ray ends
  double cell_end_ = -1;     // where it leaves the current cell
  std::array<int, 3> cell_{}, step_{};
  std::array<double, 3> next_{}, delta_{};  // along the ray: where the next layer of cells begins, and its thickness
};

}  // namespace meristem
