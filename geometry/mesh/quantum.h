// Quantum: the grid on which a model's positions lie.
//
// Two cells compute the vertices they share apart from each other and must get the same bits. Every value that enters a
// sum over neighbours is a multiple of a power of two (the quantum) and less than 2^40 of them, so sums of up to
// 2^12 such values are exact in double, whatever their order; the one rounding comes after the sum. (DESIGN asks for a
// canonical order of summation at irregular vertices; rounding each term first makes every order canonical.)
#pragma once

#include "geometry/base/vec.h"

namespace meristem {

class Quantum {
 public:
  // The finest grid that holds coordinates up to +-reach (positive, finite): 2^-40 of the power of two above it.
  static Quantum for_reach(double reach);
  explicit Quantum(double step = 0x1p-40) : step_(step), magic_(step * 0x1.8p52) {}

  double step() const { return step_; }
  // What is added and taken off again to round.
  double magic() const { return magic_; }
  // The nearest multiple of the step; |x| < 2^51 steps. Not to be compiled with -ffast-math.
  double round(double x) const { return (x + magic_) - magic_; }
  Vec3d round(Vec3d v) const { return {round(v.x), round(v.y), round(v.z)}; }

 private:
  double step_;
  double magic_;
};

// The grid of unit vectors (face normals, tangents) and of u, v.
inline const Quantum unit_quantum{0x1p-36};

}  // namespace meristem
