#include "geometry/accel/braided_cells.h"

#include "geometry/accel/box_visitors.h"

namespace meristem {

namespace {

template <class T>
std::vector<T> exact(std::vector<T>& list) {
  list.shrink_to_fit();
  return std::move(list);
}

}  // namespace

void BraidedCells::Strands::add(const Instances& instances) {
  for (std::uint32_t i = 0; i < instances.count(); ++i) placed.push_back({&instances, i});
}

class BraidedCells::Nearest final : public NearestInBoxes {
 public:
  Nearest(const BraidedCells& cells, const BoxContents& contents, RayContext& context, RTCRayHit& ray)
      : NearestInBoxes(contents, context, ray), cells_(cells) {}
  void met(std::uint32_t tree, const TreeHit& hit) override {
    cells_.met(tree, hit, context_, ray_.ray);
    t_max = ray_.ray.tfar;
  }

 private:
  const BraidedCells& cells_;
};

void BraidedCells::met(std::uint32_t tree, const TreeHit& hit, RayContext& context, RTCRay& ray) const {
  const Surface& surface = surfaces_[tree];
  surface.patch->prefetch(hit);
  take_hit(*surface.patch, surface.key, hit, context, ray);
}

void BraidedCells::intersect_other(std::uint32_t other, RayContext& context, RTCRayHit& ray) const {
  if (other < placed_.size()) return placed_[other].all->intersect(placed_[other].index, context, ray);
  const Missing& missing = missing_[other - placed_.size()];
  missing.contents.intersect(missing.contents.owner, missing.box, context, ray);
}

void BraidedCells::occlude_other(std::uint32_t other, RayContext& context, RTCRay& ray) const {
  if (other < placed_.size()) return placed_[other].all->occluded(placed_[other].index, context, ray);
  const Missing& missing = missing_[other - placed_.size()];
  missing.contents.occluded(missing.contents.owner, missing.box, context, ray);
}

void BraidedCells::intersect_box(void* self, std::uint32_t index, RayContext& context, RTCRayHit& ray) {
  static_cast<const BraidedCells*>(self)->intersect_other(index, context, ray);
}

void BraidedCells::occlude_box(void* self, std::uint32_t index, RayContext& context, RTCRay& ray) {
  static_cast<const BraidedCells*>(self)->occlude_other(index, context, ray);
}

BraidedCells::BraidedCells(Strands strands)
    : surfaces_(exact(strands.surfaces)),
      placed_(exact(strands.placed)),
      missing_(exact(strands.missing)),
      contents_{this, intersect_box, occlude_box},
      braid_(braid()) {}

Braid BraidedCells::braid() const {
  std::vector<Braid::Tree> trees;
  trees.reserve(surfaces_.size());
  for (const Surface& s : surfaces_) trees.push_back({&s.patch->tree(), s.patch->positions()});
  std::vector<Bounds3f> boxes;
  boxes.reserve(placed_.size() + missing_.size());
  for (const Placed& p : placed_) boxes.push_back(p.all->instance(p.index).known_bounds());
  for (const Missing& m : missing_) boxes.push_back(m.bounds);
  return {trees, boxes};
}

void BraidedCells::intersect(RayContext& context, RTCRayHit& ray) const {
  Nearest visitor(*this, contents_, context, ray);
  braid_.intersect(*context.tree_ray, ray.ray.tnear, visitor);
}

void BraidedCells::occluded(RayContext& context, RTCRay& ray) const {
  AnyInBoxes visitor(contents_, context, ray);
  if (braid_.occluded(*context.tree_ray, ray.tnear, visitor)) ray.tfar = -std::numeric_limits<float>::infinity();
}

std::size_t BraidedCells::bytes() const {
  return sizeof(*this) + braid_.bytes() + surfaces_.capacity() * sizeof(Surface) + placed_.capacity() * sizeof(Placed) +
         missing_.capacity() * sizeof(Missing);
}

}  // namespace meristem
