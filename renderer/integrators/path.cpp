// path: light as it is: unidirectional path tracing with light sampling at every bounce.
//
// At each surface one light is asked (light_choice.h) and one direction of the material followed; the two are combined
// by multiple importance sampling with the power heuristic (Veach 1997, section 9.2). The scene's `max_depth` is the
// number of bounces: 0 shows only what glows, 1 direct light, 2 one indirect bounce.
//
// Russian roulette changes noise, not brightness. After `roulette_depth` bounces a path goes on with a probability of
// what its light still counts (its throughput), before that with that over `roulette_throughput`, if it is less. A
// light is asked for certain if it may bring `roulette_light` of the environments' mean radiance; if less, in
// proportion: most shadow rays from the depth of a plant would bring next to nothing.
//
// Opacity below 1 lets camera and bounce rays pass by chance and dims shadow rays; neither counts as a bounce. Lights
// with shapes add their light to a ray that crosses them and do not stop it, as they stop no shadow ray either. Glowing
// objects are hit like any surface, and asked for light like any lamp where the loader has made lights of their faces.
//
// In media (renderer/scene/medium.h) a ray ends where its flight collides, if no surface comes first: there one light
// is asked and one direction of the phase function followed, as on a surface. Light on its way to a vertex is dimmed by
// the media's transmittance. Flights are drawn before their ray is traced, so that nothing is expanded behind a
// collision; but if somebody asks for the first surface, a camera ray goes on to it, so that what is reported does not
// depend on where the flight ended.
//
// For textures a path is a cone (Akenine-Moeller et al. 2021, "Improved Shader and Texture Level of Detail Using Ray
// Cones"): as wide as a pixel, spreading as it goes on; a direction that is picked at random with a density by solid
// angle stands for its share of the directions, so the cone widens by that. Curved mirrors are taken for flat ones.
//
// A path is a state that asks at each vertex for the ray to a light and the one that goes on, and is told what they
// met; so it can be followed at once (radiance()) or wait among many others (PathStepper). What becomes of it does not
// depend on which.
//
// What the last ray of a path meets is not asked where it cannot matter: among opaque surfaces that do not glow it only
// has to learn whether it gets out, and if no lamp stands in its way and there is no environment it is not traced at
// all.
#include "renderer/integrators/first_surface.h"
#include "renderer/integrators/light_choice.h"
#include "renderer/materials/bsdf.h"
#include "renderer/media/phase.h"
#include "renderer/scene/ray_origin.h"
#include "renderer/scene/scene.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <new>
#include <optional>
#include <type_traits>

namespace meristem {
namespace {

// A ray passes so many transparent surfaces, then it ends: a bound, so that no scene can hang a render.
constexpr int max_passes = 256;

// All there is of a path between two of its rays.
struct PathState {
  bool asks_surface = true;  // along `ray`; answered after
  bool asks_light = false;   // along `shadow`
  bool any = false;          // of `ray` it is only asked whether it meets something
  Ray ray;                   // to the next surface, or to the collision in a medium, where it ends
  Receiver last_vertex;      // where the ray was scattered, and how:
  float last_pdf = 0;        // 0: it comes from the camera
  float travelled = 0;       // from there to the ray's origin, through transparent surfaces
  Spectrum throughput{1, 1, 1};
  float entered = 1;  // radiance is larger by this in the glass around the ray
  Spectrum sum;
  std::int32_t depth = 0;
  std::uint16_t passes = 0, light_passes = 0;  // of transparent surfaces: by `ray` and the rays before, by `shadow`
  float width = 0, spread = 0;                 // of the cone around the ray: at its origin, and by distance

  Ray shadow;         // to the light that is asked: the rest of the way
  Spectrum light;     // that it would bring if nothing was in between, but for
  float light_scale;  // this factor
  float visible = 1;  // of it, so far
};
static_assert(std::is_trivially_copyable_v<PathState> && sizeof(PathState) <= 184, "millions are alive at once");

// The same where there are media.
struct PathStateInMedia : PathState {
  MediumCollision collision;
};
static_assert(std::is_trivially_copyable_v<PathStateInMedia>);

class Path : public Integrator, public PathStepper {
 public:
  explicit Path(Params& params) {
    roulette_depth_ = params.integer("roulette_depth", 4, {0, 1e6, ""}, "bounces before any path may end early");
    roulette_throughput_ = float(params.real("roulette_throughput", 0.2, {0, 1, ""},
                                             "before that, only those whose light counts less; 0: none"));
    roulette_light_ = float(params.real(
        "roulette_light", 0.1, not_negative,
        "light that may bring less, as part of the environments' mean radiance, is not always asked; 0: it is"));
  }

  void prepare(const Scene& scene) override {
    choice_.emplace(scene.lights);
    transparency_ = std::ranges::any_of(scene.materials, [](const auto& m) { return m->may_be_transparent(); });
    textures_ = std::ranges::any_of(scene.materials, [](const auto& m) { return m->has_textures(); });
    faint_light_ = roulette_light_ * choice_->mean_background();
    only_lamps_ = choice_->environments().empty();
    in_media_ = !scene.media.empty();
    dark_.clear();
    for (const auto& m : scene.materials) dark_.push_back(!m->may_emit() && !m->may_be_transparent());
    all_dark_ = !in_media_ && std::ranges::all_of(dark_, std::identity{});
    cones_ = textures_ || std::ranges::any_of(scene.lights, [](const auto& l) { return l->has_texture(); });
  }
  Spectrum radiance(const Ray& ray, const Scene& scene, Sampler& sampler, RayCounts& counts,
                    FirstSurface* first) const override;

  const PathStepper* stepper() const override { return this; }
  std::size_t state_bytes() const override { return in_media_ ? sizeof(PathStateInMedia) : sizeof(PathState); }
  void begin(void* state, const Ray& ray, const PathTools& tools) const override;
  RayRequest request(const void* state, int ray) const override;
  void answer(void* state, int ray, bool met, ShadingPoint& point, const PathTools& tools) const override;
  Spectrum result(const void* state) const override { return static_cast<const PathState*>(state)->sum; }

  const LightChoice& choice() const { return *choice_; }
  bool transparency() const { return transparency_; }  // of some material
  bool textures() const { return textures_; }          // of some material: the path's cone is needed,
  bool cones() const { return cones_; }                // or of a light: that of the camera's ray is
  int roulette_depth() const { return roulette_depth_; }
  float roulette_throughput() const { return roulette_throughput_; }
  float faint_light() const { return faint_light_; }  // less luminance is not always asked for
  // Whether a path that ends at a surface of this material brings no light from it,
  bool is_dark(std::size_t material) const { return dark_[material]; }
  bool all_dark() const { return all_dark_; }      // of any that there is, and there is no medium
  bool only_lamps() const { return only_lamps_; }  // no environment

 private:
  int roulette_depth_;
  float roulette_throughput_, roulette_light_, faint_light_ = 0;
  std::optional<LightChoice> choice_;
  bool transparency_ = false, textures_ = false, cones_ = false;
  bool in_media_ = false, all_dark_ = false, only_lamps_ = false;
  std::vector<std::uint8_t> dark_;  // by material
};

// One camera path while it goes on.
class Walk {
 public:
  Walk(const Path& path, const PathTools& tools, PathState& state)
      : path_(path),
        choice_(path.choice()),
        scene_(tools.scene),
        sampler_(tools.sampler),
        counts_(tools.counts),
        first_(tools.first),
        s_(state) {}

  void begin(const Ray& ray) {
    ++counts_.camera;
    s_.last_vertex = {ray.origin, {}};
    if (path_.cones() && scene_.camera) {
      const PixelCone cone = scene_.camera->cone(ray, scene_.settings.width, scene_.settings.height);
      s_.width = cone.width, s_.spread = cone.spread;
    }
    fly(ray);
  }

  // `point` holds what was met, and of all else it needs nothing.
  void answer(int ray, bool met, ShadingPoint& point) {
    if (ray == 0)
      meet_towards_light(met, point);
    else
      meet_surface(met, point);
  }

 private:
  // Asks for the next rays at the surface that was met, if there are to be some.
  void meet_surface(bool met, ShadingPoint& point) {
    s_.asks_surface = false;
    if (met && s_.any) return;
    const SurfaceHit& hit = point.hit;
    if (looks_behind_media()) {
      s_.ray.t_max = std::min(s_.ray.t_max, collision().t);
      if (met && hit.t > s_.ray.t_max) {
        report_behind_media(point);
        met = false;
      }
    }
    add_crossed_lights(met ? hit.t : s_.ray.t_max);
    if (!met && std::isfinite(s_.ray.t_max)) return meet_medium();
    if (!met) {
      const Spectrum before = s_.sum;
      add_environments();
      counts_.escaped += s_.depth == 0 && s_.sum == before;  // a background that is there is opaque
      return;
    }
    const std::size_t material = scene_.material_index(hit);
    const bool is_last = s_.depth >= scene_.settings.max_depth;
    if (is_last && s_.depth > 0 && path_.is_dark(material)) return;
    s_.width += s_.spread * hit.t;
    point.wo = -s_.ray.direction;
    point.footprint = s_.width;
    const Bsdf bsdf = scene_.materials[material]->evaluate(point);
    if (bsdf.inside() && bsdf.absorption != Spectrum{}) s_.throughput *= passed(bsdf.absorption, hit.t);
    if (bsdf.opacity < 1 && sampler_.next_1d() >= bsdf.opacity) return pass_through(hit);
    if (s_.depth == 0) report_first(first_, hit, bsdf);
    if (bsdf.emission != Spectrum{}) s_.sum += s_.throughput * bsdf.emission * weight_of_surface(hit);
    if (is_last) return;
    s_.asks_light = choose_light(
        receiver(point, bsdf), [&](Vec3f wi) { return bsdf.scattered(point.wo, wi); },
        [&](Vec3f wi) { return ray_from(hit, wi, s_.ray, RayClass::Shadow); });
    s_.asks_surface = scatter(point, bsdf);
  }

  // The next ray to a surface, as far as the media let it go.
  void fly(const Ray& ray) {
    s_.ray = ray;
    if (scene_.media.empty()) return;
    RandomStream random(sampler_.next_1d());
    collision().t = std::numeric_limits<float>::infinity();
    for (const auto& medium : scene_.media)
      if (medium->collide(s_.ray, random, collision())) s_.ray.t_max = collision().t;
    if (looks_behind_media()) s_.ray.t_max = ray.t_max;
  }

  // Whether the ray is traced beyond its collision.
  bool looks_behind_media() const { return first_ && s_.depth == 0 && !scene_.media.empty(); }

  // Without a random number: whether anybody asks must not change the path. So of what is half transparent or less
  // nothing is reported.
  void report_behind_media(ShadingPoint& point) {
    point.wo = -s_.ray.direction;
    point.footprint = s_.width + s_.spread * point.hit.t;
    const Bsdf bsdf = scene_.material_of(point.hit).evaluate(point);
    if (bsdf.opacity > 0.5f) report_first(first_, point.hit, bsdf);
  }

  // Asks for the next ray where the flight collides, as meet_surface() does.
  void meet_medium() {
    const MediumCollision& c = collision();
    s_.width += s_.spread * c.t;
    s_.sum += s_.throughput * c.emission;
    s_.throughput *= c.albedo;
    if (s_.depth >= scene_.settings.max_depth || s_.throughput == Spectrum{}) return;
    const Vec3f place = s_.ray.origin + s_.ray.direction * c.t, before = s_.ray.direction;
    s_.asks_light = choose_light(
        {place, {}},
        [&](Vec3f wi) {
          const float p = phase(c.anisotropy, dot(before, wi));
          return Bsdf::Scattered{Spectrum(p), p};
        },
        [&](Vec3f wi) { return free_ray(place, wi, RayClass::Shadow); });
    s_.asks_surface = scatter_in_medium(place);
  }

  // Where there are media.
  MediumCollision& collision() { return static_cast<PathStateInMedia&>(s_).collision; }

  Ray free_ray(Vec3f origin, Vec3f direction, RayClass ray_class) const {
    Ray ray;
    ray.origin = origin;
    ray.direction = direction;
    ray.time = s_.ray.time;
    ray.ray_class = ray.origin_class = ray_class;
    return ray;
  }

  // Beer's law.
  static Spectrum passed(Spectrum absorption, float distance) {
    const Spectrum d = absorption * -distance;
    return {std::exp(d.x), std::exp(d.y), std::exp(d.z)};
  }

  void pass_through(const SurfaceHit& hit) {
    if (++s_.passes > max_passes) return;
    s_.travelled += hit.t;
    fly(ray_from(hit, s_.ray.direction, s_.ray, s_.ray.ray_class));
    s_.asks_surface = true;
  }

  // The weight of light that a ray met by chance and that choose_light() might have found as well.
  float weight_met(std::size_t light, float light_pdf) const {
    if (s_.last_pdf == 0) return 1;  // a camera ray
    return power_heuristic(s_.last_pdf, choice_.probability(s_.last_vertex, light) * light_pdf);
  }

  void add_environments() {
    for (const std::size_t i : choice_.environments()) {
      const Light& light = *scene_.lights[i];
      const Vec3f direction = s_.ray.direction;
      if (s_.last_pdf == 0) {
        if (light.seen_by_camera()) s_.sum += s_.throughput * light.background(direction, s_.spread);
        continue;
      }
      const EscapedLight escaped = light.escaped(direction);
      if (escaped.radiance == Spectrum{}) continue;
      s_.sum += s_.throughput * escaped.radiance * weight_met(i, escaped.pdf);
    }
  }

  void add_crossed_lights(float end) {
    choice_.tree().visit_crossed(s_.ray, end, [&](std::size_t i) {
      if (scene_.lights[i]->object() >= 0) return;  // counted where the surface is hit
      if (s_.last_pdf == 0 && !scene_.lights[i]->seen_by_camera()) return;
      const float t = scene_.lights[i]->intersect(s_.ray);
      if (!(t < end)) return;
      Ray whole = s_.ray;  // from the last vertex: surfaces passed in between do not matter to the pdf
      whole.origin = s_.last_vertex.position;
      s_.sum += s_.throughput * scene_.lights[i]->emitted(s_.ray, t) *
                weight_met(i, scene_.lights[i]->pdf_hit(whole, s_.travelled + t));
    });
  }

  // The weight of what a glowing surface sends: of the light that it is, if it is one.
  float weight_of_surface(const SurfaceHit& hit) const {
    constexpr float tolerance = 1e-3f;  // of the distance, between the hit and the light's own triangle
    if (s_.last_pdf == 0 || hit.object < 0) return 1;
    float nearest = tolerance * hit.t, t_nearest = 0;
    std::size_t found = scene_.lights.size();
    choice_.tree().visit_crossed(s_.ray, hit.t * (1 + tolerance), [&](std::size_t i) {
      if (scene_.lights[i]->object() != hit.object) return;
      const float t = scene_.lights[i]->intersect(s_.ray), off = std::abs(t - hit.t);
      if (off < nearest) nearest = off, t_nearest = t, found = i;
    });
    if (found == scene_.lights.size()) return 1;
    Ray whole = s_.ray;
    whole.origin = s_.last_vertex.position;
    return weight_met(found, scene_.lights[found]->pdf_hit(whole, s_.travelled + t_nearest));
  }

  // Makes the ray to a light, if one may bring something. Of a direction, `scatter` gives the Bsdf::Scattered and
  // `ray_to` the ray.
  template <class Scatter, class RayTo>
  bool choose_light(const Receiver& vertex, const Scatter& scatter, const RayTo& ray_to) {
    if (!choice_.asks()) return false;
    const float random_pick = sampler_.next_1d();
    const Vec2f random = sampler_.next_2d();
    const LightChoice::Pick pick = choice_.pick(vertex, random_pick);
    if (pick.light < 0) return false;
    const LightSample light = scene_.lights[std::size_t(pick.light)]->sample(vertex.position, random);
    const float pdf = light.pdf * pick.probability;
    if (!(pdf > 0)) return false;
    if (light.radiance == Spectrum{}) return false;
    const Bsdf::Scattered scattered = scatter(light.direction);
    if (scattered.value == Spectrum{}) return false;
    const float weight = light.is_delta ? 1 : power_heuristic(pdf, scattered.pdf);
    s_.shadow = ray_to(light.direction);
    s_.shadow.t_max = light.distance;
    const float dimmed = transmittance(s_.shadow);
    if (dimmed == 0) return false;
    s_.light = s_.throughput * scattered.value * light.radiance;
    s_.light_scale = weight / pdf * dimmed;
    const float size = luminance(s_.light) * s_.light_scale;
    if (size < path_.faint_light()) {
      const float chance = size / path_.faint_light();
      if (!(sampler_.next_1d() < chance)) return false;
      s_.light_scale /= chance;
    }
    ++counts_.shadow;
    s_.visible = 1;
    s_.light_passes = 0;
    return true;
  }

  float transmittance(const Ray& ray) {
    if (scene_.media.empty()) return 1;
    RandomStream random(sampler_.next_1d());
    float passed = 1;
    for (const auto& medium : scene_.media) passed *= medium->transmittance(ray, random);
    return passed;
  }

  // Light from behind matters only to a surface that lets it through.
  static Receiver receiver(const ShadingPoint& point, const Bsdf& bsdf) {
    if (bsdf.transmits()) return {point.hit.position, {}};
    const Vec3f normal = point.hit.geometric_normal;
    return {point.hit.position, dot(normal, point.wo) < 0 ? -normal : normal};
  }

  // A surface in the way of the light dims it, or ends its way.
  void meet_towards_light(bool met, ShadingPoint& point) {
    if (!met) return add_light(s_.visible);
    if (!path_.transparency()) return add_light(0);
    const SurfaceHit& veil = point.hit;
    point.wo = -s_.shadow.direction;
    point.footprint = s_.width;
    s_.visible *= 1 - scene_.material_of(veil).evaluate(point).opacity;
    if (!(s_.visible > 0) || ++s_.light_passes == max_passes) return add_light(0);
    const float rest = s_.shadow.t_max - veil.t;
    s_.shadow = ray_from(veil, s_.shadow.direction, s_.shadow, RayClass::Shadow);
    s_.shadow.t_max = rest;
  }

  void add_light(float visible) {
    s_.sum += s_.light * (s_.light_scale * visible);
    s_.asks_light = false;
  }

  bool scatter(const ShadingPoint& point, const Bsdf& bsdf) {
    const float choice = sampler_.next_1d();
    const Vec2f random = sampler_.next_2d();
    const BsdfSample s = bsdf.sample(point.wo, random, choice);
    if (!(s.pdf > 0) || s.weight == Spectrum{}) return false;
    s_.throughput *= s.weight;
    s_.entered *= s.eta * s.eta;
    s_.spread /= s.eta;  // by the law of refraction, for small angles
    return survives() && leave(receiver(point, bsdf), s.pdf, ray_from(point.hit, s.wi, s_.ray, class_of(s.pdf)));
  }

  bool scatter_in_medium(Vec3f place) {
    const Vec3f before = s_.ray.direction, after = sample_phase(collision().anisotropy, before, sampler_.next_2d());
    const float pdf = phase(collision().anisotropy, dot(before, after));
    return survives() && leave({place, {}}, pdf, free_ray(place, after, class_of(pdf)));
  }

  // Of a direction that was picked with this density by solid angle: mirrors show what the ray itself would see.
  RayClass class_of(float pdf) const {
    constexpr float mirror_pdf = 10;  // the peak of a lobe some 20 degrees wide; diffuse reflection stays below 1 / pi
    return pdf > mirror_pdf ? s_.ray.ray_class : RayClass::Diffuse;
  }

  bool survives() {
    const float left = max_component(s_.throughput) * s_.entered;
    float survival = std::min(0.95f, left);
    if (++s_.depth < path_.roulette_depth()) {
      if (left >= path_.roulette_throughput()) return true;
      survival = left / path_.roulette_throughput();
    }
    if (sampler_.next_1d() >= survival) return false;
    s_.throughput /= survival;
    return true;
  }

  bool leave(const Receiver& vertex, float pdf, const Ray& ray) {
    if (s_.depth >= scene_.settings.max_depth && path_.all_dark()) {
      s_.any = !crosses_lights(ray);
      if (s_.any && path_.only_lamps()) return false;
    }
    ++counts_.bounce;
    if (path_.textures()) widen(pdf);
    s_.last_pdf = pdf;
    s_.last_vertex = vertex;
    s_.travelled = 0;
    fly(ray);
    return true;
  }

  // Whether it meets a lamp if nothing is in between.
  bool crosses_lights(const Ray& ray) const {
    bool crosses = false;
    choice_.tree().visit_crossed(
        ray, ray.t_max, [&](std::size_t i) { crosses = crosses || scene_.lights[i]->intersect(ray) < ray.t_max; });
    return crosses;
  }

  // Of the solid angle 1 / pdf the cone takes an eighth of the diameter: many paths fill it, and what they see is mixed
  // anyway. A diffuse bounce spreads it by a quarter.
  void widen(float pdf) {
    constexpr float part = 0.125f, least_pdf = 0.01f;
    const float diameter = 2 / std::sqrt(pi_f * std::max(pdf, least_pdf));
    s_.spread = std::hypot(s_.spread, part * diameter);
  }

  const Path& path_;
  const LightChoice& choice_;
  const Scene& scene_;
  Sampler& sampler_;
  RayCounts& counts_;
  FirstSurface* const first_;  // null: nobody asks
  PathState& s_;
};

RayRequest request_of(const PathState& s, int ray, bool transparency) {
  using enum RayRequest::Kind;
  if (ray == 1) return {!s.asks_surface ? None : s.any ? Any : Nearest, s.ray};
  return {!s.asks_light ? None : transparency ? Nearest : Any, s.shadow};
}

Spectrum Path::radiance(const Ray& ray, const Scene& scene, Sampler& sampler, RayCounts& counts,
                        FirstSurface* first) const {
  const Intersector& world = *scene.intersector;
  PathStateInMedia state;
  Walk walk(*this, {scene, sampler, counts, first}, state);
  walk.begin(ray);
  ShadingPoint point;
  while (state.asks_light || state.asks_surface) {
    const int next = state.asks_light ? 0 : 1;
    const RayRequest request = request_of(state, next, transparency_);
    const bool met =
        request.kind == RayRequest::Kind::Any ? world.occluded(request.ray) : world.intersect(request.ray, point.hit);
    walk.answer(next, met, point);
  }
  return state.sum;
}

void Path::begin(void* state, const Ray& ray, const PathTools& tools) const {
  PathState& path = in_media_ ? *new (state) PathStateInMedia : *new (state) PathState;
  Walk(*this, tools, path).begin(ray);
}

RayRequest Path::request(const void* state, int ray) const {
  return request_of(*static_cast<const PathState*>(state), ray, transparency_);
}

void Path::answer(void* state, int ray, bool met, ShadingPoint& point, const PathTools& tools) const {
  Walk(*this, tools, *static_cast<PathState*>(state)).answer(ray, met, point);
}

}  // namespace

void register_path(IntegratorRegistry& r) { r.add<Path>("path", "Unidirectional path tracing: the default"); }

}  // namespace meristem
