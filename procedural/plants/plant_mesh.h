// PlantMesh: what a step of a plant writes to: a mesh that grows by vertices with u, v, and by faces that share what
// growth gave them. Takes care of keys (hashes of the bud's key and a running number), of the grid of positions, and of
// u, v by corner or by vertex, whichever the mesh has. For one application of a step; not shared by threads.
//
// Its arrays are longer than what they hold, and nobody else may change their lengths, until finish() cuts them.
#pragma once

#include "geometry/cells/uv_lattice.h"
#include "geometry/mesh/mesh.h"
#include "geometry/mesh/quantum.h"
#include "procedural/plants/leaf_shape.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>

namespace meristem {

class PlantMesh {
 public:
  // Appends to `mesh`, whose attributes must be those of the mesh before the step.
  PlantMesh(Mesh& mesh, const Quantum& quantum, const Quantum& shown_quantum, bool uv_by_corner, Key step_key)
      : mesh_(mesh),
        quantum_(quantum),
        shown_quantum_(shown_quantum),
        uv_by_corner_(uv_by_corner),
        step_key_(step_key) {}

  bool has_uv_by_corner() const { return uv_by_corner_; }
  std::uint32_t vertex_count() const { return vertices_; }
  std::uint32_t face_count() const { return faces_; }
  std::uint32_t corner_count() const { return corners_; }
  void finish() {
    resize_vertices(vertices_);
    resize_faces(faces_);
    resize_corners(corners_);
  }

  // From now on keys come from this bud.
  void begin_bud(Key bud) {
    keys_ = KeysFrom(hash_keys(bud, step_key_));
    first_vertex_ = vertices_;
    next_ = 0;
  }
  // From now on faces carry this; its key is made here.
  void set_origin(FaceOrigin origin) {
    origin.key = next_key();
    mesh_.origins.push_back(origin);
  }
  const FaceOrigin& origin() const { return mesh_.origins.back(); }

  // What is added needs room, which is asked for beforehand.
  void make_room(std::uint32_t vertices, std::uint32_t faces, std::uint32_t corners) {
    if (vertices_ + vertices > mesh_.positions.size()) resize_vertices(vertices_ + vertices + more_than(vertices_));
    if (faces_ + faces > mesh_.face_keys.size()) resize_faces(faces_ + faces + more_than(faces_));
    if (corners_ + corners > mesh_.corner_vertices.size()) resize_corners(corners_ + corners + more_than(corners_));
    if (uv_by_corner_ && vertices_ + vertices > first_vertex_ + uv_.size())
      uv_.resize(2 * (vertices_ + vertices - first_vertex_));
  }
  std::uint32_t add_vertex(Vec3d position, Vec2d uv) {
    mesh_.positions[vertices_] = quantum_.round(position);
    mesh_.vertex_keys[vertices_] = next_key();
    Vec2d& place = uv_by_corner_ ? uv_[vertices_ - first_vertex_] : mesh_.uv[vertices_];
    place = {unit_quantum.round(uv.x), unit_quantum.round(uv.y)};
    return vertices_++;
  }
  void add_face(std::span<const std::uint32_t> vertices) { add_face(vertices, next_key()); }
  void add_face(std::span<const std::uint32_t> vertices, Key key) {
    if (uv_by_corner_)
      for (std::size_t i = 0; i < vertices.size(); ++i)
        mesh_.corner_uv[corners_ + i] = uv_[vertices[i] - first_vertex_];
    put_face(vertices, key, std::uint32_t(mesh_.origins.size()) - 1);
  }
  void add_face(std::initializer_list<std::uint32_t> vertices) {
    add_face(std::span<const std::uint32_t>(vertices.begin(), vertices.size()));
  }
  // A leaf of that shape, whose vertex i is at place(i), on the grid.
  template <class Place>
  void add_leaf(const LeafShape& shape, const Place& place) {
    const auto vertices = std::uint32_t(shape.vertices.size()), corners = std::uint32_t(shape.corners.size());
    Vec3d* const positions = &mesh_.positions[vertices_];
    Key* const vertex_keys = &mesh_.vertex_keys[vertices_];
    for (std::uint32_t i = 0; i < vertices; ++i) positions[i] = place(i);
    for (std::uint32_t i = 0; i < vertices; ++i) vertex_keys[i] = keys_(next_ + i);
    std::uint32_t* const corner_vertices = &mesh_.corner_vertices[corners_];
    for (std::uint32_t i = 0; i < corners; ++i) corner_vertices[i] = vertices_ + shape.corners[i];
    if (uv_by_corner_)
      std::copy_n(shape.corner_uv.data(), corners, &mesh_.corner_uv[corners_]);
    else
      std::copy_n(shape.uv.data(), vertices, &mesh_.uv[vertices_]);
    const auto origin = std::uint32_t(mesh_.origins.size()) - 1;
    for (std::uint32_t f = 0; f < shape.face_count(); ++f) {
      mesh_.face_keys[faces_ + f] = keys_(next_ + vertices + f);
      mesh_.face_origins[faces_ + f] = origin;
      mesh_.face_starts[faces_ + f + 1] = corners_ + shape.face_starts[f + 1];
    }
    vertices_ += vertices;
    faces_ += shape.face_count();
    corners_ += corners;
    next_ += vertices + shape.face_count();
  }

  // The bud's faces from `first` on are as fine as will ever be wanted: they are shown as they are.
  void freeze(std::uint32_t first) {
    mesh_.frozen.resize(vertices_);
    const auto uv_of = [&](std::uint32_t c) {
      return uv_by_corner_ ? mesh_.corner_uv[c] : mesh_.uv[mesh_.corner_vertices[c]];
    };
    Vec2d low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
    for (std::uint32_t c = mesh_.face_starts[first]; c < mesh_.face_starts[faces_]; ++c) {
      const Vec2d uv = uv_of(c);
      low = {std::min(low.x, uv.x), std::min(low.y, uv.y)};
      high = {std::max(high.x, uv.x), std::max(high.y, uv.y)};
    }
    const Vec2f width{float(high.x - low.x), float(high.y - low.y)};
    for (std::uint32_t f = first; f < faces_; ++f)
      for (std::uint32_t v : mesh_.corners(f))
        mesh_.frozen[v].normal = mesh_.frozen[v].normal + Vec3f(newell_normal(mesh_, f));
    for (std::uint32_t f = first; f < faces_; ++f)
      for (std::uint32_t c = mesh_.face_starts[f]; c < mesh_.face_starts[f + 1]; ++c) {
        const std::uint32_t v = mesh_.corner_vertices[c];
        FrozenVertex& frozen = mesh_.frozen[v];
        if (frozen.is_frozen) continue;
        const Vec2d uv = uv_of(c);
        frozen = {true, false, Vec3f(shown_quantum_.round(mesh_.positions[v])), normalize(frozen.normal),
                  on_uv_lattice(Vec2f{float(uv.x), float(uv.y)}, width)};
      }
  }

  // A vertex and a face of the mesh before the step.
  std::uint32_t keep_vertex(const Mesh& before, std::uint32_t v) {
    make_room(1, 0, 0);
    mesh_.positions[vertices_] = before.positions[v];
    mesh_.vertex_keys[vertices_] = before.vertex_keys[v];
    if (!uv_by_corner_) mesh_.uv[vertices_] = before.uv[v];
    return vertices_++;
  }
  void keep_face(const Mesh& before, std::uint32_t f, std::span<const std::uint32_t> vertices, std::uint32_t origin) {
    make_room(0, 1, std::uint32_t(vertices.size()));
    if (!before.corner_uv.empty())
      std::copy_n(&before.corner_uv[before.face_starts[f]], vertices.size(), &mesh_.corner_uv[corners_]);
    put_face(vertices, before.face_keys[f], origin);
  }

 private:
  // Arrays grow by more than one ring or leaf at a time, but by what fits the processor's second cache: they are
  // cleared first.
  static std::uint32_t more_than(std::uint32_t count) { return std::clamp(count / 4, 64u, 4096u); }

  Key next_key() { return keys_(next_++); }
  void put_face(std::span<const std::uint32_t> vertices, Key key, std::uint32_t origin) {
    std::copy(vertices.begin(), vertices.end(), &mesh_.corner_vertices[corners_]);
    corners_ += std::uint32_t(vertices.size());
    mesh_.face_keys[faces_] = key;
    mesh_.face_origins[faces_] = origin;
    mesh_.face_starts[++faces_] = corners_;
  }
  void resize_vertices(std::uint32_t count) {
    mesh_.positions.resize(count);
    mesh_.vertex_keys.resize(count);
    if (!uv_by_corner_) mesh_.uv.resize(count);
  }
  void resize_faces(std::uint32_t count) {
    mesh_.face_keys.resize(count);
    mesh_.face_origins.resize(count);
    mesh_.face_starts.resize(count + 1);
  }
  void resize_corners(std::uint32_t count) {
    mesh_.corner_vertices.resize(count);
    if (uv_by_corner_) mesh_.corner_uv.resize(count);
  }

  Mesh& mesh_;
  const Quantum &quantum_, &shown_quantum_;
  const bool uv_by_corner_;
  const Key step_key_;
  std::uint32_t vertices_ = 0, faces_ = 0, corners_ = 0;  // those that are there; the arrays may be longer
  KeysFrom keys_{0};                                      // of the bud
  Key next_ = 0;
  std::uint32_t first_vertex_ = 0;
  std::vector<Vec2d> uv_;  // of the bud's vertices
};

}  // namespace meristem
