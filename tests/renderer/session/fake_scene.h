// A scene without geometry: light is a function of the pixel and the sample's random numbers, so what a session must
// deliver can be told beforehand.
#pragma once

#include "geometry/base/key.h"
#include "renderer/scene/scene.h"

#include <atomic>
#include <functional>
#include <limits>

namespace meristem {

class FakeSampler : public Sampler {
 public:
  std::unique_ptr<Sampler> clone() const override { return std::make_unique<FakeSampler>(*this); }
  void start(int x, int y, int sample, std::uint64_t seed) override {
    key_ = hash_keys(seed, Key(x), Key(y), Key(sample)), dimension_ = 0;
  }
  float next_1d() override { return uniform_float(hash_keys(key_, dimension_++)); }
  Vec2f next_2d() override { return {next_1d(), next_1d()}; }
  std::uint32_t dimension() const override { return std::uint32_t(dimension_); }
  void go_to(std::uint32_t dimension) override { dimension_ = dimension; }

 private:
  Key key_ = 0, dimension_ = 0;
};

// The ray's origin is the position on the film.
class FakeCamera : public Camera {
 public:
  Ray ray(const CameraSample& sample, int, int) const override {
    return {{sample.film.x, sample.film.y, 0}, {0, 0, 1}};
  }
  float footprint(Vec3f, int, int) const override { return 1; }
};

class BoxFilter : public Filter {
 public:
  float radius() const override { return 0.5f; }
  float value(float) const override { return 1; }
};

class EmptyWorld : public Intersector {
 public:
  bool intersect(const Ray&, SurfaceHit&) const override { return false; }
  bool occluded(const Ray&) const override { return false; }
  Bounds3f bounds() const override { return {}; }
};

class FunctionIntegrator : public Integrator {
 public:
  using Function = std::function<Spectrum(const Ray&, Sampler&, RayCounts&)>;
  std::function<void(const Ray&, FirstSurface&)> first_surface = {};  // what the ray shows
  explicit FunctionIntegrator(Function function) : function_(std::move(function)) {}
  Spectrum radiance(const Ray& ray, const Scene&, Sampler& sampler, RayCounts& counts,
                    FirstSurface* first) const override {
    ++counts.camera;
    if (first && first_surface) first_surface(ray, *first);
    return function_(ray, sampler, counts);
  }

 private:
  Function function_;
};

inline std::unique_ptr<Scene> fake_scene(int width, int height, int samples, FunctionIntegrator::Function light) {
  auto scene = std::make_unique<Scene>();
  scene->camera = std::make_unique<FakeCamera>();
  scene->sampler = std::make_unique<FakeSampler>();
  scene->filter = std::make_unique<BoxFilter>();
  scene->intersector = std::make_unique<EmptyWorld>();
  scene->integrator = std::make_unique<FunctionIntegrator>(std::move(light));
  scene->settings.width = width;
  scene->settings.height = height;
  scene->settings.samples = samples;
  return scene;
}

}  // namespace meristem
