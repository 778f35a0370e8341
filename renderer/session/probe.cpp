#include "renderer/session/probe.h"

#include "geometry/base/parallel.h"

#include <chrono>
#include <cstddef>
#include <memory>

namespace meristem {

namespace {

using Clock = std::chrono::steady_clock;

class PathProbe {
 public:
  PathProbe(const Scene& scene, const PathTools& tools, std::vector<ProbedRay>& rays)
      : stepper_(*scene.integrator->stepper()),
        world_(*scene.intersector),
        tools_(tools),
        rays_(rays),
        state_(std::make_unique<std::max_align_t[]>(stepper_.state_bytes() / sizeof(std::max_align_t) + 1)) {}

  Spectrum follow(const Ray& camera_ray) {
    stepper_.begin(state_.get(), camera_ray, tools_);
    while (answer(0) || answer(1)) {}
    return stepper_.result(state_.get());
  }

 private:
  // False if the path does not ask for this ray.
  bool answer(int number) {
    const RayRequest request = stepper_.request(state_.get(), number);
    if (request.kind == RayRequest::Kind::None) return false;
    ShadingPoint point;
    rays_.push_back(traced(request, number == 0, point.hit));
    stepper_.answer(state_.get(), number, rays_.back().met, point, tools_);
    return true;
  }

  ProbedRay traced(const RayRequest& request, bool is_light, SurfaceHit& hit) const {
    ProbedRay probed{.ray = request.ray, .is_light = is_light, .any = request.kind == RayRequest::Kind::Any};
    RayQuery query{&request.ray, probed.any ? nullptr : &hit, false, &probed.expansions};
    const Clock::time_point started = Clock::now();
    world_.trace_alone(query);
    probed.seconds = std::chrono::duration<double>(Clock::now() - started).count();
    probed.met = query.met;
    if (!probed.any && probed.met) probed.hit = hit;
    return probed;
  }

  const PathStepper& stepper_;
  const Intersector& world_;
  const PathTools& tools_;
  std::vector<ProbedRay>& rays_;
  const std::unique_ptr<std::max_align_t[]> state_;
};

ProbedSample probe_sample(const Scene& scene, const CameraPaths& camera, Sampler& sampler, const PixelSample& at) {
  ProbedSample probed;
  RayCounts counts;
  const CameraPaths::Start start = camera.start(at, sampler);
  probed.first.time = start.ray.time;
  if (scene.integrator->stepper()) {
    const PathTools tools{scene, sampler, counts, &probed.first};
    probed.radiance = PathProbe(scene, tools, probed.rays).follow(start.ray);
  } else {
    ProbedRay& ray = probed.rays.emplace_back(ProbedRay{.ray = start.ray});
    RayQuery query{&start.ray, &ray.hit, false, &ray.expansions};
    scene.intersector->trace_alone(query);
    ray.met = query.met;
    probed.radiance = scene.integrator->radiance(start.ray, scene, sampler, counts, &probed.first);
  }
  FilmSample sample{.first = &probed.first};
  camera.measure(sample);
  probed.depth = sample.depth;
  return probed;
}

}  // namespace

std::vector<ProbedSample> probe_pixel(const Scene& scene, int x, int y, int samples) {
  std::vector<ProbedSample> probed;
  const CameraPaths camera(scene);
  run_threads(1, [&](int) {
    const std::unique_ptr<Sampler> sampler = scene.sampler->clone();
    for (int i = 0; i < samples; ++i) probed.push_back(probe_sample(scene, camera, *sampler, {x, y, std::uint32_t(i)}));
  });
  return probed;
}

}  // namespace meristem
