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
//
// A path is a state that asks for one ray at a time and goes on when it is told what the ray met; so it can be followed
// at once (radiance()) or wait among many others (PathStepper). What becomes of it does not depend on which.
#include "renderer/integrators/first_surface.h"
#include "renderer/integrators/light_choice.h"
#include "renderer/materials/bsdf.h"
#include "renderer/scene/ray_origin.h"
#include "renderer/scene/scene.h"

#include <algorithm>
#include <new>
#include <optional>
#include <type_traits>

namespace meristem {
namespace {

// A ray passes so many transparent surfaces, then it ends: a bound, so that no scene can hang a render.
constexpr int max_passes = 256;

// All there is of a path between two of its rays.
struct PathState {
  enum class Asks : std::uint8_t { Nothing, Surface, Light };
  Asks asks = Asks::Surface;
  bool goes_on = false;  // along `ray`, once the light has answered
  Ray ray;               // to the next surface
  Receiver last_vertex;  // where the ray was scattered, and how:
  float last_pdf = 0;    // 0: it comes from the camera
  float travelled = 0;   // from there to the ray's origin, through transparent surfaces
  Spectrum throughput{1, 1, 1};
  float entered = 1;  // radiance is larger by this in the glass around the ray
  Spectrum sum;
  std::int32_t depth = 0, passes = 0;

  Ray shadow;         // to the light that is asked: the rest of the way
  Spectrum light;     // that it would bring if nothing was in between, but for
  float light_scale;  // this factor
  float visible = 1;  // of it, so far
  int light_passes = 0;
};
static_assert(std::is_trivially_copyable_v<PathState> && sizeof(PathState) <= 256, "millions are alive at once");

class Path : public Integrator, public PathStepper {
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

  const PathStepper* stepper() const override { return this; }
  std::size_t state_bytes() const override { return sizeof(PathState); }
  void begin(void* state, const Ray& ray, const PathTools& tools) const override;
  RayRequest request(const void* state) const override;
  void answer(void* state, bool met, const SurfaceHit& hit, const PathTools& tools) const override;
  Spectrum result(const void* state) const override { return static_cast<const PathState*>(state)->sum; }

  const LightChoice& choice() const { return *choice_; }
  bool transparency() const { return transparency_; }  // of some material
  int roulette_depth() const { return roulette_depth_; }

 private:
  int roulette_depth_;
  std::optional<LightChoice> choice_;
  bool transparency_ = false;
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
    s_.ray = ray;
    s_.last_vertex = {ray.origin, {}};
  }

  void answer(bool met, const SurfaceHit& hit) {
    if (s_.asks == PathState::Asks::Surface)
      meet_surface(met, hit);
    else
      meet_towards_light(met, hit);
  }

 private:
  void ask(PathState::Asks what) { s_.asks = what; }

  // Asks for the next ray at the surface that was met, if there is to be one.
  void meet_surface(bool met, const SurfaceHit& hit) {
    ask(PathState::Asks::Nothing);
    add_crossed_lights(met ? hit.t : std::numeric_limits<float>::infinity());
    if (!met) {
      const Spectrum before = s_.sum;
      add_environments();
      counts_.escaped += s_.depth == 0 && s_.sum == before;  // a background that is there is opaque
      return;
    }
    ShadingPoint point{hit, -s_.ray.direction};
    Bsdf bsdf;
    scene_.material_of(hit).evaluate(point, bsdf);
    if (bsdf.inside() && bsdf.absorption != Spectrum{}) s_.throughput *= passed(bsdf.absorption, hit.t);
    if (bsdf.opacity < 1 && sampler_.next_1d() >= bsdf.opacity) return pass_through(hit);
    if (s_.depth == 0) report_first(first_, hit, bsdf);
    if (bsdf.emission != Spectrum{}) s_.sum += s_.throughput * bsdf.emission * weight_of_surface(hit);
    if (s_.depth >= scene_.settings.max_depth) return;
    const bool asks_light = choose_light(point, bsdf);
    s_.goes_on = scatter(point, bsdf);
    if (asks_light)
      ask(PathState::Asks::Light);
    else
      go_on();
  }

  void go_on() { ask(s_.goes_on ? PathState::Asks::Surface : PathState::Asks::Nothing); }

  // Beer's law.
  static Spectrum passed(Spectrum absorption, float distance) {
    const Spectrum d = absorption * -distance;
    return {std::exp(d.x), std::exp(d.y), std::exp(d.z)};
  }

  void pass_through(const SurfaceHit& hit) {
    if (++s_.passes > max_passes) return;
    s_.travelled += hit.t;
    s_.ray = ray_from(hit, s_.ray.direction, s_.ray.time);
    ask(PathState::Asks::Surface);
  }

  // The weight of light that a ray met by chance and that choose_light() might have found as well.
  float weight_met(std::size_t light, float light_pdf) const {
    if (s_.last_pdf == 0) return 1;  // a camera ray
    return power_heuristic(s_.last_pdf, choice_.probability(s_.last_vertex, light) * light_pdf);
  }

  void add_environments() {
    for (const std::size_t i : choice_.environments()) {
      const Spectrum radiance = scene_.lights[i]->escaped(s_.ray.direction);
      if (radiance == Spectrum{}) continue;
      s_.sum += s_.throughput * radiance * weight_met(i, scene_.lights[i]->pdf_escaped(s_.ray.direction));
    }
  }

  void add_crossed_lights(float end) {
    choice_.tree().visit_crossed(s_.ray, end, [&](std::size_t i) {
      if (scene_.lights[i]->object() >= 0) return;  // counted where the surface is hit
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

  // Makes the ray to a light, if one may bring something.
  bool choose_light(const ShadingPoint& point, const Bsdf& bsdf) {
    if (scene_.lights.empty()) return false;
    const float random_pick = sampler_.next_1d();
    const Vec2f random = sampler_.next_2d();
    const LightChoice::Pick pick = choice_.pick(receiver(point, bsdf), random_pick);
    if (pick.light < 0) return false;
    const LightSample light = scene_.lights[std::size_t(pick.light)]->sample(point.hit.position, random);
    const float pdf = light.pdf * pick.probability;
    if (!(pdf > 0)) return false;
    const Spectrum f = bsdf.evaluate(point.wo, light.direction);
    if (f == Spectrum{} || light.radiance == Spectrum{}) return false;
    const float weight = light.is_delta ? 1 : power_heuristic(pdf, bsdf.pdf(point.wo, light.direction));
    ++counts_.shadow;
    s_.light = s_.throughput * f * light.radiance;
    s_.light_scale = weight / pdf;
    s_.visible = 1;
    s_.light_passes = 0;
    s_.shadow = ray_from(point.hit, light.direction, s_.ray.time);
    s_.shadow.t_max = light.distance;
    return true;
  }

  // Light from behind matters only to a surface that lets it through.
  static Receiver receiver(const ShadingPoint& point, const Bsdf& bsdf) {
    if (bsdf.transmits()) return {point.hit.position, {}};
    const Vec3f normal = point.hit.geometric_normal;
    return {point.hit.position, dot(normal, point.wo) < 0 ? -normal : normal};
  }

  // A surface in the way of the light dims it, or ends its way.
  void meet_towards_light(bool met, const SurfaceHit& veil) {
    if (!met) return add_light(s_.visible);
    if (!path_.transparency()) return add_light(0);
    Bsdf bsdf;
    scene_.material_of(veil).evaluate({veil, -s_.shadow.direction}, bsdf);
    s_.visible *= 1 - bsdf.opacity;
    if (!(s_.visible > 0) || ++s_.light_passes == max_passes) return add_light(0);
    const float rest = s_.shadow.t_max - veil.t;
    s_.shadow = ray_from(veil, s_.shadow.direction, s_.shadow.time);
    s_.shadow.t_max = rest;
  }

  void add_light(float visible) {
    s_.sum += s_.light * (s_.light_scale * visible);
    go_on();
  }

  bool scatter(const ShadingPoint& point, const Bsdf& bsdf) {
    const float choice = sampler_.next_1d();
    const Vec2f random = sampler_.next_2d();
    const BsdfSample s = bsdf.sample(point.wo, random, choice);
    if (!(s.pdf > 0) || s.weight == Spectrum{}) return false;
    s_.throughput *= s.weight;
    s_.entered *= s.eta * s.eta;
    if (++s_.depth >= path_.roulette_depth()) {
      const float survival = std::min(0.95f, max_component(s_.throughput) * s_.entered);
      if (sampler_.next_1d() >= survival) return false;
      s_.throughput /= survival;
    }
    ++counts_.bounce;
    s_.last_pdf = s.pdf;
    s_.last_vertex = receiver(point, bsdf);
    s_.travelled = 0;
    s_.ray = ray_from(point.hit, s.wi, s_.ray.time);
    return true;
  }

  const Path& path_;
  const LightChoice& choice_;
  const Scene& scene_;
  Sampler& sampler_;
  RayCounts& counts_;
  FirstSurface* const first_;  // null: nobody asks
  PathState& s_;
};

RayRequest request_of(const PathState& state, bool transparency) {
  if (state.asks == PathState::Asks::Surface) return {RayRequest::Kind::Nearest, state.ray};
  if (state.asks == PathState::Asks::Nothing) return {RayRequest::Kind::None, state.ray};
  return {transparency ? RayRequest::Kind::Nearest : RayRequest::Kind::Any, state.shadow};
}

Spectrum Path::radiance(const Ray& ray, const Scene& scene, Sampler& sampler, RayCounts& counts,
                        FirstSurface* first) const {
  const Intersector& world = *scene.intersector;
  PathState state;
  Walk walk(*this, {scene, sampler, counts, first}, state);
  walk.begin(ray);
  while (state.asks != PathState::Asks::Nothing) {
    const RayRequest request = request_of(state, transparency_);
    SurfaceHit hit;
    const bool met =
        request.kind == RayRequest::Kind::Any ? world.occluded(request.ray) : world.intersect(request.ray, hit);
    walk.answer(met, hit);
  }
  return state.sum;
}

void Path::begin(void* state, const Ray& ray, const PathTools& tools) const {
  Walk(*this, tools, *new (state) PathState).begin(ray);
}

RayRequest Path::request(const void* state) const {
  return request_of(*static_cast<const PathState*>(state), transparency_);
}

void Path::answer(void* state, bool met, const SurfaceHit& hit, const PathTools& tools) const {
  Walk(*this, tools, *static_cast<PathState*>(state)).answer(met, hit);
}

}  // namespace

void register_path(IntegratorRegistry& r) { r.add<Path>("path", "Unidirectional path tracing: the default"); }

}  // namespace meristem
