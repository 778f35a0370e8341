// Models for tests of cells and worlds: closed cages with displaced subdivision in plain C++ (no expressions).
#pragma once

#include "geometry/cells/model.h"
#include "geometry/mesh/refine.h"
#include "tests/support/shapes.h"

#include <memory>

namespace meristem {

// Catmull-Clark, then an offset along the local normal by amplitude * local scale * a number in [-1, 1] hashed from the
// vertex.
class BumpyStep final : public Step {
 public:
  BumpyStep(double amplitude, Key key) : amplitude_(amplitude), key_(key) {}
  std::string name() const override { return "bumpy"; }
  int halo_rings(int rings_after) const override { return refine_halo_rings(rings_after); }
  std::uint32_t max_children(std::uint32_t corners) const override { return corners; }
  bool displaces() const override { return amplitude_ != 0; }
  bool refines() const override { return true; }
  std::optional<RefineOptions> refinement() const override { return RefineOptions{}; }
  void set_quantum(const Quantum& quantum) override { quantum_ = quantum; }

  void apply(const CellMesh& in, int rings_after, CellMesh& out) const override {
    const auto plan = shared_refine_plan(in.mesh, in.owned_faces, rings_after, {});
    RefinedMesh refined = refine(in.mesh, *plan, quantum_, key_);
    const LocalGeometry local = local_geometry(*plan, refined, quantum_, false);
    out.owned_faces = plan->owned_faces;
    out.rings = plan->rings;
    out.labels.clear();
    if (!in.labels.empty())
      for (std::uint32_t f = 0; f < plan->owned_faces; ++f) out.labels.push_back(in.labels[plan->face_parents[f]]);
    out.mesh = std::move(refined.mesh);
    for (std::size_t i = 0; i < out.mesh.positions.size(); ++i) {
      const double r = 2 * uniform_double(hash_keys(out.mesh.vertex_keys[i], key_)) - 1;
      out.mesh.positions[i] =
          quantum_.round(out.mesh.positions[i] + local.normals[i] * (amplitude_ * local.scales[i] * r));
    }
  }

  Extent bound(const Extent& e) const override {
    Extent after = e;
    const double offset = amplitude_ * e.refined_scale();
    after.refine(Vec3d(-offset), Vec3d(offset), offset);
    return after;
  }

 private:
  double amplitude_;
  Key key_;
  Quantum quantum_;
};

inline std::shared_ptr<const Model> bumpy_model(Mesh base, int levels, double amplitude, CellSettings settings = {}) {
  std::vector<std::unique_ptr<Step>> steps;
  for (int i = 0; i < levels; ++i)
    steps.push_back(std::make_unique<BumpyStep>(i % 2 ? amplitude : amplitude / 2, hash_keys(77, i)));
  return std::make_shared<const Model>("bumpy", std::move(base), std::move(steps), settings);
}

}  // namespace meristem
