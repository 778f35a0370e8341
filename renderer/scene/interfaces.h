// The interfaces of the renderer's components and the records that travel between them. One component, one file, in the
// plural folder of its kind. Conventions: world space, y up, metres; radiance is scene-linear Rec.709; directions are
// unit and point away from the surface; `wo` towards the camera, `wi` towards the light. All const methods: any thread.
#pragma once

#include "geometry/accel/intersector.h"
#include "geometry/base/params.h"
#include "geometry/base/registry.h"
#include "geometry/base/transform.h"
#include "renderer/scene/light_bounds.h"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace meristem {

using Spectrum = Vec3f;  // scene-linear Rec.709

constexpr float luminance(Spectrum c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

// Random numbers of one camera path, by (pixel, sample, dimension): each call takes the next dimension(s).
class Sampler {
 public:
  virtual ~Sampler() = default;
  virtual std::unique_ptr<Sampler> clone() const = 0;  // one a thread
  // Starts the sequence of one sample; pixel in image coordinates.
  virtual void start(int pixel_x, int pixel_y, int sample_index, std::uint64_t seed) = 0;
  virtual float next_1d() = 0;  // [0, 1)
  virtual Vec2f next_2d() = 0;
  virtual void skip_2d() { next_2d(); }  // as a call of it whose numbers nobody wants
  // Numbers drawn since start(), and going on from there after a start() of the same sample: so a path that waits keeps
  // a count in place of a sampler.
  virtual std::uint32_t dimension() const = 0;
  virtual void go_to(std::uint32_t dimension) = 0;
};

struct CameraSample {
  Vec2f film;      // pixels from the top left corner of the image, y down
  Vec2f lens;      // [0, 1)^2
  float time = 0;  // of the shutter, [0, 1)
};

// The cone around a camera ray that a pixel sees: its width where the ray begins, and by how much it grows with the
// distance.
struct PixelCone {
  float width = 0, spread = 0;
};

// What other programs know of a camera, as OpenEXR's attributes worldToCamera and worldToNDC have it: matrices by rows,
// for points that stand as rows before them. In the space of the camera x points right, y up and z into the picture; on
// the picture (0, 0) is its upper left corner and (1, 1) its lower right one.
struct CameraMatrices {
  using Matrix = std::array<double, 16>;
  Matrix world_to_camera;
  std::optional<Matrix> world_to_picture;  // nothing if the camera maps lines to curves
};

class Camera {
 public:
  virtual ~Camera() = default;
  // The ray through film position in an image of width x height pixels; unit direction.
  virtual Ray ray(const CameraSample& sample, int width, int height) const = 0;
  // Whether ray() asks where on the lens.
  virtual bool has_lens() const { return true; }
  // The size in world units of one pixel at a world position: the footprint. Grows gently out of view. Of a camera that
  // moves the least while the shutter is open.
  virtual float footprint(Vec3f position, int width, int height) const = 0;
  // At a time from 0 to 1 of the shutter.
  virtual float footprint_at(Vec3f position, float time, int width, int height) const {
    (void)time;
    return footprint(position, width, height);
  }
  // Bounds on footprint() in a sphere, the lower first: from 0 to infinity where they are not known.
  virtual std::pair<float, float> footprint_range(Vec3f center, float radius, int width, int height) const {
    (void)center, (void)radius, (void)width, (void)height;
    return {0.f, std::numeric_limits<float>::infinity()};
  }
  virtual PixelCone cone(const Ray& ray, int width, int height) const {
    return {0, footprint(ray.origin + ray.direction, width, height)};
  }
  // Whether it looks along one axis, by which depth is measured; else it sees all around, and depth is distance.
  virtual bool has_axis() const { return true; }
  // The axis, from where the camera stands at a time from 0 to 1 of the shutter: through the middle of the image,
  // unless that is shifted.
  virtual Ray axis(float time, int width, int height) const {
    return ray({{0.5f * float(width), 0.5f * float(height)}, {0.5f, 0.5f}, time}, width, height);
  }
  // Where on the film a world position is seen when the shutter opens, from the middle of the lens; nothing if it is
  // not in front of the camera, or the camera does not know.
  virtual std::optional<Vec2f> project(Vec3d position, int width, int height) const {
    (void)position, (void)width, (void)height;
    return std::nullopt;
  }
  // The same for other programs; nothing if the camera does not know.
  virtual std::optional<CameraMatrices> matrices(int width, int height) const {
    (void)width, (void)height;
    return std::nullopt;
  }
};

// A separable reconstruction filter, by importance sampling: offset of the sample from the pixel's centre for a uniform
// number.
class Filter {
 public:
  virtual ~Filter() = default;
  virtual float radius() const = 0;        // pixels
  virtual float value(float x) const = 0;  // 1D, symmetric, may be negative
};

// Light arriving at a point from a direction.
struct LightSample {
  Vec3f direction;        // towards the light, unit
  float distance = 0;     // to the light; infinity for an environment
  Spectrum radiance;      // arriving if nothing is in between
  float pdf = 0;          // by solid angle; 0: no sample. Infinite lights that are points in direction: is_delta
  bool is_delta = false;  // pdf is 1 and no BSDF sample can meet it
};

// What a ray meets that leaves the scene.
struct EscapedLight {
  Spectrum radiance;
  float pdf = 0;  // with which sample() picks that direction
};

class Light {
 public:
  virtual ~Light() = default;
  // Called once before rendering, for what only rendering needs. May use all threads.
  virtual void prepare() {}
  virtual LightSample sample(Vec3f from, Vec2f random) const = 0;
  // Of environments.
  virtual EscapedLight escaped(Vec3f direction) const {
    (void)direction;
    return {};
  }
  // Its radiance as the camera sees it, for a pixel so wide in radians: it may be a mean, since no sample() shares in
  // it.
  virtual Spectrum background(Vec3f direction, float spread) const {
    (void)spread;
    return escaped(direction).radiance;
  }
  // Whether background() asks for the width.
  virtual bool has_texture() const { return false; }
  // Lights with a shape of their own (rectangle, sphere; seen by bounce rays, cast no shadow): the distance
  // along the ray, or infinity; then the radiance towards the ray's origin and the pdf of sample(origin) for that
  // direction.
  virtual float intersect(const Ray& ray) const {
    (void)ray;
    return std::numeric_limits<float>::infinity();
  }
  virtual Spectrum emitted(const Ray& ray, float t) const {
    (void)ray;
    (void)t;
    return {};
  }
  virtual float pdf_hit(const Ray& ray, float t) const {
    (void)ray;
    (void)t;
    return 0;
  }
  // Whether rays from the camera meet it as well, before they are scattered.
  virtual bool seen_by_camera() const { return true; }
  // A light that is the surface of an object (its index in SurfaceHit): a ray meets it by hitting the object and sees
  // what the material emits; intersect() then tells which light it is. -1 for all others.
  virtual int object() const { return -1; }
  // For choosing among lights: where one with a place stands and how it shines; none for an environment,
  virtual std::optional<LightBounds> bounds() const { return std::nullopt; }
  // whose luminance, integrated over all directions, is estimated.
  virtual float environment_power() const { return 0; }
  // An environment that is the same on all sides: sample() knows no better direction than a material does.
  virtual bool is_uniform() const { return false; }
};

// The variables that material expressions see, and their values at one hit. See renderer/materials/material_symbols.h.
struct ShadingPoint {
  SurfaceHit hit;
  Vec3f wo;
  float footprint = 0;  // width across wo of what the point stands for; textures are filtered over it
};

struct BsdfSample {
  Vec3f wi;
  Spectrum weight;  // value * |cos| / pdf
  float pdf = 0;    // by solid angle; 0: absorbed
  bool is_delta = false;
  bool is_transmission = false;
  float eta = 1;  // index of refraction on the side of wi, relative to that of wo
};

// The scattering of one hit, with all parameters evaluated. Small enough to live on the stack of the integrator.
// Directions are in world space; the side of the surface is decided by the geometric normal.
class Bsdf;

class Material {
 public:
  virtual ~Material() = default;
  virtual Bsdf evaluate(const ShadingPoint& point) const = 0;
  // Whether and what it emits: the part of evaluate()'s emission that is met on average, opacity included.
  virtual bool may_emit() const { return false; }
  virtual Spectrum emission(const ShadingPoint& point) const {
    (void)point;
    return {};
  }
  // Whether evaluate() gives every hit the same parameters.
  virtual bool is_uniform() const { return false; }
  // Whether evaluate() asks for the footprint.
  virtual bool has_textures() const { return false; }
  // Whether evaluate() or emission() ask for u, v or the tangents along them.
  virtual bool reads_uv() const { return true; }
  // False if every hit is opaque (opacity 1): shadow rays then need not ask.
  virtual bool may_be_transparent() const { return false; }
};

class Scene;

struct RayCounts {
  std::uint64_t camera = 0, bounce = 0, shadow = 0;
  std::uint64_t escaped = 0;  // of the camera rays: those that met no surface; the film's coverage is 1 - escaped

  RayCounts& operator+=(const RayCounts& o) {
    camera += o.camera, bounce += o.bounce, shadow += o.shadow, escaped += o.escaped;
    return *this;
  }
};

// What a camera ray shows: the first surface that it does not pass through. For AOVs and mattes.
struct FirstSurface {
  SurfaceHit hit;                      // not valid() if there is none; its origin is not kept
  Spectrum albedo;                     // of the surface in all, directions left out; each in [0, 1]
  int material = -1, production = -1;  // indices into Scene::names
  float time = 0;                      // of the camera ray
};

// What a path uses while it goes on.
struct PathTools {
  const Scene& scene;
  Sampler& sampler;
  RayCounts& counts;
  FirstSurface* first;  // as for Integrator::radiance()
};

// A ray that a path waits for.
struct RayRequest {
  enum class Kind : std::uint8_t { None, Nearest, Any };  // the nearest hit, or whether there is one; None: no ray
  Kind kind;
  const Ray& ray;  // part of the path's state
};

// The paths of an integrator, stopped at every vertex: so that many can be alive at once, and their rays be traced in
// any order. The state of a path is plain memory, aligned like a pointer, that may be copied. A path draws the same
// random numbers, and ends with the same bits, as one that Integrator::radiance() follows.
class PathStepper {
 public:
  // A vertex asks for the ray to a light (0) and the one that goes on (1) at once.
  static constexpr int most_rays = 2;
  virtual ~PathStepper() = default;
  virtual std::size_t state_bytes() const = 0;
  virtual void begin(void* state, const Ray& camera_ray, const PathTools& tools) const = 0;
  // A path that asks for neither has ended.
  virtual RayRequest request(const void* state, int ray) const = 0;
  // Hands over what the request met. They may be traced in any order, but the first is answered before the second; the
  // answer may bring a next request for the same ray, that to the second the next vertex. `point` holds the hit of a
  // request for the nearest; the rest of it is the path's to fill.
  virtual void answer(void* state, int ray, bool met, ShadingPoint& point, const PathTools& tools) const = 0;
  virtual Spectrum result(const void* state) const = 0;  // the radiance, of a path that has ended
};

class Integrator {
 public:
  virtual ~Integrator() = default;
  // Called once before rendering, with the scene of all later calls.
  virtual void prepare(const Scene& scene) { (void)scene; }
  // Radiance along a camera ray. Pure but for the sampler, the counts and expansion. If `first` is not null, somebody
  // wants to know what the ray shows: report_first() of renderer/integrators/first_surface.h fills it.
  virtual Spectrum radiance(const Ray& ray, const Scene& scene, Sampler& sampler, RayCounts& counts,
                            FirstSurface* first) const = 0;
  // Null: paths cannot be stopped; they are followed one by one.
  virtual const PathStepper* stepper() const { return nullptr; }
};

using SamplerRegistry = Registry<Sampler>;
using CameraRegistry = Registry<Camera>;
using FilterRegistry = Registry<Filter>;
using LightRegistry = Registry<Light>;
using MaterialRegistry = Registry<Material>;
using IntegratorRegistry = Registry<Integrator>;

}  // namespace meristem
