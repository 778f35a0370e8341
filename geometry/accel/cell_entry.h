// CellEntry: a cell as long as it is resident. The work on it is done by the root that it belongs to.
#pragma once

#include "geometry/accel/grove.h"
#include "geometry/accel/instances.h"
#include "geometry/accel/leaf_store.h"
#include "geometry/accel/proxy_scene.h"
#include "geometry/cells/expansion.h"

#include <memory>
#include <vector>

namespace meristem {

class LazyRoot;

// A resident cell: a surface patch, child cells behind a scene of their bounds, or placed parts. What stands on a cell
// of ground may be child cells as well: a grove.
class CellEntry : public CacheEntry {
 public:
  CellEntry(std::unique_ptr<SurfacePatch> patch, Key key);
  // Of ground several entries share the cell, each with bounds of its children of its own; of what else there is these
  // are empty.
  CellEntry(const LazyRoot& root, std::shared_ptr<const InnerCell> inner, std::vector<Bounds3f> furnished_bounds,
            std::shared_ptr<KnownChildren> known);
  CellEntry(const LazyRoot& root, Grove grove);
  CellEntry() = default;
  // What is placed may name the entry as its owner, so it comes in afterwards.
  void set_instances(std::unique_ptr<Instances> instances);

  void intersect(RayContext& context, RTCRayHit& ray);
  void occluded(RayContext& context, RTCRay& ray);

  // Where the surface goes when it is evicted.
  void set_store(const std::shared_ptr<LeafStore>& store) { store_ = store; }
  void forgotten() override {
    if (store_) store_->keep(name, *patch_, label);
  }

  // As ModelRoot::follow(): the way goes on with one of the children or instances, or ends here.
  bool follow(CellList::Way way, RayContext& context, RTCRayHit& ray);

  const LazyRoot& root() const { return *root_; }
  const SurfacePatch* patch() const { return patch_.get(); }
  Key key() const { return key_; }                         // of a surface
  const InnerCell* inner() const { return inner_.get(); }  // null: not split, or a grove
  const Grove* grove() const { return grove_ ? &*grove_ : nullptr; }
  // Of a cell that was split, before anything is known of its children.
  const std::vector<Bounds3f>& child_bounds() const {
    return furnished_bounds_.empty() ? inner_->child_bounds : furnished_bounds_;
  }
  std::size_t child_count() const { return child_count_; }
  const Instances* instances() const { return instances_.get(); }
  Instances* instances() { return instances_.get(); }
  CacheSlot& slot(std::size_t child) { return slots_[child]; }
  bool has_proxies() const { return proxies_ != nullptr; }
  ProxyScene& proxies() { return *proxies_; }
  // What stands in the boxes of its children, by their numbers.
  BoxContents contents();
  // Of a surface or of placed parts: their own. Of child cells: the union of their bounds before expansion.
  const Bounds3f& real_bounds() const { return real_bounds_; }
  // Small boxes that hold all of it; none if they would not be few.
  std::vector<Bounds3f> boxes() const;

 private:
  void set_children(std::span<const Bounds3f> bounds, std::shared_ptr<KnownChildren> known);

  std::unique_ptr<SurfacePatch> patch_;
  Key key_ = 0;
  Bounds3f real_bounds_;
  const LazyRoot* root_ = nullptr;
  std::shared_ptr<const InnerCell> inner_;
  std::vector<Bounds3f> furnished_bounds_;  // of its children; none: they are those of inner_
  std::optional<Grove> grove_;
  std::size_t child_count_ = 0;
  std::unique_ptr<CacheSlot[]> slots_;
  std::unique_ptr<ProxyScene> proxies_;
  std::unique_ptr<Instances> instances_;
  std::shared_ptr<LeafStore> store_;  // of its root, which it may outlive; only of a surface
};

RaySpan span_of(const RTCRay& ray);

}  // namespace meristem
