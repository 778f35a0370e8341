// normals: a debug view: the shading normal as a colour (x, y, z from -1..1 to red, green, blue from 0..1); `geometric`
// shows the faces' own normals. Surfaces seen from behind are dimmed to half; where there is nothing, black.
#include "renderer/integrators/first_surface.h"

namespace meristem {
namespace {

class Normals : public Integrator {
 public:
  explicit Normals(Params& params) {
    geometric_ = params.boolean("geometric", false, "show geometric instead of shading normals");
  }

  Spectrum radiance(const Ray& ray, const Scene& scene, Sampler&, RayCounts& counts,
                    FirstSurface* first) const override {
    ++counts.camera;
    SurfaceHit hit;
    Spectrum color;
    if (scene.intersector->intersect(ray, hit)) {
      report_first(first, scene, ray, hit);
      const Vec3f n = geometric_ ? hit.geometric_normal : hit.shading_normal;
      const float light = dot(hit.geometric_normal, ray.direction) > 0 ? 0.5f : 1.f;
      color = (n * 0.5f + Vec3f(0.5f)) * light;
    } else {
      ++counts.escaped;
    }
    return color;
  }

 private:
  bool geometric_;
};

}  // namespace

void register_normals(IntegratorRegistry& r) { r.add<Normals>("normals", "Normals as colours, to look at shapes"); }

}  // namespace meristem
