// A medium whose density is an expression over positions: a number for even mist, fbm for clouds, vdb() for a file.
//
//   "media": [ { "density": "0.03*exp(-P[1]/4)", "albedo": 0.95, "anisotropy": 0.6, "from": [-50,0,-50], "to":
//   [50,20,50] } ]
//
// Free flights by delta tracking, transmittance by ratio tracking (Novak, Selle, Jarosz 2014, "Residual Ratio Tracking
// for Estimating Attenuation in Participating Media", section 3): both unbiased, whatever the density, and by majorants
// from the expression's own bounds over about 32,768 cells.
#pragma once

#include "geometry/base/params.h"
#include "geometry/fields/expression.h"
#include "renderer/media/majorant_grid.h"
#include "renderer/scene/medium.h"

#include <memory>
#include <optional>
#include <span>

namespace meristem {

class ExpressionMedium final : public Medium {
 public:
  static constexpr float max_density = 1e4f;  // per metre: thicker matter is a surface

  explicit ExpressionMedium(Params& params);

  // Where it has no box of its own it fills `scene`. Throws a std::runtime_error if the density is not bounded there by
  // max_density, or there is no box at all. Before the first ray.
  void fill(const Bounds3f& scene);

  bool collide(const Ray& ray, RandomStream& random, MediumCollision& collision) const override;
  float transmittance(const Ray& ray, RandomStream& random) const override;

 private:
  static constexpr int batch = 8;
  struct Candidates;  // so many tentative collisions, with their densities
  bool look(const Ray& ray, TentativeCollisions& tentative, RandomStream& random, Candidates& c) const;
  void densities(Candidates& c) const;
  float bound(const Bounds3d& box) const;
  Spectrum color(const Expression& e, Vec3f place, float upper) const;

  std::shared_ptr<const Expression> density_, albedo_, emission_;
  float anisotropy_ = 0;
  std::optional<Bounds3f> box_;
  MajorantGrid majorants_;
};

}  // namespace meristem
