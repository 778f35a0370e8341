// panorama: sees all around itself, as an equirectangular image: longitude from left to right, latitude upwards.
//
// The middle of the image is the direction towards `to`; the image's left and right edge meet behind the camera. Made
// twice as wide as high, pixels are square at the horizon. With the camera level and `to` towards -z, the image serves
// the light "image" as it is. Depth (the AOV Z) is the distance from the camera.
#include "renderer/cameras/view_frame.h"
#include "renderer/scene/warps.h"

#include <algorithm>
#include <cmath>

namespace meristem {
namespace {

class PanoramaCamera : public Camera {
 public:
  explicit PanoramaCamera(Params& params) : frame_(params, {0, 1.5, 0}, {0, 1.5, -1}) {}

  Ray ray(const CameraSample& sample, int width, int height) const override {
    const float longitude = 2 * pi_f * (sample.film.x / float(width) - 0.5f);
    const float latitude = pi_f * (0.5f - sample.film.y / float(height));
    Ray ray;
    ray.origin = frame_.origin();
    ray.direction = normalize(frame_.to_world(
        {std::cos(latitude) * std::sin(longitude), std::sin(latitude), std::cos(latitude) * std::cos(longitude)}));
    return ray;
  }
  bool has_lens() const override { return false; }
  bool has_axis() const override { return false; }
  float footprint(Vec3f position, int width, int height) const override {
    return pixel(width, height) * length(position - frame_.origin());
  }
  std::pair<float, float> footprint_range(Vec3f center, float radius, int width, int height) const override {
    constexpr float margin = 1e-4f;  // of rounding
    const float distance = length(center - frame_.origin()), reach = radius + margin * distance;
    return {pixel(width, height) * std::max(distance - reach, 0.f), pixel(width, height) * (distance + reach)};
  }
  std::optional<Vec2f> project(Vec3d position, int width, int height) const override {
    const Vec3d v = frame_.to_view(position);
    if (length_squared(v) == 0) return std::nullopt;
    return Vec2f(float(width * (0.5 + std::atan2(v.x, v.z) / (2 * pi))),
                 float(height * (0.5 - std::atan2(v.y, std::hypot(v.x, v.z)) / pi)));
  }
  std::optional<CameraMatrices> matrices(int, int) const override {
    return CameraMatrices{frame_.matrix(), std::nullopt};
  }

 private:
  // The lesser of its sides at the horizon, in radians.
  static float pixel(int width, int height) { return pi_f * std::min(2 / float(width), 1 / float(height)); }

  ViewFrame frame_;
};

}  // namespace

void register_panorama(CameraRegistry& r) {
  r.add<PanoramaCamera>("panorama", "Sees all around itself, as an equirectangular image");
}

}  // namespace meristem
