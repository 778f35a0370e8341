#include "geometry/accel/cell_entry.h"

#include "geometry/accel/lazy_root.h"

namespace meristem {

namespace {

// While one lives, its ray is in a cell.
class InUse {
 public:
  InUse(RayContext& context, CacheEntry& cell) : context_(context), used_{&cell, context.use.cells} {
    context.use.cells = &used_;
  }
  ~InUse() { context_.use.cells = used_.outer; }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  RayContext& context_;
  const UsedEntry used_;
};

// What an entry costs by resident set: between arrays that come and go malloc leaves gaps that it cannot use.
std::size_t with_gaps(std::size_t bytes) { return bytes + bytes / 8; }

// What stands in the boxes of child cells; `parent` is their CellEntry.
void intersect_child(void* parent, std::uint32_t index, RayContext& context, RTCRayHit& ray) {
  auto& entry = *static_cast<CellEntry*>(parent);
  if (CellEntry* cell = entry.root().entered_child(entry, index, context, ray.ray)) {
    const WayStep step(context, index);
    if (context.visits) ++context.visits[cell->label.cell_class];
    cell->intersect(context, ray);
  }
}

void occluded_child(void* parent, std::uint32_t index, RayContext& context, RTCRay& ray) {
  auto& entry = *static_cast<CellEntry*>(parent);
  if (CellEntry* cell = entry.root().entered_child(entry, index, context, ray)) {
    const WayStep step(context, index);
    if (context.visits) ++context.visits[cell->label.cell_class];
    cell->occluded(context, ray);
  }
}

}  // namespace

RaySpan span_of(const RTCRay& ray) {
  return {{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}, ray.tnear, ray.tfar};
}

CellEntry::CellEntry(std::unique_ptr<SurfacePatch> patch, Key key)
    : patch_(std::move(patch)), key_(key), real_bounds_(patch_->vertices().bounds()) {
  bytes = with_gaps(patch_->bytes() + sizeof(*this));
  label.is_surface = true;
  label.tree_bytes = sizeof(SurfacePatch) + patch_->tree().bytes();
}

// A cell that is shared counts with each of those that share it, since any of them may keep it for the longest.
CellEntry::CellEntry(const LazyRoot& root, std::shared_ptr<const InnerCell> inner,
                     std::vector<Bounds3f> furnished_bounds, std::shared_ptr<KnownChildren> known)
    : root_(&root), inner_(std::move(inner)), furnished_bounds_(std::move(furnished_bounds)) {
  set_children(child_bounds(), std::move(known));
  bytes = with_gaps(proxies_->bytes() + inner_->bytes() + furnished_bounds_.capacity() * sizeof(Bounds3f) +
                    child_count_ * sizeof(CacheSlot) + sizeof(*this));
}

CellEntry::CellEntry(const LazyRoot& root, Grove grove) : root_(&root), grove_(std::move(grove)) {
  const std::vector<Bounds3f>& bounds = grove_->bounds();
  set_children(bounds, std::make_shared<KnownChildren>(bounds.size()));
  bytes = with_gaps(proxies_->bytes() + grove_->bytes() + child_count_ * sizeof(CacheSlot) + sizeof(*this));
}

void CellEntry::set_children(std::span<const Bounds3f> bounds, std::shared_ptr<KnownChildren> known) {
  child_count_ = bounds.size();
  slots_ = std::make_unique<CacheSlot[]>(child_count_);
  for (const Bounds3f& b : bounds) real_bounds_.extend(b);
  proxies_ = std::make_unique<ProxyScene>(bounds, contents(), std::move(known));
  label.tree_bytes = proxies_->bytes();
}

void CellEntry::set_instances(std::unique_ptr<Instances> instances) {
  instances_ = std::move(instances);
  real_bounds_ = instances_->bounds();
  bytes = with_gaps(instances_->bytes() + sizeof(*this));
  label.tree_bytes = bytes;
}

BoxContents CellEntry::contents() { return {this, intersect_child, occluded_child}; }

void CellEntry::intersect(RayContext& context, RTCRayHit& ray) {
  const InUse in_use(context, *this);
  if (patch_) {
    if (intersect_patch(*patch_, key_, context, ray.ray)) context.use.nearest = this;
  } else if (proxies_) {
    proxies_->scene().intersect(context, ray);
  } else {
    instances_->intersect(context, ray);
  }
}

void CellEntry::occluded(RayContext& context, RTCRay& ray) {
  const InUse in_use(context, *this);
  if (patch_)
    occlude_with_patch(*patch_, context, ray);
  else if (proxies_)
    proxies_->scene().occluded(context, ray);
  else
    instances_->occluded(context, ray);
}

std::vector<Bounds3f> CellEntry::boxes() const {
  std::vector<Bounds3f> boxes;
  if (patch_)
    for (const SurfaceTree::Part& p : patch_->tree().parts(Outline::most_boxes)) boxes.push_back(p.box);
  else if (inner_)
    boxes = child_bounds();
  else if (grove_)
    boxes = grove_->bounds();
  else
    boxes = instances_->few_boxes();
  if (boxes.size() > Outline::most_boxes) boxes.clear();
  return boxes;
}

bool CellEntry::follow(CellList::Way way, RayContext& context, RTCRayHit& ray) {
  if (way.empty()) {
    if (context.visits) ++context.visits[label.cell_class];
    if (context.search->any)
      occluded(context, ray.ray);
    else
      intersect(context, ray);
    return true;
  }
  const InUse in_use(context, *this);
  if (instances_) return instances_->follow(way, context, ray);
  const WayStep step(context, way[0]);
  ++context.acquired;
  CacheSlot& slot = slots_[way[0]];
  CellEntry* cell = root_->found(slot);
  if (!cell) {
    // It may be better known since it was noted, and the ray shorter
    const float entry = proxies_->entry(way[0], span_of(ray.ray));
    if (!enters(entry, ray.ray.tfar)) return true;
    if (context.search->expands) cell = root_->child(*this, way[0], context.use);
    if (!cell) {
      if (slot.state() == CacheSlot::State::Failed) return true;
      return way.size() == 1 && root_->note_child_anew(*this, way[0], entry, ray.ray, *context.search);
    }
  }
  return cell->follow(way.subspan(1), context, ray);
}

}  // namespace meristem
