// PlantMesh: what a step of a plant writes to: a mesh that grows by vertices with u, v, and by faces that share what
// growth gave them. Takes care of keys (hashes of the bud's key and a running number), of the grid of positions, and of
// u, v by corner or by vertex, whichever the mesh has. For one application of a step; not shared by threads.
#pragma once

#include "geometry/mesh/mesh.h"
#include "geometry/mesh/quantum.h"

#include <initializer_list>
#include <span>

namespace meristem {

class PlantMesh {
 public:
  // Appends to `mesh`, whose attributes must be those of the mesh before the step.
  PlantMesh(Mesh& mesh, const Quantum& quantum, bool uv_by_corner, Key step_key)
      : mesh_(mesh), quantum_(quantum), uv_by_corner_(uv_by_corner), step_key_(step_key) {}

  bool has_uv_by_corner() const { return uv_by_corner_; }
  // From now on keys come from this bud.
  void begin_bud(Key bud) {
    bud_ = hash_keys(bud, step_key_);
    first_vertex_ = mesh_.vertex_count();
    uv_.clear();
    next_ = 0;
  }
  // From now on faces carry this; its key is made here.
  void set_origin(FaceOrigin origin) {
    origin.key = next_key();
    mesh_.origins.push_back(origin);
  }
  const FaceOrigin& origin() const { return mesh_.origins.back(); }

  std::uint32_t add_vertex(Vec3d position, Vec2d uv) {
    uv = {unit_quantum.round(uv.x), unit_quantum.round(uv.y)};
    const std::uint32_t v = mesh_.add_vertex(quantum_.round(position), next_key());
    if (uv_by_corner_)
      uv_.push_back(uv);
    else
      mesh_.uv.push_back(uv);
    return v;
  }
  void add_face(std::span<const std::uint32_t> vertices) { add_face(vertices, next_key()); }
  void add_face(std::span<const std::uint32_t> vertices, Key key) {
    mesh_.add_face(vertices, key, std::uint32_t(mesh_.origins.size()) - 1);
    if (uv_by_corner_)
      for (std::uint32_t v : vertices) mesh_.corner_uv.push_back(uv_[v - first_vertex_]);
  }
  void add_face(std::initializer_list<std::uint32_t> vertices) {
    add_face(std::span<const std::uint32_t>(vertices.begin(), vertices.size()));
  }
  // The bud's faces from `first` on are as fine as will ever be wanted: they are shown as they are.
  void freeze(std::uint32_t first) {
    mesh_.frozen.resize(mesh_.vertex_count());
    for (std::uint32_t f = first; f < mesh_.face_count(); ++f)
      for (std::uint32_t v : mesh_.corners(f))
        mesh_.frozen[v].normal = mesh_.frozen[v].normal + Vec3f(newell_normal(mesh_, f));
    for (std::uint32_t f = first; f < mesh_.face_count(); ++f)
      for (std::uint32_t v : mesh_.corners(f)) {
        FrozenVertex& frozen = mesh_.frozen[v];
        if (frozen.is_frozen) continue;
        const Vec2d uv = uv_by_corner_ ? uv_[v - first_vertex_] : mesh_.uv[v];
        frozen = {true, false, Vec3f(mesh_.positions[v]), normalize(frozen.normal), Vec2f{float(uv.x), float(uv.y)}};
      }
  }
  std::uint32_t face_count() const { return mesh_.face_count(); }

 private:
  Key next_key() { return hash_keys(bud_, next_++); }

  Mesh& mesh_;
  const Quantum& quantum_;
  const bool uv_by_corner_;
  const Key step_key_;
  Key bud_ = 0;
  Key next_ = 0;
  std::uint32_t first_vertex_ = 0;
  std::vector<Vec2d> uv_;  // of the bud's vertices
};

}  // namespace meristem
