// orthographic: a camera without perspective, for plans, elevations and maps of whole models.
//
// All rays are parallel, from the plane through `from` at right angles to the view direction: what lies behind that
// plane is not seen. `height` is what the image shows from its lower to its upper edge. A pixel has one size in all
// depths. Outside of what is seen, where only mirrors and shadows look, the footprint grows by its own size with each
// half diagonal of the image.
#include "renderer/cameras/view_frame.h"

#include <algorithm>
#include <cmath>

namespace meristem {
namespace {

class Orthographic : public Camera {
 public:
  explicit Orthographic(Params& params) : frame_(params, {0, 1.5, 6}, {0, 1, 0}) {
    height_ = float(params.real("height", 4, {1e-9, 1e9, "m"}, "of what the image shows"));
  }

  Ray ray(const CameraSample& sample, int width, int height) const override {
    const float pixel = height_ / float(height);
    Ray ray;
    ray.origin = frame_.origin() + frame_.to_world({(sample.film.x - 0.5f * float(width)) * pixel,
                                                    (0.5f * float(height) - sample.film.y) * pixel, 0});
    ray.direction = frame_.forward();
    return ray;
  }
  bool has_lens() const override { return false; }
  float footprint(Vec3f position, int width, int height) const override {
    return height_ / float(height) * growth(Vec3d(position), width, height);
  }
  // The distance from what is seen differs by no more than the positions do.
  std::pair<float, float> footprint_range(Vec3f center, float radius, int width, int height) const override {
    constexpr float margin = 1e-4f;  // of rounding
    const float pixel = height_ / float(height), middle = growth(Vec3d(center), width, height);
    const float change = radius / half_diagonal(width, height) + margin * middle;
    return {pixel * std::max(middle - change, 1 - margin), pixel * (middle + change)};
  }
  PixelCone cone(const Ray&, int, int height) const override { return {height_ / float(height), 0}; }
  std::optional<Vec2f> project(Vec3d position, int width, int height) const override {
    const Vec3d v = frame_.to_view(position);
    if (!(v.z > 0)) return std::nullopt;
    const double scale = double(height) / double(height_);
    return Vec2f(float(0.5 * width + v.x * scale), float(0.5 * height - v.y * scale));
  }
  std::optional<CameraMatrices> matrices(int width, int height) const override {
    const double up = 1 / double(height_), aspect = double(width) / double(height);
    return CameraMatrices{frame_.matrix(),
                          frame_.matrix({up / aspect, 0, 0, 0, 0, -up, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0, 1})};
  }

 private:
  float half_diagonal(int width, int height) const {
    return 0.5f * height_ * std::hypot(1.f, float(width) / float(height));
  }
  // 1 in the cylinder around what is seen; by the distance from it.
  float growth(Vec3d position, int width, int height) const {
    const Vec3d v = frame_.to_view(position);
    const double radius = double(half_diagonal(width, height));
    const double aside = std::max(std::hypot(v.x, v.y) - radius, 0.0), behind = std::max(-v.z, 0.0);
    return float(1 + std::hypot(aside, behind) / radius);
  }

  ViewFrame frame_;
  float height_;
};

}  // namespace

void register_orthographic(CameraRegistry& r) {
  r.add<Orthographic>("orthographic", "A camera without perspective, for plans and elevations");
}

}  // namespace meristem
