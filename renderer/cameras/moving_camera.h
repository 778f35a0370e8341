// MovingCamera: a camera that moves while the shutter is open, made of cameras as they are at equidistant times. Its
// rays are those between the rays of two neighbours: exact where the motion is straight, near enough where it turns by
// a few degrees from one to the next.
#pragma once

#include "renderer/scene/interfaces.h"

#include <memory>
#include <vector>

namespace meristem {

class MovingCamera final : public Camera {
 public:
  // From the opening of the shutter to its closing; at least two.
  explicit MovingCamera(std::vector<std::unique_ptr<Camera>> keys) : keys_(std::move(keys)) {}

  Ray ray(const CameraSample& sample, int width, int height) const override;
  // The least of the times of a Footprint.
  float footprint(Vec3f position, int width, int height) const override;
  float footprint_at(Vec3f position, float time, int width, int height) const override;
  PixelCone cone(const Ray& ray, int width, int height) const override;
  Ray axis(float time, int width, int height) const override;
  bool has_axis() const override { return keys_[0]->has_axis(); }
  std::optional<Vec2f> project(Vec3d position, int width, int height) const override {
    return keys_[0]->project(position, width, height);
  }
  std::optional<CameraMatrices> matrices(int width, int height) const override {
    return keys_[0]->matrices(width, height);
  }

 private:
  static Ray between(Ray ray, const Ray& next, float share);
  struct Place {
    std::size_t key;  // the one before
    float share;      // of the way to the next
  };
  Place place(float time) const;
  const Camera& nearest(float time) const;

  std::vector<std::unique_ptr<Camera>> keys_;
};

}  // namespace meristem
