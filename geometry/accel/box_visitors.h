// What a ray does on its way through a braid whose other boxes have contents.
#pragma once

#include "geometry/accel/box_scene.h"
#include "geometry/tree/braid.h"

namespace meristem {

class NearestInBoxes : public BraidVisitor {
 public:
  NearestInBoxes(const BoxContents& contents, RayContext& context, RTCRayHit& ray)
      : BraidVisitor(ray.ray.tfar), context_(context), ray_(ray), contents_(contents) {}
  void enter(std::uint32_t box) final {
    contents_.intersect(contents_.owner, box, context_, ray_);
    t_max = ray_.ray.tfar;
  }

 protected:
  RayContext& context_;
  RTCRayHit& ray_;

 private:
  const BoxContents& contents_;
};

class AnyInBoxes final : public BraidVisitor {
 public:
  AnyInBoxes(const BoxContents& contents, RayContext& context, RTCRay& ray)
      : BraidVisitor(ray.tfar), context_(context), ray_(ray), contents_(contents) {}
  void enter(std::uint32_t box) override {
    contents_.occluded(contents_.owner, box, context_, ray_);
    t_max = ray_.tfar;
  }

 private:
  RayContext& context_;
  RTCRay& ray_;
  const BoxContents& contents_;
};

}  // namespace meristem
