#include "renderer/cameras/view_frame.h"

namespace meristem {

ViewFrame::ViewFrame(Params& params, Vec3d usual_from, Vec3d usual_to) {
  const Vec3d from = params.vector("from", usual_from, {-1e9, 1e9, "m"}, "where the camera stands");
  const Vec3d to = params.vector("to", usual_to, {-1e9, 1e9, "m"}, "the point in the middle of the image");
  const Vec3d up = params.vector("up", {0, 1, 0}, any_range, "the direction that points up in the image");

  Vec3d forward = normalize(to - from);
  if (length_squared(forward) == 0) {
    params.error("to", "the camera looks at the point where it stands: \"to\" must differ from \"from\"");
    forward = {0, 0, -1};
  }
  Vec3d right = normalize(cross(forward, normalize(up)));
  if (length_squared(right) == 0) {
    params.error("up", "\"up\" must not be zero or parallel to the view direction");
    Vec3d unused;
    orthonormal_basis(forward, right, unused);
  }
  target_ = to;
  origin_ = Vec3f(from);
  forward_ = Vec3f(forward);
  right_ = Vec3f(right);
  up_ = Vec3f(cross(right, forward));
}

CameraMatrices::Matrix ViewFrame::matrix() const {
  const Vec3d r(right_), u(up_), f(forward_), o = to_view({});
  return {r.x, u.x, f.x, 0, r.y, u.y, f.y, 0, r.z, u.z, f.z, 0, o.x, o.y, o.z, 1};
}

CameraMatrices::Matrix ViewFrame::matrix(const CameraMatrices::Matrix& to_picture) const {
  const CameraMatrices::Matrix to_camera = matrix();
  CameraMatrices::Matrix result{};
  for (std::size_t i = 0; i < 16; ++i)
    for (std::size_t k = 0; k < 4; ++k) result[i] += to_camera[i / 4 * 4 + k] * to_picture[k * 4 + i % 4];
  return result;
}

}  // namespace meristem
