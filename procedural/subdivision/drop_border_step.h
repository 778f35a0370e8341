// DropBorderStep: takes the faces that touch a boundary out of what is shown, as OpenSubdiv does where boundaries are
// not interpolated (VTX_BOUNDARY_NONE makes them holes). They stay in the halo and go on through all later steps, so
// that they keep shaping their neighbours: the surface ends as if it went on.
#pragma once

#include "geometry/cells/step.h"

#include <algorithm>

namespace meristem {

class DropBorderStep final : public Step {
 public:
  std::string name() const override { return "drop border"; }
  int halo_rings(int rings_after) const override { return std::max(rings_after, 1); }
  std::uint32_t max_children(std::uint32_t) const override { return 1; }
  void apply(const CellMesh& in, int rings_after, CellMesh& out) const override;
  Extent bound(const Extent& e) const override { return e; }
  bool drops_faces() const override { return true; }
};

}  // namespace meristem
