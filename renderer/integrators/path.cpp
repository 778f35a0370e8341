// path: light as it is: unidirectional path tracing with light sampling at every bounce.
//
// At each surface one light is asked (light_choice.h) and one direction of the material followed; the two are combined
// by multiple importance sampling with the power heuristic (Veach 1997, section 9.2). The scene's `max_depth` is the
// number of bounces: 0 shows only what glows, 1 direct light, 2 one indirect bounce. After `roulette_depth` bounces
// weak paths end by Russian roulette, which changes noise, not brightness.
//
// Opacity below 1 lets camera and bounce rays pass by chance and dims shadow rays; neither counts as a bounce. Lights
// with shapes add their light to a ray that crosses them and do not stop it, as they stop no shadow ray either. Glowing
// objects are hit like any surface, and asked for light like any lamp where the loader has made lights of their faces.
#include "renderer/integrators/first_surface.h"
#include "renderer/integrators/light_choice.h"
#include "renderer/materials/bsdf.h"
#include "renderer/scene/ray_origin.h"
#include "renderer/scene/scene.h"

#include <algorithm>
#include <optional>

namespace meristem {
namespace {

// A ray passes so many transparent surfaces, then it ends: a bound, so that no scene can hang a render.
constexpr int max_passes = 256;

class Path : public Integrator {
 public:
  explicit Path(Params& params) {
    roulette_depth_ = params.integer("roulette_depth", 4, {0, 1e6, ""}, "bounces before weak paths may end early");
  }

  void prepare(const Scene& scene) override {
    choice_.emplace(scene.lights);
    transparency_ = std::ranges::any_of(scene.materials, [](const auto& m) { return m->may_be_transparent(); });
  }
  Spectrum radiance(const Ray& ray, const Scene& scene, Sampler& sampler, RayCounts& counts,
                    FirstSurface* first) const override;

  const LightChoice& choice() const { return *choice_; }
  bool transparency() const { return transparency_; }  // of some material
  int roulette_depth() const { return roulette_depth_; }

 private:
  int roulette_depth_;
  std::optional<LightChoice> choice_;
  bool transparency_ = false;
};

// One camera path while it is followed.
class Walk {
 public:
  Walk(const Path& path, const Scene& scene, Sampler& sampler, RayCounts& counts, FirstSurface* first, const Ray& ray)
      : path_(path),
        choice_(path.choice()),
        scene_(scene),
        sampler_(sampler),
        counts_(counts),
        first_(first),
        ray_(ray),
        last_vertex_{ray.origin, {}} {}

  Spectrum follow() {
    ++counts_.camera;
    while (step()) {}
    return sum_;
  }

 private:
  // Follows the ray to the next surface and makes the next ray there; false when the path has ended.
  bool step() {
    SurfaceHit hit;
    const bool met = scene_.intersector->intersect(ray_, hit);
    add_crossed_lights(met ? hit.t : std::numeric_limits<float>::infinity());
    if (!met) {
      const Spectrum before = sum_;
      add_environments();
      counts_.escaped += depth_ == 0 && sum_ == before;  // a background that is there is opaque
      return false;
    }
    ShadingPoint point{hit, -ray_.direction};
    Bsdf bsdf;
    scene_.material_of(hit).evaluate(point, bsdf);
    if (bsdf.inside() && bsdf.absorption != Spectrum{}) throughput_ *= passed(bsdf.absorption, hit.t);
    if (bsdf.opacity < 1 && sampler_.next_1d() >= bsdf.opacity) return pass_through(hit);
    if (depth_ == 0) report_first(first_, hit, bsdf);
    if (bsdf.emission != Spectrum{}) sum_ += throughput_ * bsdf.emission * weight_of_surface(hit);
    if (depth_ >= scene_.settings.max_depth) return false;
    add_direct_light(point, bsdf);
    return scatter(point, bsdf);
  }

  // Beer's law.
  static Spectrum passed(Spectrum absorption, float distance) {
    const Spectrum d = absorption * -distance;
    return {std::exp(d.x), std::exp(d.y), std::exp(d.z)};
  }

  bool pass_through(const SurfaceHit& hit) {
    if (++passes_ > max_passes) return false;
    travelled_ += hit.t;
    ray_ = ray_from(hit, ray_.direction, ray_.time);
    return true;
  }

  // The weight of light that a ray met by chance and that add_direct_light() might have found as well.
  float weight_met(std::size_t light, float light_pdf) const {
    if (last_pdf_ == 0) return 1;  // a camera ray
    return power_heuristic(last_pdf_, choice_.probability(last_vertex_, light) * light_pdf);
  }

  void add_environments() {
    for (const std::size_t i : choice_.environments()) {
      const Spectrum radiance = scene_.lights[i]->escaped(ray_.direction);
      if (radiance == Spectrum{}) continue;
      sum_ += throughput_ * radiance * weight_met(i, scene_.lights[i]->pdf_escaped(ray_.direction));
    }
  }

  void add_crossed_lights(float end) {
    choice_.tree().visit_crossed(ray_, end, [&](std::size_t i) {
      if (scene_.lights[i]->object() >= 0) return;  // counted where the surface is hit
      const float t = scene_.lights[i]->intersect(ray_);
      if (!(t < end)) return;
      Ray whole = ray_;  // from the last vertex: surfaces passed in between do not matter to the pdf
      whole.origin = last_vertex_.position;
      sum_ += throughput_ * scene_.lights[i]->emitted(ray_, t) *
              weight_met(i, scene_.lights[i]->pdf_hit(whole, travelled_ + t));
    });
  }

  // The weight of what a glowing surface sends: of the light that it is, if it is one.
  float weight_of_surface(const SurfaceHit& hit) const {
    constexpr float tolerance = 1e-3f;  // of the distance, between the hit and the light's own triangle
    if (last_pdf_ == 0 || hit.object < 0) return 1;
    float nearest = tolerance * hit.t, t_nearest = 0;
    std::size_t found = scene_.lights.size();
    choice_.tree().visit_crossed(ray_, hit.t * (1 + tolerance), [&](std::size_t i) {
      if (scene_.lights[i]->object() != hit.object) return;
      const float t = scene_.lights[i]->intersect(ray_), off = std::abs(t - hit.t);
      if (off < nearest) nearest = off, t_nearest = t, found = i;
    });
    if (found == scene_.lights.size()) return 1;
    Ray whole = ray_;
    whole.origin = last_vertex_.position;
    return weight_met(found, scene_.lights[found]->pdf_hit(whole, travelled_ + t_nearest));
  }

  void add_direct_light(const ShadingPoint& point, const Bsdf& bsdf) {
    if (scene_.lights.empty()) return;
    const float random_pick = sampler_.next_1d();
    const Vec2f random = sampler_.next_2d();
    const LightChoice::Pick pick = choice_.pick(receiver(point, bsdf), random_pick);
    if (pick.light < 0) return;
    const LightSample light = scene_.lights[std::size_t(pick.light)]->sample(point.hit.position, random);
    const float pdf = light.pdf * pick.probability;
    if (!(pdf > 0)) return;
    const Spectrum f = bsdf.evaluate(point.wo, light.direction);
    if (f == Spectrum{} || light.radiance == Spectrum{}) return;
    const float weight = light.is_delta ? 1 : power_heuristic(pdf, bsdf.pdf(point.wo, light.direction));
    sum_ += throughput_ * f * light.radiance * (weight / pdf * visibility(point.hit, light));
  }

  // Light from behind matters only to a surface that lets it through.
  static Receiver receiver(const ShadingPoint& point, const Bsdf& bsdf) {
    if (bsdf.transmits()) return {point.hit.position, {}};
    const Vec3f normal = point.hit.geometric_normal;
    return {point.hit.position, dot(normal, point.wo) < 0 ? -normal : normal};
  }

  // The part of the light that arrives at a surface.
  float visibility(const SurfaceHit& hit, const LightSample& light) {
    ++counts_.shadow;
    Ray ray = ray_from(hit, light.direction, ray_.time);
    ray.t_max = light.distance;
    if (!path_.transparency()) return scene_.intersector->occluded(ray) ? 0 : 1;
    float visible = 1;
    for (int i = 0; i < max_passes; ++i) {
      SurfaceHit veil;
      if (!scene_.intersector->intersect(ray, veil)) return visible;
      Bsdf bsdf;
      scene_.material_of(veil).evaluate({veil, -ray.direction}, bsdf);
      visible *= 1 - bsdf.opacity;
      if (!(visible > 0)) return 0;
      const float rest = ray.t_max - veil.t;
      ray = ray_from(veil, ray.direction, ray.time);
      ray.t_max = rest;
    }
    return 0;
  }

  bool scatter(const ShadingPoint& point, const Bsdf& bsdf) {
    const float choice = sampler_.next_1d();
    const Vec2f random = sampler_.next_2d();
    const BsdfSample s = bsdf.sample(point.wo, random, choice);
    if (!(s.pdf > 0) || s.weight == Spectrum{}) return false;
    throughput_ *= s.weight;
    entered_ *= s.eta * s.eta;
    if (++depth_ >= path_.roulette_depth()) {
      const float survival = std::min(0.95f, max_component(throughput_) * entered_);
      if (sampler_.next_1d() >= survival) return false;
      throughput_ /= survival;
    }
    ++counts_.bounce;
    last_pdf_ = s.pdf;
    last_vertex_ = receiver(point, bsdf);
    travelled_ = 0;
    ray_ = ray_from(point.hit, s.wi, ray_.time);
    return true;
  }

  const Path& path_;
  const LightChoice& choice_;
  const Scene& scene_;
  Sampler& sampler_;
  RayCounts& counts_;
  FirstSurface* const first_;  // null: nobody asks
  Ray ray_;
  Receiver last_vertex_;  // where the ray was scattered, and how:
  float last_pdf_ = 0;    // 0: it comes from the camera
  float travelled_ = 0;   // from there to the ray's origin, through transparent surfaces
  Spectrum throughput_{1, 1, 1};
  float entered_ = 1;  // radiance is larger by this in the glass around the ray
  Spectrum sum_;
  int depth_ = 0;
  int passes_ = 0;
};

Spectrum Path::radiance(const Ray& ray, const Scene& scene, Sampler& sampler, RayCounts& counts,
                        FirstSurface* first) const {
  return Walk(*this, scene, sampler, counts, first, ray).follow();
}

}  // namespace

void register_path(IntegratorRegistry& r) { r.add<Path>("path", "Unidirectional path tracing: the default"); }

}  // namespace meristem
