// Footprint: how coarse geometry may be where: the wanted size of a face, by position in the model's space.
//
// What level of detail is decided from, and all that geometry knows of a camera. A pure function: never of what is
// cached, of threads or of rays. Immutable; any thread.
#pragma once

#include "geometry/base/transform.h"

#include <limits>
#include <memory>

namespace meristem {

class Footprint {
 public:
  virtual ~Footprint() = default;
  // The size a face may have at a point, in units of the model; positive. While the shutter is open things may move:
  // the least of these times, which are equidistant, the first when it opens, the last when it closes.
  virtual double at(Vec3d position) const = 0;
  static constexpr int times = 5;
  static constexpr float share_of_shutter(int time) { return float(time) / (times - 1); }
  // Whether the last level of every vertex fades in as the footprint shrinks, so that what is shown is a continuous
  // function of the footprint.
  virtual bool fades() const { return false; }
  // Bounds on at() over a box, at all times. As far as they are known: else from 0 to infinity.
  struct Range {
    double least = 0, most = std::numeric_limits<double>::infinity();
  };
  virtual Range range(const Bounds3d& box) const {
    (void)box;
    return {};
  }
  // At one of them.
  virtual double at(Vec3d position, int time) const {
    (void)time;
    return at(position);
  }
};

// The same everywhere: for objects so small or so far away that it hardly varies over them.
class ConstantFootprint final : public Footprint {
 public:
  explicit ConstantFootprint(double size, bool fades = false) : size_(size), fades_(fades) {}
  double at(Vec3d) const override { return size_; }
  Range range(const Bounds3d&) const override { return {size_, size_}; }
  bool fades() const override { return fades_; }

 private:
  double size_;
  bool fades_;
};

// A footprint seen from the space of an object that is placed where it holds.
class ObjectFootprint final : public Footprint {
 public:
  ObjectFootprint(std::shared_ptr<const Footprint> parent, const Affine3d& to_parent);
  double at(Vec3d position) const override { return parent_->at(to_parent_.point(position)) / stretch_; }
  double at(Vec3d position, int time) const override {
    return parent_->at(to_parent_.point(position), time) / stretch_;
  }
  Range range(const Bounds3d& box) const override {
    const Range r = parent_->range(to_parent_.bounds(box));
    return {r.least / stretch_, r.most / stretch_};
  }
  bool fades() const override { return parent_->fades(); }

 private:
  const std::shared_ptr<const Footprint> parent_;
  const Affine3d to_parent_;
  const double stretch_;  // the most that to_parent lengthens a vector
};

// A bound on the factor by which an affine map lengthens any vector (exact for similarities).
double largest_stretch(const Affine3d& map);

}  // namespace meristem
