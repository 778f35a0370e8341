#include "renderer/cameras/perspective.h"

#include <algorithm>
#include <cmath>

namespace meristem {

Perspective::Perspective(Params& params) : frame_(params, {0, 1.5, 6}, {0, 1, 0}) {
  const double fov = params.real("fov", 40, {0.01, 170, "deg"}, "vertical field of view");
  shift_x_ = float(params.real("shift_x", 0, {-10, 10, ""}, "shift of the image to the right, in image heights"));
  shift_y_ = float(params.real("shift_y", 0, {-10, 10, ""}, "shift of the image upwards, in image heights"));
  half_height_ = float(std::tan(fov * pi / 360));
}

Vec3f Perspective::image_point(Vec2f film, int width, int height) const {
  const float pixel = 2 * half_height_ / float(height);
  return {(film.x - 0.5f * float(width)) * pixel + 2 * half_height_ * shift_x_,
          (0.5f * float(height) - film.y) * pixel + 2 * half_height_ * shift_y_, 1};
}

Ray Perspective::axis(float depth) const {
  Ray axis;
  axis.origin = origin();
  axis.direction = normalize(to_world({0, 0, depth}));
  return axis;
}

std::optional<Vec2f> Perspective::project(Vec3d position, int width, int height) const {
  const Vec3d v = frame_.to_view(position);
  if (!(v.z > 0)) return std::nullopt;
  const double image_height = 2 * double(half_height_), scale = double(height) / (image_height * v.z);
  return Vec2f(float(0.5 * width + v.x * scale - double(shift_x_) * height),
               float(0.5 * height - v.y * scale + double(shift_y_) * height));
}

// The last coordinate is the depth; the third, which nobody reads, makes it a matrix that can be inverted.
CameraMatrices Perspective::matrices(int width, int height) const {
  const double up = 1 / (2 * double(half_height_)), aspect = double(width) / double(height);
  return {frame_.matrix(), frame_.matrix({up / aspect, 0, 0, 0,                                           //
                                          0, -up, 0, 0,                                                   //
                                          0.5 - double(shift_x_) / aspect, 0.5 + double(shift_y_), 1, 1,  //
                                          0, 0, -1, 0})};
}

namespace {

// The arc cosine to 7e-5 (Abramowitz and Stegun, 4.4.45): level of detail asks for many.
float quick_acos(float x) {
  const float a = std::abs(x);
  const float angle = std::sqrt(1 - a) * (1.5707288f + a * (-0.2121144f + a * (0.0742610f - a * 0.0187293f)));
  return x < 0 ? float(pi) - angle : angle;
}

}  // namespace

float Perspective::cone_tangent_squared(int width, int height) const {
  const float x = half_height_ * (float(width) / float(height) + 2 * std::abs(shift_x_));
  const float y = half_height_ * (1 + 2 * std::abs(shift_y_));
  return x * x + y * y;
}

// By distance and by angle from the view direction: it grows with the one, and with the other it shrinks up to the edge
// of the cone and grows from there on.
std::pair<float, float> Perspective::footprint_range(Vec3f center, float radius, int width, int height) const {
  const Vec3d v = Vec3d(center) - Vec3d(origin());
  const double distance = length(v), r = double(radius) + 1e-6 * length(Vec3d(center));
  const double cone = std::atan(std::sqrt(double(cone_tangent_squared(width, height))));
  const auto depth = [&](double a) { return a <= cone ? std::cos(a) : std::cos(cone) * (1 + 2 * (a - cone)); };
  const double pixel = 2 * double(half_height_) / height;
  constexpr double margin = 1e-3;  // of quick_acos() and of rounding
  if (!(distance > r)) return {0.f, float(pixel * (distance + r) * std::max(1.0, depth(pi)) * (1 + margin))};
  const double angle = std::acos(std::clamp(dot(v, Vec3d(frame_.forward())) / distance, -1.0, 1.0));
  const double turn = std::asin(r / distance), from = std::max(angle - turn, 0.0), to = std::min(angle + turn, pi);
  return {float(pixel * (distance - r) * depth(std::clamp(cone, from, to)) * (1 - margin)),
          float(pixel * (distance + r) * std::max(depth(from), depth(to)) * (1 + margin))};
}

float Perspective::footprint(Vec3f position, int width, int height) const {
  const Vec3f v = position - origin();
  const float z = dot(v, frame_.forward()), distance_squared = dot(v, v);
  const float pixel = 2 * half_height_ / float(height);
  const float secant_squared = 1 + cone_tangent_squared(width, height);
  if (z >= 0 && z * z * secant_squared >= distance_squared) return pixel * z;
  const float distance = std::sqrt(distance_squared), cone_cosine = 1 / std::sqrt(secant_squared);
  const float outside = quick_acos(std::max(z / distance, -1.f)) - quick_acos(cone_cosine);
  return pixel * distance * cone_cosine * (1 + 2 * std::max(0.f, outside));
}

}  // namespace meristem
