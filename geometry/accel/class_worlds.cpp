#include "geometry/accel/class_worlds.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace meristem {

namespace {

// So many footprints of the coarser world a ray goes before it is seen at that world's detail: displacements that a
// level leaves out are smaller than its faces, and these than the footprint.
constexpr double near_footprints = 4;

double size_at(const Footprint* footprint, Vec3f position) { return footprint ? footprint->at(Vec3d(position)) : 0; }

}  // namespace

template <class Trace>
void RayRoute::trace_near(RayContext& context, RTCRayHit& ray, const Trace& trace) const {
  if (ray.ray.tfar <= split_) return trace();
  // A hit beyond does not exist here
  const float end = std::exchange(ray.ray.tfar, split_);
  const bool had_hit = std::exchange(context.has_hit, false);
  trace();
  if (context.has_hit || ray.ray.tfar < 0) return;
  ray.ray.tfar = end;
  context.has_hit = had_hit;
}

template <class Trace>
void RayRoute::trace_far(RTCRay& ray, const Trace& trace) const {
  const float begin = ray.tnear;
  ray.tnear = std::max(begin, std::nextafter(split_, std::numeric_limits<float>::infinity()));
  if (ray.tnear <= ray.tfar) trace();
  ray.tnear = begin;
}

void RayRoute::intersect(RayContext& context, RTCRayHit& ray) const {
  if (!far_) return near_->intersect(context, ray);
  {
    const WayStep step(context, 0);
    trace_near(context, ray, [&] { near_->intersect(context, ray); });
  }
  const WayStep step(context, 1);
  trace_far(ray.ray, [&] { far_->intersect(context, ray); });
}

void RayRoute::occluded(RayContext& context, RTCRay& ray) const {
  if (!far_) return near_->occluded(context, ray);
  const float end = ray.tfar;
  {
    const WayStep step(context, 0);
    ray.tfar = std::min(end, split_);
    near_->occluded(context, ray);
    if (ray.tfar < 0) return;
    ray.tfar = end;
  }
  const WayStep step(context, 1);
  trace_far(ray, [&] { far_->occluded(context, ray); });
}

bool RayRoute::follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const {
  if (!far_) return near_->follow(way, context, ray);
  bool arrives = true;
  const WayStep step(context, way[0]);
  if (way[0] == 0)
    trace_near(context, ray, [&] { arrives = near_->follow(way.subspan(1), context, ray); });
  else
    trace_far(ray.ray, [&] { arrives = far_->follow(way.subspan(1), context, ray); });
  return arrives;
}

ClassWorlds::ClassWorlds(const std::vector<Placement>& objects, const WorldOptions& options, Roots& roots) {
  const std::shared_ptr<const Footprint> wanted[ray_classes] = {options.footprint, options.diffuse_footprint,
                                                                options.shadow_footprint};
  for (std::size_t c = 0; c < ray_classes; ++c) {
    const auto& footprint = wanted[c] ? wanted[c] : options.footprint;
    const auto same = std::ranges::find(worlds_, footprint, &World::footprint);
    worlds_of_[c] = std::size_t(same - worlds_.begin());
    if (same == worlds_.end()) worlds_.push_back({footprint, roots.place(objects, footprint, nullptr, 0, true)});
  }
}

RayRoute ClassWorlds::route(const Ray& ray) const {
  const World &near = world_of(ray.origin_class), &far = world_of(ray.ray_class);
  if (&near == &far) return RayRoute(*far.objects);
  const double size = std::max(size_at(near.footprint.get(), ray.origin), size_at(far.footprint.get(), ray.origin));
  return {*near.objects, *far.objects, float(near_footprints * size / double(length(ray.direction)))};
}

void ClassWorlds::tighten() {
  for (World& world : worlds_) world.objects->tighten();
}

Bounds3f ClassWorlds::bounds() const {
  Bounds3f all;
  for (const World& world : worlds_) all.extend(world.objects->bounds());
  return all;
}

std::vector<const ModelRoot*> ClassWorlds::roots() const {
  std::vector<const ModelRoot*> all;
  for (const World& world : worlds_) {
    const std::vector<const ModelRoot*> roots = world.objects->roots();
    all.insert(all.end(), roots.begin(), roots.end());
  }
  return all;
}

std::size_t ClassWorlds::bytes() const {
  std::size_t sum = 0;
  for (const World& world : worlds_) sum += world.objects->bytes();
  return sum;
}

}  // namespace meristem
