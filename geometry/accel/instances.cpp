#include "geometry/accel/instances.h"

#include <algorithm>
#include <utility>

namespace meristem {

namespace {

Affine3f to_float(const Affine3d& m) { return {Vec3f(m.x), Vec3f(m.y), Vec3f(m.z), Vec3f(m.origin)}; }
Affine3d to_double(const Affine3f& m) { return {Vec3d(m.x), Vec3d(m.y), Vec3d(m.z), Vec3d(m.origin)}; }

// The ray in the frame of an instance; its direction keeps its length, so t is the same in both.
void transform(const Affine3f& m, RTCRay& ray) {
  const Vec3f o = m.point({ray.org_x, ray.org_y, ray.org_z});
  const Vec3f d = m.vector({ray.dir_x, ray.dir_y, ray.dir_z});
  ray.org_x = o.x, ray.org_y = o.y, ray.org_z = o.z;
  ray.dir_x = d.x, ray.dir_y = d.y, ray.dir_z = d.z;
}

}  // namespace

Bounds3f instance_bounds(std::span<const ModelRoot* const> roots, const Placement& placement) {
  Bounds3f bounds;
  for (const ModelRoot* root : roots) bounds.extend(root->bounds());
  const bool is_identity = placement.to_parent.is_identity() && !placement.motion;
  return is_identity ? bounds : bounds_in_parent(placement, bounds);
}

Instance::Instance(std::span<const ModelRoot* const> roots, const Placement& placement)
    : from_parent_(to_float(placement.to_parent.inverse())), root_(roots[0]) {
  const bool is_identity = placement.to_parent.is_identity() && !placement.motion;
  if (is_identity || roots.size() > 1 || placement.motion)
    special_ =
        std::make_unique<const Special>(Special{is_identity, {roots.begin() + 1, roots.end()}, placement.motion});
}

void Instance::add_roots(std::vector<const ModelRoot*>& roots) const {
  roots.push_back(root_);
  if (special_) roots.insert(roots.end(), special_->later_roots.begin(), special_->later_roots.end());
}

// A ray in the instance's frame is rounded by up to 2^-24 of where it is outside, some times.
Bounds3f Instance::known_bounds() const {
  Bounds3f known = root_->known_bounds();
  if (special_)
    for (const ModelRoot* root : special_->later_roots) known.extend(root->known_bounds());
  if (is_identity() || known.empty()) return known;
  const Bounds3d exact{Vec3d(known.lower), Vec3d(known.upper)};
  const Bounds3d placed =
      special_ && special_->motion ? special_->motion->bounds(exact) : to_double(from_parent_).inverse().bounds(exact);
  const double farthest = std::max(max_component(abs(placed.lower)), max_component(abs(placed.upper)));
  return round_outwards(placed.inflated(Vec3d(0x1p-20 * farthest)));
}

const ModelRoot& Instance::root_at(float time) const {
  if (!special_ || special_->later_roots.empty()) return *root_;
  const std::size_t later = special_->later_roots.size();
  const std::size_t moment = std::min(std::size_t(std::max(time, 0.f) * float(later + 1)), later);
  return moment == 0 ? *root_ : *special_->later_roots[moment - 1];
}

Affine3f Instance::from_parent_at(float time) const {
  return special_ && special_->motion ? to_float(special_->motion->at(time).inverse()) : from_parent_;
}

Instance::Visit::Visit(const Instance& instance, const Place& place, RayContext& context, RTCRayHit& outside)
    : root_(instance.root_at(outside.ray.time)),
      context_(context),
      outside_(outside),
      outer_path_(context.path),
      outer_tree_(context.tree_ray) {
  context.path = hash_keys(context.path, place.path);
  if (place.object >= 0) context.object = place.object;
  if (instance.is_identity()) return;
  from_parent_ = instance.from_parent_at(outside.ray.time);
  frame_ = {&from_parent_, context.frame};
  context.frame = &frame_;
  inside_ = outside;
  transform(from_parent_, inside_.ray);
  tree_.emplace(tree_ray(inside_.ray));
  context.tree_ray = &*tree_;
}

Instance::Visit::~Visit() {
  context_.path = outer_path_;
  if (!tree_) return;
  context_.frame = frame_.parent;
  context_.tree_ray = outer_tree_;
  outside_.ray.tfar = inside_.ray.tfar;
  outside_.hit = inside_.hit;
}

void Instance::intersect(const Place& place, RayContext& context, RTCRayHit& ray) const {
  Visit visit(*this, place, context, ray);
  visit.root().intersect(context, visit.ray());
}

bool Instance::follow(CellList::Way way, const Place& place, RayContext& context, RTCRayHit& ray) const {
  Visit visit(*this, place, context, ray);
  return visit.root().follow(way, context, visit.ray());
}

void Instance::occluded(RayContext& context, RTCRay& ray) const {
  const ModelRoot& root = root_at(ray.time);
  if (is_identity()) return root.occluded(context, ray);
  RTCRay local = ray;
  transform(from_parent_at(ray.time), local);
  const TreeRay tree(tree_ray(local));
  const TreeRay* const outer = std::exchange(context.tree_ray, &tree);
  root.occluded(context, local);
  context.tree_ray = outer;
  ray.tfar = local.tfar;
}

Instances::Instances(std::vector<Instance> instances, std::span<const Bounds3f> bounds,
                     std::vector<std::unique_ptr<ModelRoot>> owned, bool are_objects, std::uint32_t first)
    : instances_(std::move(instances)), owned_(std::move(owned)), are_objects_(are_objects), first_(first) {
  bytes_ = sizeof(*this) + instances_.capacity() * sizeof(Instance);
  for (const auto& root : owned_) bytes_ += root->bytes() + sizeof(root);
  for (const Instance& i : instances_) bytes_ += i.bytes_beside();
  for (const Bounds3f& b : bounds) bounds_.extend(b);
  if (instances_.size() < 2) return;
  scene_ = std::make_unique<BoxScene>(bounds, BoxContents{this, intersect_one, occlude_one});
  bytes_ += scene_->bytes();
}

void Instances::tighten() {
  if (!scene_) return;
  std::vector<Bounds3f> boxes;
  boxes.reserve(instances_.size());
  for (const Instance& i : instances_) boxes.push_back(i.known_bounds());
  const auto same = [](const Bounds3f& a, const Bounds3f& b) { return a.lower == b.lower && a.upper == b.upper; };
  if (std::ranges::equal(boxes, tightened_, same)) return;
  auto tight = std::make_unique<BoxScene>(boxes, BoxContents{this, intersect_one, occlude_one});
  bytes_ -= scene_->bytes() + tightened_.capacity() * sizeof(Bounds3f);
  scene_ = std::move(tight);
  tightened_ = std::move(boxes);
  bytes_ += scene_->bytes() + tightened_.capacity() * sizeof(Bounds3f);
}

std::vector<Bounds3f> Instances::few_boxes() const {
  if (scene_) return scene_->few_boxes();
  return std::vector<Bounds3f>(instances_.size(), bounds_);
}

std::vector<const ModelRoot*> Instances::roots() const {
  std::vector<const ModelRoot*> result;
  for (const Instance& i : instances_) i.add_roots(result);
  return result;
}

void Instances::intersect(std::uint32_t index, RayContext& context, RTCRayHit& ray) const {
  const WayStep step(context, index);
  instances_[index].intersect(place_of(index), context, ray);
}

void Instances::occluded(std::uint32_t index, RayContext& context, RTCRay& ray) const {
  const WayStep step(context, index);
  instances_[index].occluded(context, ray);
}

void Instances::intersect_one(void* self, std::uint32_t index, RayContext& context, RTCRayHit& ray) {
  static_cast<const Instances*>(self)->intersect(index, context, ray);
}

void Instances::occlude_one(void* self, std::uint32_t index, RayContext& context, RTCRay& ray) {
  static_cast<const Instances*>(self)->occluded(index, context, ray);
}

void Instances::intersect(RayContext& context, RTCRayHit& ray) const {
  if (scene_) return scene_->intersect(context, ray);
  if (!instances_.empty()) intersect(0, context, ray);
}

void Instances::occluded(RayContext& context, RTCRay& ray) const {
  if (scene_) return scene_->occluded(context, ray);
  if (!instances_.empty()) occluded(0, context, ray);
}

std::optional<std::size_t> Instances::entered(const TreeRay& ray, float t_min, float t_max,
                                              FewBoxes::List& list) const {
  if (scene_) return scene_->entered(ray, t_min, t_max, list);
  list[0] = {t_min, 0};
  return instances_.size();
}

bool Instances::follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const {
  const WayStep step(context, way[0]);
  return instances_[way[0]].follow(way.subspan(1), place_of(way[0]), context, ray);
}

}  // namespace meristem
