#include "geometry/accel/known_cells.h"
#include "geometry/accel/model_root.h"
#include "geometry/base/parallel.h"

#include <chrono>

namespace meristem {

namespace {

class FlatRoot final : public ModelRoot {
 public:
  // The bounds are those a lazy root has, so that whatever depends on the scene's size is the same in every mode.
  FlatRoot(Tessellation tessellation, const Model& model, const Bounds3f& bounds)
      : ModelRoot(bounds),
        patch_(std::move(tessellation), true),
        key_(hash_text(model.name())),
        passage_(patch_, key_) {}
  void intersect(RayContext& context, RTCRayHit& ray) const override {
    intersect_patch(patch_, key_, context, ray.ray);
  }
  void occluded(RayContext& context, RTCRay& ray) const override { occlude_with_patch(patch_, context, ray); }
  std::size_t bytes() const override { return sizeof(*this) + patch_.bytes(); }
  Bounds3f known_bounds() const override {
    constexpr std::size_t few = 8;
    Bounds3f known;
    for (const SurfaceTree::Part& part : patch_.tree().parts(few)) known.extend(part.box);
    return with_rounding_margin(known);
  }

  const Passage* passage() const override { return patch_.tree().nodes().empty() ? nullptr : &passage_; }

 private:
  SurfacePatch patch_;
  Key key_;
  SurfacePassage passage_;
};

void append(Tessellation& all, const Tessellation& part) {
  const auto first_vertex = std::uint32_t(all.positions.size());
  const auto first_origin = std::uint32_t(all.origins.size());
  const auto first_leaf = std::uint32_t(all.leaves.size());
  all.has_uv |= part.has_uv;
  all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
  all.attributes.insert(all.attributes.end(), part.attributes.begin(), part.attributes.end());
  all.leaves.insert(all.leaves.end(), part.leaves.begin(), part.leaves.end());
  all.origins.append(part.origins);
  for (Tessellation::Grid g : part.grids)
    all.grids.push_back(
        {g.first_vertex + first_vertex, g.width, g.height, g.origin + first_origin, g.leaf + first_leaf, g.coarser});
  for (const auto& t : part.triangles)
    all.triangles.push_back({t[0] + first_vertex, t[1] + first_vertex, t[2] + first_vertex});
  for (Tessellation::TriangleSource s : part.triangle_sources)
    all.triangle_sources.push_back({s.origin + first_origin, s.leaf + first_leaf});
  all.face_count += part.face_count;
}

// Expands the tree of cells below one, appending every final surface in the order of the cells.
class Flattener {
 public:
  Flattener(const Model& model, ExpansionCounts& counts, const UvReaders& uv_readers, int threads)
      : model_(model), counts_(counts), uv_readers_(uv_readers), threads_(threads) {}

  Tessellation flatten(CellMesh cell, int level) {
    const auto start = std::chrono::steady_clock::now();
    Expansion expansion = expand(model_, std::move(cell), level, uv_readers_);
    counts_.add(model_, expansion, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    if (expansion.leaf) {
      expansion.leaf->positions.shrink_to_fit();
      expansion.leaf->attributes.shrink_to_fit();
      return std::move(*expansion.leaf);
    }
    const InnerCell& inner = *expansion.inner;
    std::vector<Tessellation> parts(inner.child_count());
    auto flatten_child = [&](std::size_t i) { parts[i] = flatten(child_cell(model_, inner, i), inner.level); };
    if (threads_ > 1)
      parallel_for(parts.size(), flatten_child);
    else
      for (std::size_t i = 0; i < parts.size(); ++i) flatten_child(i);
    Tessellation all;
    all.has_uv = false;
    for (Tessellation& part : parts) {
      append(all, part);
      part = {};
    }
    return all;
  }

 private:
  const Model& model_;
  ExpansionCounts& counts_;
  const UvReaders& uv_readers_;
  const int threads_;
};

}  // namespace

std::unique_ptr<ModelRoot> make_flat_root(const RootSource& source, ExpansionCounts& counts,
                                          const UvReaders& uv_readers, int threads) {
  const Model& model = *source.part->model;
  CellMesh root = root_cell(model, source.footprint.get(), source.individual);
  Tessellation all = Flattener(model, counts, uv_readers, threads).flatten(std::move(root), 0);
  return std::make_unique<FlatRoot>(std::move(all), model, source.bounds);
}

}  // namespace meristem
