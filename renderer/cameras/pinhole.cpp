// pinhole: a perspective camera in which everything is sharp.
//
// Stands at `from` and looks at `to`; `fov` is the vertical field of view, so a wider image shows more at its sides.
// `shift_x` and `shift_y` move the image on its plane without turning the camera: verticals stay parallel.
#include "renderer/cameras/perspective.h"

namespace meristem {
namespace {

class Pinhole : public Camera {
 public:
  explicit Pinhole(Params& params) : perspective_(params) {}

  Ray ray(const CameraSample& sample, int width, int height) const override {
    Ray ray;
    ray.origin = perspective_.origin();
    ray.direction = normalize(perspective_.to_world(perspective_.image_point(sample.film, width, height)));
    return ray;
  }
  bool has_lens() const override { return false; }
  Ray axis(float, int, int) const override { return perspective_.axis(1); }
  float footprint(Vec3f position, int width, int height) const override {
    return perspective_.footprint(position, width, height);
  }
  std::pair<float, float> footprint_range(Vec3f center, float radius, int width, int height) const override {
    return perspective_.footprint_range(center, radius, width, height);
  }
  std::optional<Vec2f> project(Vec3d position, int width, int height) const override {
    return perspective_.project(position, width, height);
  }
  std::optional<CameraMatrices> matrices(int width, int height) const override {
    return perspective_.matrices(width, height);
  }

 private:
  Perspective perspective_;
};

}  // namespace

void register_pinhole(CameraRegistry& r) {
  r.add<Pinhole>("pinhole", "A perspective camera in which everything is sharp");
}

}  // namespace meristem
