#include "renderer/cameras/moving_camera.h"

#include "geometry/cells/footprint.h"

#include <algorithm>

namespace meristem {

MovingCamera::Place MovingCamera::place(float time) const {
  const float at = std::clamp(time, 0.f, 1.f) * float(keys_.size() - 1);
  const std::size_t key = std::min(std::size_t(at), keys_.size() - 2);
  return {key, at - float(key)};
}

Ray MovingCamera::between(Ray ray, const Ray& next, float share) {
  ray.origin = ray.origin * (1 - share) + next.origin * share;
  ray.direction = normalize(ray.direction * (1 - share) + next.direction * share);
  return ray;
}

Ray MovingCamera::ray(const CameraSample& sample, int width, int height) const {
  const Place at = place(sample.time);
  Ray ray = between(keys_[at.key]->ray(sample, width, height), keys_[at.key + 1]->ray(sample, width, height), at.share);
  ray.time = sample.time;
  return ray;
}

Ray MovingCamera::axis(float time, int width, int height) const {
  const Place at = place(time);
  return between(keys_[at.key]->axis(time, width, height), keys_[at.key + 1]->axis(time, width, height), at.share);
}

const Camera& MovingCamera::nearest(float time) const {
  const Place at = place(time);
  return *keys_[at.share < 0.5f ? at.key : at.key + 1];
}

float MovingCamera::footprint_at(Vec3f position, float time, int width, int height) const {
  return nearest(time).footprint(position, width, height);
}

float MovingCamera::footprint(Vec3f position, int width, int height) const {
  float least = footprint_at(position, 0, width, height);
  for (int i = 1; i < Footprint::times; ++i)
    least = std::min(least, footprint_at(position, Footprint::share_of_shutter(i), width, height));
  return least;
}

// Seen from where the nearest key stands, not from where the ray does.
PixelCone MovingCamera::cone(const Ray& ray, int width, int height) const {
  const Camera& key = nearest(ray.time);
  const CameraSample center{{0.5f * float(width), 0.5f * float(height)}, {0.5f, 0.5f}};
  Ray from_key = ray;
  from_key.origin = key.ray(center, width, height).origin;
  return key.cone(from_key, width, height);
}

}  // namespace meristem
