#include "geometry/accel/braided_cells.h"

namespace meristem {

class BraidedCells::Nearest final : public BraidVisitor {
 public:
  Nearest(const BraidedCells& cells, RayContext& context, RTCRayHit& ray)
      : BraidVisitor(ray.ray.tfar), cells_(cells), context_(context), ray_(ray) {}
  void met(std::uint32_t tree, const TreeHit& hit) override {
    const Surface& surface = cells_.surfaces_[tree];
    take_hit(*surface.patch, surface.key, hit, context_, ray_.ray);
    t_max = ray_.ray.tfar;
  }
  void enter(std::uint32_t other) override {
    const Other& o = cells_.others_[other];
    o.contents.intersect(o.contents.owner, o.box, context_, ray_);
    t_max = ray_.ray.tfar;
  }

 private:
  const BraidedCells& cells_;
  RayContext& context_;
  RTCRayHit& ray_;
};

class BraidedCells::Any final : public BraidVisitor {
 public:
  Any(const BraidedCells& cells, RayContext& context, RTCRay& ray)
      : BraidVisitor(ray.tfar), cells_(cells), context_(context), ray_(ray) {}
  void enter(std::uint32_t other) override {
    const Other& o = cells_.others_[other];
    o.contents.occluded(o.contents.owner, o.box, context_, ray_);
    t_max = ray_.tfar;
  }

 private:
  const BraidedCells& cells_;
  RayContext& context_;
  RTCRay& ray_;
};

Braid BraidedCells::braid(const std::vector<Surface>& surfaces, const std::vector<Other>& others) {
  std::vector<Braid::Tree> trees;
  for (const Surface& s : surfaces) trees.push_back({&s.patch->tree(), s.patch->tessellation().positions.data()});
  std::vector<Bounds3f> boxes;
  for (const Other& o : others) boxes.push_back(o.bounds);
  return {trees, boxes};
}

BraidedCells::BraidedCells(std::vector<Surface> surfaces, std::vector<Other> others)
    : surfaces_(std::move(surfaces)), others_(std::move(others)), braid_(braid(surfaces_, others_)) {}

void BraidedCells::intersect(RayContext& context, RTCRayHit& ray) const {
  Nearest visitor(*this, context, ray);
  braid_.intersect(*context.tree_ray, ray.ray.tnear, visitor);
}

void BraidedCells::occluded(RayContext& context, RTCRay& ray) const {
  Any visitor(*this, context, ray);
  if (braid_.occluded(*context.tree_ray, ray.tnear, visitor)) ray.tfar = -std::numeric_limits<float>::infinity();
}

std::size_t BraidedCells::bytes() const {
  return sizeof(*this) + braid_.bytes() + surfaces_.capacity() * sizeof(Surface) + others_.capacity() * sizeof(Other);
}

}  // namespace meristem
