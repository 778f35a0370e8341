// BoxScene: boxes, and what a ray does that enters one. Few are held against it one by one; up to a thousand are a tree
// of ours, which is small and soon built; more are an Embree scene of user geometry, which rays pass faster.
#pragma once

#include "geometry/accel/embree_device.h"
#include "geometry/accel/few_boxes.h"
#include "geometry/accel/model_root.h"
#include "geometry/tree/braid.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace meristem {

// What stands in the boxes, by number: traces the ray into it and shortens it by what is met (see RTCRay).
struct BoxContents {
  void* owner;
  void (*intersect)(void* owner, std::uint32_t box, RayContext& context, RTCRayHit& ray);
  void (*occluded)(void* owner, std::uint32_t box, RayContext& context, RTCRay& ray);
};

class BoxScene {
 public:
  // Builds on the calling thread; call inside run_isolated(). Throws std::runtime_error if Embree fails.
  BoxScene(std::span<const Bounds3f> boxes, const BoxContents& contents);
  BoxScene(const BoxScene&) = delete;  // Embree holds on to the contents
  BoxScene& operator=(const BoxScene&) = delete;

  // Through the boxes that the ray enters, up to a thousand in the order in which it does.
  void intersect(RayContext& context, RTCRayHit& ray) const;
  void occluded(RayContext& context, RTCRay& ray) const;
  // Those that the ray enters, the nearest first. Nothing: they are many.
  std::optional<std::size_t> entered(const TreeRay& ray, float t_min, float t_max, FewBoxes::List& list) const;
  std::size_t bytes() const { return bytes_; }
  std::vector<Bounds3f> few_boxes() const;  // none if they are many

 private:
  static constexpr std::size_t most_in_tree = 1024;
  static void box_bounds(const RTCBoundsFunctionArguments* args);
  static void intersect_box(const RTCIntersectFunctionNArguments* args);
  static void occluded_box(const RTCOccludedFunctionNArguments* args);

  const BoxContents contents_;
  std::span<const Bounds3f> boxes_;  // while it is built
  std::optional<FewBoxes> few_;      // or
  std::optional<Braid> tree_;        // or
  ScenePtr scene_;
  std::size_t bytes_;
};

}  // namespace meristem
