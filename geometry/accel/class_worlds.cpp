#include "geometry/accel/class_worlds.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace meristem {

namespace {

// So many footprints of the coarser world a ray goes before it is seen at that world's detail: displacements that a
// level leaves out are smaller than its faces, and these than the footprint.
constexpr double near_footprints = 4;

float begin_beyond(float split, float begin) {
  return std::max(begin, std::nextafter(split, std::numeric_limits<float>::infinity()));
}

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
  ray.tnear = begin_beyond(split_, begin);
  if (ray.tnear <= ray.tfar) trace();
  ray.tnear = begin;
}

void RayRoute::intersect(RayContext& context, RTCRayHit& ray) const {
  if (!far_) return near_->objects->intersect(context, ray);
  {
    const WayStep step(context, 0);
    trace_near(context, ray, [&] { near_->objects->intersect(context, ray); });
  }
  const WayStep step(context, 1);
  trace_far(ray.ray, [&] { far_->objects->intersect(context, ray); });
}

void RayRoute::occluded(RayContext& context, RTCRay& ray) const {
  if (!far_) return near_->objects->occluded(context, ray);
  const float end = ray.tfar;
  {
    const WayStep step(context, 0);
    ray.tfar = std::min(end, split_);
    near_->objects->occluded(context, ray);
    if (ray.tfar < 0) return;
    ray.tfar = end;
  }
  const WayStep step(context, 1);
  trace_far(ray, [&] { far_->objects->occluded(context, ray); });
}

const ClassWorld* RayRoute::Steps::next(RTCRay& ray, bool has_met) {
  if (step_++ == 0) {
    begin_ = ray.tnear;
    end_ = ray.tfar;
    if (route_.far_) ray.tfar = std::min(end_, route_.split_);
    return route_.near_;
  }
  if (has_met || !route_.far_ || step_ > 2) return nullptr;
  ray.tfar = end_;
  ray.tnear = begin_beyond(route_.split_, begin_);
  return ray.tnear <= end_ ? route_.far_ : nullptr;
}

bool RayRoute::follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const {
  if (!far_) return near_->objects->follow(way, context, ray);
  bool arrives = true;
  const WayStep step(context, way[0]);
  if (way[0] == 0)
    trace_near(context, ray, [&] { arrives = near_->objects->follow(way.subspan(1), context, ray); });
  else
    trace_far(ray.ray, [&] { arrives = far_->objects->follow(way.subspan(1), context, ray); });
  return arrives;
}

ClassWorlds::ClassWorlds(const std::vector<Placement>& objects, const WorldOptions& options, Roots& roots) {
  const std::shared_ptr<const Footprint> wanted[ray_classes] = {options.footprint, options.diffuse_footprint,
                                                                options.shadow_footprint};
  for (std::size_t c = 0; c < ray_classes; ++c) {
    const auto& footprint = wanted[c] ? wanted[c] : options.footprint;
    const auto same = std::ranges::find(worlds_, footprint, &ClassWorld::footprint);
    worlds_of_[c] = std::size_t(same - worlds_.begin());
    if (same == worlds_.end())
      worlds_.push_back({footprint, roots.place(objects, footprint, nullptr, 0, true), nullptr});
  }
}

RayRoute ClassWorlds::route(const Ray& ray) const {
  const ClassWorld &near = world_of(ray.origin_class), &far = world_of(ray.ray_class);
  if (&near == &far) return RayRoute(far);
  const double size = std::max(size_at(near.footprint.get(), ray.origin), size_at(far.footprint.get(), ray.origin));
  return {near, far, float(near_footprints * size / double(length(ray.direction)))};
}

void ClassWorlds::tighten() {
  for (ClassWorld& world : worlds_) world.objects->tighten();
}

void ClassWorlds::braid() {
  for (ClassWorld& world : worlds_) {
    if (world.objects->count() <= FewBoxes::most) continue;
    BraidedCells::Strands strands;
    strands.add(*world.objects);
    auto braided = std::make_unique<const BraidedCells>(std::move(strands));
    if (!braided->empty()) world.braided = std::move(braided);
  }
}

void ClassWorlds::unbraid() {
  for (ClassWorld& world : worlds_) world.braided.reset();
}

Bounds3f ClassWorlds::bounds() const {
  Bounds3f all;
  for (const ClassWorld& world : worlds_) all.extend(world.objects->bounds());
  return all;
}

std::vector<const ModelRoot*> ClassWorlds::roots() const {
  std::vector<const ModelRoot*> all;
  for (const ClassWorld& world : worlds_) {
    const std::vector<const ModelRoot*> roots = world.objects->roots();
    all.insert(all.end(), roots.begin(), roots.end());
  }
  return all;
}

std::size_t ClassWorlds::bytes() const {
  std::size_t sum = 0;
  for (const ClassWorld& world : worlds_) sum += world.objects->bytes() + (world.braided ? world.braided->bytes() : 0);
  return sum;
}

}  // namespace meristem
