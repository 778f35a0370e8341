// ambient_occlusion: how open the surroundings of each point are, from 0 (enclosed) to 1: shape without light or
// colour. One cosine-distributed ray a sample, as long as `distance`. What the camera sees of nothing is 1.
#include "renderer/integrators/first_surface.h"
#include "renderer/scene/ray_origin.h"
#include "renderer/scene/warps.h"

namespace meristem {
namespace {

class AmbientOcclusion : public Integrator {
 public:
  explicit AmbientOcclusion(Params& params) {
    distance_ = float(params.real("distance", 1e6, {0, 1e9, "m"}, "beyond it nothing occludes"));
  }

  Spectrum radiance(const Ray& ray, const Scene& scene, Sampler& sampler, RayCounts& counts,
                    FirstSurface* first) const override {
    ++counts.camera;
    SurfaceHit hit;
    bool open = true;
    if (scene.intersector->intersect(ray, hit)) {
      report_first(first, scene, ray, hit);
      const bool behind = dot(hit.geometric_normal, ray.direction) > 0;
      const Frame frame(behind ? -hit.geometric_normal : hit.geometric_normal);
      Ray probe = ray_from(hit, frame.to_world(cosine_hemisphere(sampler.next_2d())), ray, RayClass::Shadow);
      probe.t_max = distance_;
      ++counts.shadow;
      open = !scene.intersector->occluded(probe);
    }
    return Spectrum(open ? 1.f : 0.f);
  }

 private:
  float distance_;
};

}  // namespace

void register_ambient_occlusion(IntegratorRegistry& r) {
  r.add<AmbientOcclusion>("ambient_occlusion", "How open the surroundings of each point are");
}

}  // namespace meristem
