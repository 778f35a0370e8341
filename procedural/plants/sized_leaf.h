// SizedLeaf: a shape of leaves in the size that it has on one stem, and where the vertices of a group of its leaves
// are. For one thread.
#pragma once

#include "procedural/plants/child_kernels.h"
#include "procedural/plants/plant_detail.h"
#include "procedural/plants/plant_mesh.h"

#include <vector>

namespace meristem {

class SizedLeaf {
 public:
  // The shape must outlive it.
  void set(const LeafShape& shape, const PlantDetail& detail) {
    shape_ = &shape;
    vertices_.clear();
    for (Vec3d v : shape.vertices)
      vertices_.push_back({v.x * detail.leaf_width, v.y * detail.leaf_length, v.z * detail.leaf_length});
    placed_.resize(3 * vertices_.size() * ChildRows::group);
  }

  void make_room(std::size_t leaves, PlantMesh& mesh) const {
    mesh.make_room(std::uint32_t(leaves * vertices_.size()), std::uint32_t(leaves * shape_->face_count()),
                   std::uint32_t(leaves * shape_->corners.size()));
  }

  // The group of leaves from `first` on, a multiple of its size; moved along their z.
  void place(const ChildRows::View& leaves, std::size_t first, double forward, const Quantum& quantum) {
    best_child_kernels().put_vertices(leaves, first, {vertices_.data(), vertices_.size(), forward, quantum.magic()},
                                      placed_.data());
  }

  // A leaf of that group.
  void add_to(PlantMesh& mesh, std::size_t leaf) const {
    const double* const placed = placed_.data() + leaf % ChildRows::group;
    mesh.add_leaf(*shape_, [&](std::size_t v) {
      const double* const p = placed + 3 * v * ChildRows::group;
      return Vec3d{p[0], p[ChildRows::group], p[2 * ChildRows::group]};
    });
  }

 private:
  const LeafShape* shape_ = nullptr;
  std::vector<Vec3d> vertices_;
  std::vector<double> placed_;
};

}  // namespace meristem
