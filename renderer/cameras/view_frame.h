// ViewFrame: where a camera stands and where it looks. Reads the parameters from, to, up. Immutable; any thread.
#pragma once

#include "renderer/scene/interfaces.h"

namespace meristem {

class ViewFrame {
 public:
  ViewFrame(Params& params, Vec3d usual_from, Vec3d usual_to);

  Vec3f origin() const { return origin_; }
  Vec3d target() const { return target_; }  // `to`
  Vec3f forward() const { return forward_; }
  // A vector that is given as right, up, forward, in the world,
  Vec3f to_world(Vec3f v) const { return right_ * v.x + up_ * v.y + forward_ * v.z; }
  // and the way from origin() to a world position as such.
  Vec3d to_view(Vec3d position) const {
    const Vec3d v = position - Vec3d(origin_);
    return {dot(v, Vec3d(right_)), dot(v, Vec3d(up_)), dot(v, Vec3d(forward_))};
  }
  // What to_view() does as a matrix for other programs;
  CameraMatrices::Matrix matrix() const;
  // and followed by another, from right, up, forward to the picture.
  CameraMatrices::Matrix matrix(const CameraMatrices::Matrix& to_picture) const;

 private:
  Vec3d target_;
  Vec3f origin_, right_, up_, forward_;  // unit, at right angles
};

}  // namespace meristem
