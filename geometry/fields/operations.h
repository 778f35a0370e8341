// Op: the operations of an expression's graph. Those up to Mix act on each component by itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace meristem {

// clang-format off
#define MERISTEM_UNARY_OPS(X) \
  X(Not) X(Abs) X(Sign) X(Floor) X(Ceil) X(Round) X(Trunc) X(Sqrt) X(Cbrt) X(Exp) X(Log) X(Log10) X(Sin) X(Cos) X(Tan) \
  X(Asin) X(Acos) X(Atan) X(Sinh) X(Cosh) X(Tanh) X(Asinh) X(Acosh) X(Atanh) X(SmoothCurve) X(GaussCurve)
#define MERISTEM_BINARY_OPS(X) \
  X(Add) X(Sub) X(Mul) X(Div) X(Mod) X(Fmod) X(Pow) X(Min) X(Max) X(Atan2) X(Less) X(LessEqual) X(Equal) X(And) X(Or)
#define MERISTEM_TERNARY_OPS(X) X(Select) X(Mix)
// The others: their operands are the components of all arguments in order.
#define MERISTEM_OTHER_OPS(X) \
  X(Dot) X(Length) X(Cross) X(Norm) X(Rotate) X(Noise) X(VectorNoise) X(Fbm) X(VectorFbm) X(Turbulence) \
  X(VectorTurbulence) X(Noise4) X(VectorNoise4) X(Fbm4) X(VectorFbm4) X(PeriodicNoise) X(CellNoise) X(CellColor) \
  X(Voronoi) X(VoronoiPosition) X(VoronoiColor) X(Rand) X(Hash) X(Spline) X(Curve) X(GridValue) X(GridGradient)
#define MERISTEM_OPS(X) MERISTEM_UNARY_OPS(X) MERISTEM_BINARY_OPS(X) MERISTEM_TERNARY_OPS(X) MERISTEM_OTHER_OPS(X)
// clang-format on

enum class Op : std::uint8_t {
#define X(name) name,
  MERISTEM_OPS(X)
#undef X
  // These need no kernel.
  Constant,
  Input,
  Component,
  MakeVector,
};

constexpr std::size_t kernel_count = std::size_t(Op::Constant);

constexpr bool is_componentwise(Op op) { return op <= Op::Mix; }
constexpr bool needs_kernel(Op op) { return op < Op::Constant; }

}  // namespace meristem
