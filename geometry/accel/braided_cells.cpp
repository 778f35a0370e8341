#include "geometry/accel/braided_cells.h"

#include "geometry/accel/box_visitors.h"

namespace meristem {

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

void BraidedCells::intersect_other(std::uint32_t index, RayContext& context, RTCRayHit& ray) const {
  const Other& other = others_[index];
  other.contents.intersect(other.contents.owner, other.box, context, ray);
}

void BraidedCells::occlude_other(std::uint32_t index, RayContext& context, RTCRay& ray) const {
  const Other& other = others_[index];
  other.contents.occluded(other.contents.owner, other.box, context, ray);
}

void BraidedCells::intersect_box(void* self, std::uint32_t index, RayContext& context, RTCRayHit& ray) {
  static_cast<const BraidedCells*>(self)->intersect_other(index, context, ray);
}

void BraidedCells::occlude_box(void* self, std::uint32_t index, RayContext& context, RTCRay& ray) {
  static_cast<const BraidedCells*>(self)->occlude_other(index, context, ray);
}

Braid BraidedCells::braid(const std::vector<Surface>& surfaces, const std::vector<Other>& others) {
  std::vector<Braid::Tree> trees;
  for (const Surface& s : surfaces) trees.push_back({&s.patch->tree(), s.patch->tessellation().positions.data()});
  std::vector<Bounds3f> boxes;
  for (const Other& o : others) boxes.push_back(o.bounds);
  return {trees, boxes};
}

BraidedCells::BraidedCells(std::vector<Surface> surfaces, std::vector<Other> others)
    : surfaces_(std::move(surfaces)),
      others_(std::move(others)),
      contents_{this, intersect_box, occlude_box},
      braid_(braid(surfaces_, others_)) {}

void BraidedCells::intersect(RayContext& context, RTCRayHit& ray) const {
  Nearest visitor(*this, contents_, context, ray);
  braid_.intersect(*context.tree_ray, ray.ray.tnear, visitor);
}

void BraidedCells::occluded(RayContext& context, RTCRay& ray) const {
  AnyInBoxes visitor(contents_, context, ray);
  if (braid_.occluded(*context.tree_ray, ray.tnear, visitor)) ray.tfar = -std::numeric_limits<float>::infinity();
}

std::size_t BraidedCells::bytes() const {
  return sizeof(*this) + braid_.bytes() + surfaces_.capacity() * sizeof(Surface) + others_.capacity() * sizeof(Other);
}

}  // namespace meristem
