#include "renderer/session/camera_paths.h"

namespace meristem {

namespace {

Ray axis_at(const Scene& scene, float time) {
  return scene.camera->axis(time, scene.settings.width, scene.settings.height);
}

}  // namespace

CameraPaths::CameraPaths(const Scene& scene)
    : scene_(scene), filter_(*scene.filter), view_axis_(axis_at(scene, 0)), has_lens_(scene.camera->has_lens()) {}

CameraPaths::Start CameraPaths::start(const PixelSample& sample, Sampler& sampler) const {
  const RenderSettings& settings = scene_.settings;
  sampler.start(sample.x, sample.y, int(sample.number), settings.seed);
  // Choose where in the filter's support the ray passes, and where on the lens
  const FilterSample at = filter_.sample(sampler.next_2d());
  const Vec2f pixel{float(sample.x) + 0.5f, float(sample.y) + 0.5f};
  CameraSample camera_sample{pixel + at.offset, {0.5f, 0.5f}};
  if (has_lens_)
    camera_sample.lens = sampler.next_2d();
  else
    sampler.skip_2d();
  if (scene_.moves) camera_sample.time = sampler.next_1d();
  Start start{scene_.camera->ray(camera_sample, settings.width, settings.height), at.weight < 0 ? -1 : 1};
  start.ray.time = camera_sample.time;
  return start;
}

void CameraPaths::measure(FilmSample& sample) const {
  if (!sample.first || !sample.first->hit.valid()) return;
  const SurfaceHit& hit = sample.first->hit;
  const float time = sample.first->time;
  const Ray axis = scene_.moves ? axis_at(scene_, time) : view_axis_;
  const Vec3f from_camera = hit.position - axis.origin;
  sample.depth = scene_.camera->has_axis() ? dot(from_camera, axis.direction) : length(from_camera);
  const RenderSettings& s = scene_.settings;
  if (scene_.motion_vectors) sample.motion = scene_.motion_vectors->at(hit, time, *scene_.camera, s.width, s.height);
}

}  // namespace meristem
