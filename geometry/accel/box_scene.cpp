#include "geometry/accel/box_scene.h"

#include "geometry/accel/box_visitors.h"

#include <algorithm>
#include <limits>

namespace meristem {

namespace {

// The nearest first: what is met there spares the others.
void sort(FewBoxes::List& entered, std::size_t count) {
  for (std::size_t i = 1; i < count; ++i) {
    const FewBoxes::Entered next = entered[i];
    std::size_t at = i;
    for (; at > 0 && entered[at - 1].t > next.t; --at) entered[at] = entered[at - 1];
    entered[at] = next;
  }
}

}  // namespace

// Embree's callbacks. Contents do not throw, so nothing crosses the C boundary.
void BoxScene::box_bounds(const RTCBoundsFunctionArguments* args) {
  const Bounds3f& b = static_cast<const BoxScene*>(args->geometryUserPtr)->boxes_[args->primID];
  *args->bounds_o = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z, 0};
}

void BoxScene::intersect_box(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const BoxContents& contents = static_cast<const BoxScene*>(args->geometryUserPtr)->contents_;
  contents.intersect(contents.owner, args->primID, *reinterpret_cast<RayContext*>(args->context),
                     *reinterpret_cast<RTCRayHit*>(args->rayhit));
}

void BoxScene::occluded_box(const RTCOccludedFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const BoxContents& contents = static_cast<const BoxScene*>(args->geometryUserPtr)->contents_;
  contents.occluded(contents.owner, args->primID, *reinterpret_cast<RayContext*>(args->context),
                    *reinterpret_cast<RTCRay*>(args->ray));
}

BoxScene::BoxScene(std::span<const Bounds3f> boxes, const BoxContents& contents) : contents_(contents) {
  if (boxes.size() <= FewBoxes::most) {
    few_.emplace(boxes);
    bytes_ = sizeof(*this) + few_->bytes();
    return;
  }
  if (boxes.size() <= most_in_tree) {
    tree_.emplace(std::span<const Braid::Tree>(), boxes);
    bytes_ = sizeof(*this) + tree_->bytes();
    return;
  }
  boxes_ = boxes;
  scene_.reset(rtcNewScene(embree_device()));
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, unsigned(boxes.size()));
  rtcSetGeometryUserData(geometry, this);
  rtcSetGeometryBoundsFunction(geometry, box_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect_box);
  rtcSetGeometryOccludedFunction(geometry, occluded_box);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_.get(), geometry);
  rtcReleaseGeometry(geometry);
  bytes_ = sizeof(*this) + commit_scene(scene_.get());
  boxes_ = {};  // the caller's
}

std::vector<Bounds3f> BoxScene::few_boxes() const { return few_ ? few_->boxes() : std::vector<Bounds3f>(); }

std::optional<std::size_t> BoxScene::entered(const TreeRay& ray, float t_min, float t_max, FewBoxes::List& list) const {
  if (!few_) return {};
  const std::size_t count = few_->meet(ray, t_min, t_max, list);
  sort(list, count);
  return count;
}

void BoxScene::intersect(RayContext& context, RTCRayHit& ray) const {
  if (tree_) {
    NearestInBoxes visitor(contents_, context, ray);
    return tree_->intersect(*context.tree_ray, ray.ray.tnear, visitor);
  }
  if (scene_) return rtcIntersect1(scene_.get(), &context.embree, &ray);
  FewBoxes::List list;
  const std::size_t count = *entered(*context.tree_ray, ray.ray.tnear, ray.ray.tfar, list);
  for (std::size_t i = 0; i < count && list[i].t <= ray.ray.tfar; ++i)
    contents_.intersect(contents_.owner, list[i].box, context, ray);
}

void BoxScene::occluded(RayContext& context, RTCRay& ray) const {
  if (tree_) {
    AnyInBoxes visitor(contents_, context, ray);
    tree_->occluded(*context.tree_ray, ray.tnear, visitor);
    return;
  }
  if (scene_) return rtcOccluded1(scene_.get(), &context.embree, &ray);
  FewBoxes::List entered;
  const std::size_t count = few_->meet(*context.tree_ray, ray.tnear, ray.tfar, entered);
  for (std::size_t i = 0; i < count && ray.tfar >= 0; ++i)
    contents_.occluded(contents_.owner, entered[i].box, context, ray);
}

}  // namespace meristem
