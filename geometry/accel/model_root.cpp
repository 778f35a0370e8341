#include "geometry/accel/model_root.h"

namespace meristem {

namespace {

std::optional<Affine3d> from_world(const RayContext::Frame* frame) {
  if (!frame) return {};
  auto exact = [](const Affine3f& m) { return Affine3d{Vec3d(m.x), Vec3d(m.y), Vec3d(m.z), Vec3d(m.origin)}; };
  Affine3d result = exact(*frame->from_parent);
  while ((frame = frame->parent)) result = result * exact(*frame->from_parent);
  return result;
}

HitRank rank_of(const SurfacePatch& patch, const TreeHit& hit, Key path, Key key) {
  const SurfaceTree::Triangle triangle = patch.tree().triangle(hit.triangle);
  return {path, tie_key(patch.positions(), triangle.corners), key};
}

// Of a hit as far as the nearest so far. Rare.
[[gnu::noinline, gnu::cold]] bool wins_tie(const SurfacePatch& patch, Key key, const TreeHit& hit,
                                           const RayContext& context) {
  const HitRank before = context.patch ? rank_of_hit(context) : context.kept_rank;
  const HitRank now = rank_of(patch, hit, context.path, key);
  // Of one patch another part may have been met already
  return now == before ? hit.triangle <= context.patch_hit.triangle : now < before;
}

}  // namespace

HitRank rank_of_hit(const RayContext& context) {
  return rank_of(*context.patch, context.patch_hit, context.patch_path, context.patch_key);
}

TreeRay tree_ray(const RTCRay& ray) { return {{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}}; }

bool intersect_patch(const SurfacePatch& patch, Key key, RayContext& context, RTCRay& ray) {
  TreeHit hit{ray.tfar};
  return patch.intersect(*context.tree_ray, ray.tnear, hit) && take_hit(patch, key, hit, context, ray);
}

bool take_hit(const SurfacePatch& patch, Key key, const TreeHit& hit, RayContext& context, RTCRay& ray) {
  if (hit.t == ray.tfar && context.has_hit && !wins_tie(patch, key, hit, context)) return false;
  ray.tfar = hit.t;
  context.has_hit = true;
  context.patch = &patch;
  context.patch_hit = hit;
  context.patch_key = key;
  context.patch_path = context.path;
  context.patch_object = context.object;
  context.patch_from_world = from_world(context.frame);
  return true;
}

StreamRay::Leg SurfacePassage::leg() const {
  const SurfaceTree& tree = patch_.tree();
  return {nullptr, 0, {nullptr, nullptr}, {tree.nodes().data(), tree.triangles(), patch_.positions(), 0, 0}};
}

void SurfacePassage::met(std::uint32_t, const TreeHit& hit, RayContext& context, RTCRay& ray) const {
  patch_.prefetch(hit);
  take_hit(patch_, key_, hit, context, ray);
}

void occlude_with_patch(const SurfacePatch& patch, const RayContext& context, RTCRay& ray) {
  if (patch.occluded(*context.tree_ray, ray.tnear, ray.tfar)) ray.tfar = -std::numeric_limits<float>::infinity();
}

}  // namespace meristem
