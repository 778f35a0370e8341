#include "geometry/accel/model_root.h"

namespace meristem {

namespace {

std::optional<Affine3d> to_world(const RayContext::Frame* frame) {
  if (!frame) return {};
  auto exact = [](const Affine3f& m) { return Affine3d{Vec3d(m.x), Vec3d(m.y), Vec3d(m.z), Vec3d(m.origin)}; };
  Affine3d result = exact(*frame->to_parent);
  while ((frame = frame->parent)) result = exact(*frame->to_parent) * result;
  return result;
}

}  // namespace

bool intersect_patch(const SurfacePatch& patch, Key key, RayContext& context, RTCRayHit& ray) {
  const RTCHit previous = ray.hit;
  const float previous_t = ray.ray.tfar;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(patch.scene(), &context.embree, &ray);
  const bool missed = ray.hit.geomID == RTC_INVALID_GEOMETRY_ID;
  key = hash_keys(key, context.path);
  const bool lost_tie = ray.ray.tfar == previous_t && context.has_hit && context.patch_key < key;
  if (missed || lost_tie) {
    ray.hit = previous;
    return false;
  }
  context.has_hit = true;
  context.patch = &patch;
  context.patch_key = key;
  context.patch_object = context.object;
  context.patch_to_world = to_world(context.frame);
  return true;
}

}  // namespace meristem
