#include "geometry/accel/model_root.h"

namespace meristem {

void intersect_patch(const SurfacePatch& patch, Key key, RayContext& context, RTCRayHit& ray) {
  const RTCHit previous = ray.hit;
  const float previous_t = ray.ray.tfar;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(patch.scene(), &context.embree, &ray);
  const bool missed = ray.hit.geomID == RTC_INVALID_GEOMETRY_ID;
  const bool lost_tie = ray.ray.tfar == previous_t && context.patch && context.patch_key < key;
  if (missed || lost_tie) {
    ray.hit = previous;
    return;
  }
  context.patch = &patch;
  context.patch_key = key;
  context.patch_object = context.object;
}

}  // namespace meristem
