// Perspective: what all perspective cameras share: where they stand, their image plane and the footprint of a pixel.
// Reads the parameters from, to, up, fov, shift_x, shift_y. Immutable; any thread.
#pragma once

#include "renderer/cameras/view_frame.h"

namespace meristem {

class Perspective {
 public:
  explicit Perspective(Params& params);

  Vec3f origin() const { return frame_.origin(); }
  Vec3d target() const { return frame_.target(); }
  // The point of the image plane at depth 1 behind a film position, as a vector from origin(): right, up, forward.
  Vec3f image_point(Vec2f film, int width, int height) const;
  Vec3f to_world(Vec3f v) const { return frame_.to_world(v); }
  // At right angles to the image plane, however that is shifted; found from the point at that depth on it.
  Ray axis(float depth) const;
  // The film position behind which a world position lies; nothing if it is not in front.
  std::optional<Vec2f> project(Vec3d position, int width, int height) const;
  CameraMatrices matrices(int width, int height) const;
  // Depth of a world position along the view direction.
  float depth(Vec3f position) const { return dot(position - origin(), frame_.forward()); }

  // The side of a pixel at the depth of `position`. Inside the smallest cone around the axis that holds the image this
  // is the exact projection. Outside, the depth is that on the cone's edge at the same distance, and the size grows by
  // the factor 1 + 2 * (radians outside): what only mirrors and shadows see need not be as fine. Continuous everywhere.
  float footprint(Vec3f position, int width, int height) const;
  // Bounds on it in a sphere, as Camera has it: known unless the sphere is near.
  std::pair<float, float> footprint_range(Vec3f center, float radius, int width, int height) const;

 private:
  float cone_tangent_squared(int width, int height) const;  // of the cone that holds the image

  ViewFrame frame_;
  float half_height_ = 0;            // of the image plane at depth 1
  float shift_x_ = 0, shift_y_ = 0;  // in image heights
};

}  // namespace meristem
