// PositionLattice: what positions are rounded to where they are shown.
//
// A surface keeps its positions on 16 bits an axis if they lie on few planes (surface_vertices.h). So they are rounded
// to multiples of a power of two that follows from the vertex alone, whatever cell it stands in: 256 to 511 of them to
// its nominal scale (level_of_detail.h), which is a diagonal of its faces; but no more than Model::coarsest_lattice(),
// which is also that of vertices without a scale, so that one margin holds for all bounds. Normals are those of the
// surface that is not rounded.
#pragma once

#include "geometry/cells/model.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace meristem {

class PositionLattice {
 public:
  // Without a footprint nothing is rounded, nor where a base mesh is shown as it was given.
  PositionLattice(const Model& model, const CellMesh& cell)
      : scales_(cell.footprint && model.levels() > 0 && !cell.mesh.nominal_scale.empty()
                    ? cell.mesh.nominal_scale.data()
                    : nullptr),
        coarsest_(model.coarsest_lattice()) {}

  // Never -0: that a vertex lies on a plane through the origin is one number.
  Vec3f round(std::uint32_t vertex, Vec3f p) const {
    if (!scales_) return p + Vec3f(0.f);
    const double scale = scales_[vertex];
    const Quantum quantum(scale > 0 ? std::min(power_of_two(scale) * 0x1p-8, coarsest_) : coarsest_);
    return Vec3f(quantum.round(Vec3d(p)));
  }

  // How far rounding may move a vertex along an axis, in any cell: bounds need as much more.
  static double margin(const Model& model) { return model.coarsest_lattice() / 2; }

 private:
  // The largest that is no larger.
  static double power_of_two(double x) {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & 0x7ff0000000000000u);
  }

  const double* scales_;  // by vertex; null: none
  double coarsest_;
};

}  // namespace meristem
