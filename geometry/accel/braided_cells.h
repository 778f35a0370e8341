// BraidedCells: all resident surfaces below a root as one braid, and the boxes of what else a ray may enter there.
//
// A ray that goes through cells one inside the other waits for memory at each: the slot, the entry, its boxes, its
// tree. Between two passes nothing is traced, so what is resident may be braided: then a ray enters no cell but those
// that are not expanded yet. What is met does not depend on it.
#pragma once

#include "geometry/accel/box_scene.h"
#include "geometry/tree/braid.h"

#include <vector>

namespace meristem {

class BraidedCells final : public Passage {
 public:
  struct Surface {
    const SurfacePatch* patch;
    Key key;  // of its cell
  };
  struct Other {
    Bounds3f bounds;
    BoxContents contents;
    std::uint32_t box;  // by its number among the contents
  };
  // Surfaces and contents must outlive it.
  BraidedCells(std::vector<Surface> surfaces, std::vector<Other> others);
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

  std::size_t bytes() const;

 private:
  class Nearest;
  static void intersect_box(void* self, std::uint32_t index, RayContext& context, RTCRayHit& ray);
  static void occlude_box(void* self, std::uint32_t index, RayContext& context, RTCRay& ray);
  static Braid braid(const std::vector<Surface>& surfaces, const std::vector<Other>& others);

  std::vector<Surface> surfaces_;
  std::vector<Other> others_;
  const BoxContents contents_;  // of the others, by their numbers
  Braid braid_;
};

}  // namespace meristem
