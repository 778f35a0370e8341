// thin_lens: a perspective camera with a lens, sharp at one depth and blurred before and behind it.
//
// As pinhole, and: the lens's opening is given by `aperture_radius`, or by `f_stop` and `focal_length`, as on a
// photographer's lens. The plane of sharpness lies at `focus_distance` along the view direction, or goes through
// `focus_point`; without either, through `to`. The footprint stays that of a pixel in focus.
#include "renderer/cameras/perspective.h"
#include "renderer/scene/warps.h"

namespace meristem {
namespace {

class ThinLens : public Camera {
 public:
  explicit ThinLens(Params& params) : perspective_(params) {
    const double radius = params.real("aperture_radius", 0, {0, 1e6, "m"}, "radius of the opening; 0: from f_stop");
    const double f_stop = params.real("f_stop", 2.8, {0.1, 1e6, ""}, "focal length / diameter of the opening");
    const double focal_length = params.real("focal_length", 0.05, {1e-4, 1e3, "m"}, "focal length, used with f_stop");
    const Vec3d point = params.vector("focus_point", perspective_.target(), {-1e9, 1e9, "m"}, "a point that is sharp");
    const double distance = params.real("focus_distance", 0, {0, 1e9, "m"}, "depth that is sharp; 0: focus_point's");
    radius_ = float(radius > 0 ? radius : focal_length / f_stop / 2);
    focus_ = distance > 0 ? float(distance) : perspective_.depth(Vec3f(point));
    if (!(focus_ > 0)) {
      params.error("focus_point", "the focus must lie in front of the camera");
      focus_ = 1;
    }
  }

  Ray ray(const CameraSample& sample, int width, int height) const override {
    const Vec2f disk = concentric_disk(sample.lens) * radius_;
    const Vec3f lens{disk.x, disk.y, 0};
    const Vec3f target = perspective_.image_point(sample.film, width, height) * focus_;
    Ray ray;
    ray.origin = perspective_.origin() + perspective_.to_world(lens);
    ray.direction = normalize(perspective_.to_world(target - lens));
    return ray;
  }
  float footprint(Vec3f position, int width, int height) const override {
    return perspective_.footprint(position, width, height);
  }
  std::pair<float, float> footprint_range(Vec3f center, float radius, int width, int height) const override {
    return perspective_.footprint_range(center, radius, width, height);
  }
  Ray axis(float, int, int) const override { return perspective_.axis(focus_); }
  std::optional<Vec2f> project(Vec3d position, int width, int height) const override {
    return perspective_.project(position, width, height);
  }
  std::optional<CameraMatrices> matrices(int width, int height) const override {
    return perspective_.matrices(width, height);
  }

 private:
  Perspective perspective_;
  float radius_ = 0;
  float focus_ = 1;  // depth
};

}  // namespace

void register_thin_lens(CameraRegistry& r) { r.add<ThinLens>("thin_lens", "A perspective camera with depth of field"); }

}  // namespace meristem
