#include "geometry/accel/instances.h"

#include <utility>

namespace meristem {

namespace {

Affine3f to_float(const Affine3d& m) { return {Vec3f(m.x), Vec3f(m.y), Vec3f(m.z), Vec3f(m.origin)}; }

// The ray in the frame of an instance; its direction keeps its length, so t is the same in both.
void transform(const Affine3f& m, RTCRay& ray) {
  const Vec3f o = m.point({ray.org_x, ray.org_y, ray.org_z});
  const Vec3f d = m.vector({ray.dir_x, ray.dir_y, ray.dir_z});
  ray.org_x = o.x, ray.org_y = o.y, ray.org_z = o.z;
  ray.dir_x = d.x, ray.dir_y = d.y, ray.dir_z = d.z;
}

// The state of the ray while it is inside an instance.
class Inside {
 public:
  Inside(RayContext& context, const Affine3f* to_parent, Key path, int object)
      : context_(context), frame_{to_parent, context.frame}, previous_path_(context.path) {
    if (to_parent) context.frame = &frame_;
    context.path = hash_keys(context.path, path);
    if (object >= 0) context.object = object;
  }
  ~Inside() {
    context_.frame = frame_.to_parent ? frame_.parent : context_.frame;
    context_.path = previous_path_;
  }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

 private:
  RayContext& context_;
  const RayContext::Frame frame_;
  const Key previous_path_;
};

// What stands in the boxes of instances; `owner` is their Instances.
void intersect_instance(void* owner, std::uint32_t index, RayContext& context, RTCRayHit& ray) {
  const WayStep step(context, index);
  static_cast<const Instances*>(owner)->list()[index].intersect(context, ray);
}

void occluded_instance(void* owner, std::uint32_t index, RayContext& context, RTCRay& ray) {
  const WayStep step(context, index);
  static_cast<const Instances*>(owner)->list()[index].occluded(context, ray);
}

}  // namespace

Instance::Maps Instance::maps_of(const Affine3d& to_parent) {
  return {to_float(to_parent), to_float(to_parent.inverse())};
}

Instance::Instance(std::vector<const ModelRoot*> roots, const Placement& placement, Key path, int object)
    : root_(roots[0]),
      maps_(maps_of(placement.to_parent)),
      path_(path),
      object_(object),
      is_identity_(placement.to_parent.is_identity() && !placement.motion) {
  for (const ModelRoot* root : roots) bounds_.extend(root->bounds());
  if (!is_identity_) bounds_ = bounds_in_parent(placement, bounds_);
  if (roots.size() > 1 || placement.motion)
    change_ = std::make_unique<const Change>(Change{std::move(roots), placement.motion});
}

void Instance::add_roots(std::vector<const ModelRoot*>& roots) const {
  if (change_)
    roots.insert(roots.end(), change_->roots.begin(), change_->roots.end());
  else
    roots.push_back(root_);
}

const ModelRoot& Instance::root_at(float time) const {
  if (!change_) return *root_;
  const auto moment = std::size_t(std::max(time, 0.f) * float(change_->roots.size()));
  return *change_->roots[std::min(moment, change_->roots.size() - 1)];
}

template <class Trace>
void Instance::with_local_ray(RayContext& context, RTCRayHit& ray, const Trace& trace) const {
  const ModelRoot& root = root_at(ray.ray.time);
  std::optional<Maps> moved;
  if (moves()) moved = maps_of(change_->motion->at(ray.ray.time));
  const Maps& maps = moved ? *moved : maps_;
  const Inside inside(context, is_identity_ ? nullptr : &maps.to_parent, path_, object_);
  if (is_identity_) return trace(root, ray);
  RTCRayHit local = ray;
  transform(maps.from_parent, local.ray);
  const TreeRay tree(tree_ray(local.ray));
  const TreeRay* const outer = std::exchange(context.tree_ray, &tree);
  trace(root, local);
  context.tree_ray = outer;
  ray.ray.tfar = local.ray.tfar;
  ray.hit = local.hit;
}

void Instance::intersect(RayContext& context, RTCRayHit& ray) const {
  with_local_ray(context, ray, [&](const ModelRoot& root, RTCRayHit& local) { root.intersect(context, local); });
}

bool Instance::follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const {
  bool arrives = false;
  with_local_ray(context, ray,
                 [&](const ModelRoot& root, RTCRayHit& local) { arrives = root.follow(way, context, local); });
  return arrives;
}

void Instance::occluded(RayContext& context, RTCRay& ray) const {
  const ModelRoot& root = root_at(ray.time);
  if (is_identity_) return root.occluded(context, ray);
  RTCRay local = ray;
  transform(moves() ? maps_of(change_->motion->at(ray.time)).from_parent : maps_.from_parent, local);
  const TreeRay tree(tree_ray(local));
  const TreeRay* const outer = std::exchange(context.tree_ray, &tree);
  root.occluded(context, local);
  context.tree_ray = outer;
  ray.tfar = local.tfar;
}

Instances::Instances(std::vector<Instance> instances, std::vector<std::unique_ptr<ModelRoot>> owned)
    : instances_(std::move(instances)), owned_(std::move(owned)) {
  bytes_ = sizeof(*this) + instances_.capacity() * sizeof(Instance);
  for (const auto& root : owned_) bytes_ += root->bytes() + sizeof(root);
  for (const Instance& i : instances_) bounds_.extend(i.bounds()), bytes_ += i.own_bytes();
  if (instances_.size() < 2) return;
  std::vector<Bounds3f> boxes;
  for (const Instance& i : instances_) boxes.push_back(i.bounds());
  scene_.emplace(boxes, BoxContents{this, intersect_instance, occluded_instance});
  bytes_ += scene_->bytes();
}

std::vector<const ModelRoot*> Instances::roots() const {
  std::vector<const ModelRoot*> result;
  for (const Instance& i : instances_) i.add_roots(result);
  return result;
}

void Instances::intersect(RayContext& context, RTCRayHit& ray) const {
  if (scene_) return scene_->intersect(context, ray);
  if (instances_.empty()) return;
  const WayStep step(context, 0);
  instances_[0].intersect(context, ray);
}

void Instances::occluded(RayContext& context, RTCRay& ray) const {
  if (scene_) return scene_->occluded(context, ray);
  if (instances_.empty()) return;
  const WayStep step(context, 0);
  instances_[0].occluded(context, ray);
}

bool Instances::follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const {
  const WayStep step(context, way[0]);
  return instances_[way[0]].follow(way.subspan(1), context, ray);
}

}  // namespace meristem
