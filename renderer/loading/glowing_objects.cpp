#include "renderer/loading/glowing_objects.h"

#include "geometry/cells/expansion.h"
#include "renderer/lights/triangle_light.h"

#include <algorithm>

namespace meristem {

namespace {

double estimated_faces(const Model& model) {
  const Mesh& mesh = model.base().mesh;
  double sum = 0;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    sum += model.estimated_faces(mesh.corner_count(f), mesh.origins[mesh.face_origins[f]].symbol, 0);
  return sum;
}

const Material& material_of(const Scene& scene, const FaceOrigin& origin) {
  SurfaceHit hit;
  hit.origin = &origin;
  return scene.material_of(hit);
}

// The triangles of one object in world space.
class Triangles {
 public:
  Triangles(const Placement& object, int index, Scene& scene) : object_(object), index_(index), scene_(scene) {}

  void add(const Tessellation& surface) {
    for (std::size_t i = 0; i < surface.triangles.size(); ++i)
      add(surface, surface.triangles[i], surface.triangle_sources[i].origin);
    for (const Tessellation::Grid& grid : surface.grids) add_grid(surface, grid);
  }

 private:
  // Cut as Embree cuts the quads of a grid: along the diagonal from the second corner to the third
  // (RTC_GEOMETRY_TYPE_GRID).
  void add_grid(const Tessellation& surface, const Tessellation::Grid& grid) {
    for (std::uint32_t y = 0; y + 1 < grid.height; ++y)
      for (std::uint32_t x = 0; x + 1 < grid.width; ++x) {
        const std::uint32_t a = grid.first_vertex + y * grid.width + x, b = a + 1, c = a + grid.width, d = c + 1;
        add(surface, {a, b, c}, grid.origin);
        add(surface, {b, d, c}, grid.origin);
      }
  }

  void add(const Tessellation& surface, const std::array<std::uint32_t, 3>& corners, std::uint32_t origin) {
    const Material& material = material_of(scene_, surface.origins[origin]);
    if (!material.may_emit()) return;
    LightTriangle triangle{{}, {}, surface.origins[origin], index_};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.corners[k] = Vec3f(object_.to_parent.point(Vec3d(surface.positions[corners[k]])));
      triangle.uv[k] = surface.uv_frames[0].unpack(surface.uv[corners[k]]);
    }
    scene_.lights.push_back(std::make_unique<TriangleLight>(triangle, material));
  }

  const Placement& object_;
  const int index_;
  Scene& scene_;
};

void add_expanded(const Model& model, CellMesh cell, int level, Triangles& triangles) {
  const Expansion expansion = expand(model, std::move(cell), level);
  if (expansion.leaf) return triangles.add(*expansion.leaf);
  const InnerCell& inner = *expansion.inner;
  for (std::size_t i = 0; i < inner.child_count(); ++i)
    add_expanded(model, child_cell(model, inner, i), inner.level, triangles);
}

}  // namespace

void add_glowing_objects(std::vector<Placement>& objects, Scene& scene) {
  if (std::ranges::none_of(scene.materials, [](const auto& m) { return m->may_emit(); })) return;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (scene.lights.size() > max_glowing_triangles) return;
    const Part& part = *objects[i].part;
    if (!part.model || part.placer || estimated_faces(*part.model) > max_glowing_faces) continue;
    const std::size_t others = scene.lights.size();
    Triangles triangles(objects[i], int(i), scene);
    add_expanded(*part.model, root_cell(*part.model, nullptr, objects[i].individual), 0, triangles);
    if (scene.lights.size() > others) objects[i].in_full = true;  // as the lights are
  }
}

}  // namespace meristem
