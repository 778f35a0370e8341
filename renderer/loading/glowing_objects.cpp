#include "renderer/loading/glowing_objects.h"

#include "geometry/cells/shown_surfaces.h"
#include "geometry/cells/uv_packing.h"
#include "renderer/lights/triangle_light.h"

#include <algorithm>

namespace meristem {

namespace {

const Material& material_of(const Scene& scene, const FaceOrigin& origin) {
  SurfaceHit hit;
  hit.origin = origin;
  return scene.material_of(hit);
}

// The triangles of one object in world space.
class Triangles {
 public:
  Triangles(const Placement& object, int index, Scene& scene) : object_(object), index_(index), scene_(scene) {}

  void add(const Tessellation& surface) {
    uv_ = vertex_uv(surface);
    for_each_triangle(surface, [&](const std::array<std::uint32_t, 3>& corners, std::uint32_t origin) {
      add(surface, corners, origin);
    });
  }

 private:
  void add(const Tessellation& surface, const std::array<std::uint32_t, 3>& corners, std::uint32_t origin) {
    const Material& material = material_of(scene_, surface.origins[origin]);
    if (!material.may_emit()) return;
    LightTriangle triangle{{}, {}, surface.origins[origin], index_};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.corners[k] = Vec3f(object_.to_parent.point(Vec3d(surface.positions[corners[k]])));
      triangle.uv[k] = uv_[corners[k]];
    }
    scene_.lights.push_back(std::make_unique<TriangleLight>(triangle, material));
  }

  const Placement& object_;
  const int index_;
  Scene& scene_;
  std::vector<Vec2f> uv_;  // of the surface
};

}  // namespace

void add_glowing_objects(std::vector<Placement>& objects, Scene& scene) {
  if (std::ranges::none_of(scene.materials, [](const auto& m) { return m->may_emit(); })) return;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (scene.lights.size() > max_glowing_triangles) return;
    if (objects[i].motion || objects[i].moments) continue;
    const Part& part = *objects[i].part;
    if (!part.model || part.placer || part.model->estimated_faces() > max_glowing_faces) continue;
    const std::size_t others = scene.lights.size();
    Triangles triangles(objects[i], int(i), scene);
    for_each_tessellation({part.model, nullptr, objects[i].individual, {}},
                          [&](const Tessellation& cell, double) { triangles.add(cell); });
    if (scene.lights.size() > others) objects[i].in_full = true;  // as the lights are
  }
}

}  // namespace meristem
