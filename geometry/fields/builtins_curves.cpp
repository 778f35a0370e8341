#include "geometry/fields/builder.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace meristem {

namespace {

// A control point of a curve: what holds from it to the next one.
struct ControlPoint {
  double position, value;
  int interpolation;  // 0 none, 1 linear, 2 smooth, 3 spline, 4 monotone spline
  double slope = 0;
};

void set_slopes(std::vector<ControlPoint>& p) {
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const double width = p[i + 1].position - p[i - 1].position;
    p[i].slope = width > 0 ? (p[i + 1].value - p[i - 1].value) / width : 0;
  }
  // Fritsch and Carlson 1980: slopes of at most three times the secant keep a piece monotone
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    if (p[i].interpolation != 4) continue;
    const double width = p[i + 1].position - p[i].position;
    const double secant = width > 0 ? (p[i + 1].value - p[i].value) / width : 0;
    for (double* slope : {&p[i].slope, &p[i + 1].slope})
      *slope = secant == 0 ? 0 : std::clamp(*slope / secant, 0.0, 3.0) * secant;
  }
}

CurvePiece piece_between(const ControlPoint& a, const ControlPoint& b) {
  const double h = b.position - a.position, rise = b.value - a.value;
  auto piece = [&](double c1, double c2, double c3) {
    auto number = [](double v) {
      return float(
          std::clamp(v, -double(std::numeric_limits<float>::max()), double(std::numeric_limits<float>::max())));
    };
    return CurvePiece{float(a.position), float(a.value), number(c1), number(c2), number(c3)};
  };
  if (h <= 0 || a.interpolation == 0) return piece(0, 0, 0);
  if (a.interpolation == 1) return piece(rise / h, 0, 0);
  if (a.interpolation == 2) return piece(0, 3 * rise / (h * h), -2 * rise / (h * h * h));
  return piece(a.slope, (3 * rise / h - 2 * a.slope - b.slope) / h, (a.slope + b.slope - 2 * rise / h) / (h * h));
}

CurveTable curve_through(std::vector<ControlPoint> points) {
  std::ranges::stable_sort(points, {}, &ControlPoint::position);
  set_slopes(points);
  CurveTable table;
  const float lowest = std::numeric_limits<float>::lowest();
  table.pieces.push_back({lowest, float(points.front().value), 0, 0, 0});
  for (std::size_t i = 0; i + 1 < points.size(); ++i) table.pieces.push_back(piece_between(points[i], points[i + 1]));
  table.pieces.push_back({float(points.back().position), float(points.back().value), 0, 0, 0});
  return table;
}

CurveTable curve_of(Builder& b, Arguments a, int component) {
  std::vector<ControlPoint> points;
  for (std::size_t i = 1; i + 2 < a.size(); i += 3)
    points.push_back({b.g.constant_value(a[i]).x, b.g.constant_value(a[i + 1])[component],
                      b.integer(a, i + 2, 1, 0, 4, "the interpolation of a curve")});
  return curve_through(std::move(points));
}
NodeId curve(CallContext& call, Arguments a) {
  Builder b(call);
  return b.g.curve(a[0], curve_of(b, a, 0));
}
NodeId ccurve(CallContext& call, Arguments a) {
  Builder b(call);
  std::array<NodeId, 3> parts{};
  for (int c = 0; c < 3; ++c) parts[std::size_t(c)] = b.g.curve(a[0], curve_of(b, a, c));
  return b.g.make_vector(parts[0], parts[1], parts[2]);
}

template <Op op>
NodeId grid_at(CallContext& call, Arguments a) {
  return call.graph().grid(op, a[1], call.grid(0, 2));
}

constexpr Builtin builtins[] = {
    {{"curve", "curves", "curve(x, pos, value, interp, ...)",
      "through constant points; interp 0 none, 1 linear, 2 smooth, 3 spline, 4 monotone spline"},
     "s*kkk",
     curve},
    {{"ccurve", "curves", "ccurve(x, pos, color, interp, ...)", "a curve of vectors"}, "s*kmk", ccurve},
    {{"spline", "curves", "spline(x, y1, y2, y3, y4, ...)",
      "Catmull-Rom from y2 at x = 0 to the last but one at x = 1"},
     "ssss*s",
     direct<Op::Spline>},

    {{"vdb", "grids", "vdb('name', v, 'grid')",
      "the value at v of an OpenVDB file beside the scene ('rock.vdb'), or of one of the scene's grids by its name"},
     "tv;t",
     grid_at<Op::GridValue>},
    {{"vdb_gradient", "grids", "vdb_gradient('name', v, 'grid')",
      "how that value rises along x, y and z; of a level set the direction away from the surface"},
     "tv;t",
     grid_at<Op::GridGradient>},
};

}  // namespace

std::span<const Builtin> curve_builtins() { return builtins; }

}  // namespace meristem
