// BraidedCells: all that is resident below a root as one braid: surfaces, the boxes of what is placed there, and those
// of cells that are not expanded yet.
//
// A ray that goes through cells one inside the other waits for memory at each: the slot, the entry, its boxes, its
// tree. Between two passes nothing is traced, so what is resident may be braided: then a ray enters no cell but those
// that are missing, and what is placed has boxes as close as its roots are known by now. What is met does not depend on
// it.
#pragma once

#include "geometry/accel/instances.h"
#include "geometry/tree/braid.h"

#include <vector>

namespace meristem {

class BraidedCells final : public Passage {
 public:
  struct Surface {
    const SurfacePatch* patch;
    Key key;  // of its cell
  };
  struct Missing {
    BoxContents contents;
    std::uint32_t box;  // by its number among the contents
    Bounds3f bounds;
  };
  struct Strands {
    std::vector<Surface> surfaces;
    std::vector<Placed> placed;
    std::vector<Missing> missing;

    void add(const Instances& instances);
  };
  // All that these name must outlive it.
  explicit BraidedCells(Strands strands);
  BraidedCells(const BraidedCells&) = delete;  // its contents name it
  BraidedCells& operator=(const BraidedCells&) = delete;

  // As those of ModelRoot; not for rays that search or count what they meet.
  void intersect(RayContext& context, RTCRayHit& ray) const;
  void occluded(RayContext& context, RTCRay& ray) const;

  bool empty() const { return !braid_.view().nodes; }
  const Bounds3f& bounds() const { return braid_.bounds(); }
  StreamRay::Leg leg() const override { return {nullptr, 0, braid_.view(), {}}; }
  void met(std::uint32_t tree, const TreeHit& hit, RayContext& context, RTCRay& ray) const override;
  void intersect_other(std::uint32_t other, RayContext& context, RTCRayHit& ray) const override;
  void occlude_other(std::uint32_t other, RayContext& context, RTCRay& ray) const override;
  Placed placed(std::uint32_t other) const override {
    return other < placed_.size() ? placed_[other] : Placed{nullptr, 0};
  }

  std::size_t bytes() const;

 private:
  class Nearest;
  static void intersect_box(void* self, std::uint32_t index, RayContext& context, RTCRayHit& ray);
  static void occlude_box(void* self, std::uint32_t index, RayContext& context, RTCRay& ray);
  Braid braid() const;

  const std::vector<Surface> surfaces_;
  const std::vector<Placed> placed_;  // others of the braid, and behind them
  const std::vector<Missing> missing_;
  const BoxContents contents_;  // of these, by their numbers
  const Braid braid_;
};

}  // namespace meristem
