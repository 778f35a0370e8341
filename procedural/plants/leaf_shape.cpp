#include "procedural/plants/leaf_shape.h"

#include "geometry/mesh/quantum.h"

#include <cmath>
#include <initializer_list>

namespace meristem {

namespace {

using Half = std::initializer_list<Vec2d>;  // the right half of an outline, from the foot to the tip, without both

class ShapeMaker {
 public:
  // A lobe: a blade about the line from `foot` to `tip`, folded up along it by `fold` of its width. Two faces, one on
  // each side, over the outline in the lobe's own x (across, in lengths of the lobe) and y (along, 0 ... 1).
  void add_lobe(Vec2d foot, Vec2d tip, const Half& half, double fold) {
    const Vec2d along = tip - foot, across{along.y, -along.x};
    const auto place = [&](double x, double y) { return foot + across * x + along * y; };
    const std::uint32_t first = add_vertex(foot, 0), last = add_vertex(tip, 0);
    for (const double side : {1.0, -1.0}) {
      std::vector<std::uint32_t> outline;
      for (Vec2d p : half) outline.push_back(add_vertex(place(side * p.x, p.y), fold * p.x * length(along)));
      shape_.corners.push_back(first);
      if (side < 0) shape_.corners.push_back(last);
      if (side < 0)
        shape_.corners.insert(shape_.corners.end(), outline.rbegin(), outline.rend());
      else
        shape_.corners.insert(shape_.corners.end(), outline.begin(), outline.end());
      if (side > 0) shape_.corners.push_back(last);
      shape_.face_starts.push_back(std::uint32_t(shape_.corners.size()));
      shape_.area += area_of(shape_.face_count() - 1);
    }
  }

  // A kite of that area.
  void add_kite(double area) {
    for (Vec2d p : {Vec2d{0, 0}, Vec2d{area, 0.5}, Vec2d{0, 1}, Vec2d{-area, 0.5}})
      shape_.corners.push_back(add_vertex(p, 0));
    shape_.face_starts.push_back(4);
    shape_.area += area_of(0);
  }

  LeafShape take() {
    for (std::uint32_t v : shape_.corners) shape_.corner_uv.push_back(shape_.uv[v]);
    return std::move(shape_);
  }

 private:
  static double length(Vec2d v) { return std::hypot(v.x, v.y); }
  double area_of(std::uint32_t f) const {
    double sum = 0;
    const auto face = shape_.face(f);
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Vec3d a = shape_.vertices[face[i]], b = shape_.vertices[face[(i + 1) % face.size()]];
      sum += 0.5 * (a.x * b.y - a.y * b.x);
    }
    return sum;
  }
  std::uint32_t add_vertex(Vec2d p, double height) {
    shape_.vertices.push_back({p.x, p.y, height});
    shape_.uv.push_back({unit_quantum.round(0.5 + p.x), unit_quantum.round(p.y)});
    shape_.reach = std::max(shape_.reach, meristem::length(shape_.vertices.back()));
    return std::uint32_t(shape_.vertices.size()) - 1;
  }

  LeafShape shape_{{}, {}, {0}, {}, {}, 0, 0};
};

LeafShape one_blade(const Half& half, double fold) {
  ShapeMaker m;
  m.add_lobe({0, 0}, {0, 1}, half, fold);
  return m.take();
}

// Lobes that fan out of one point of the stalk, by their angles to the middle one and their lengths.
LeafShape palmate(double stalk, std::initializer_list<Vec2d> lobes, const Half& half) {
  ShapeMaker m;
  for (Vec2d lobe : lobes) {
    const double angle = lobe.x * (pi / 180);
    const Vec2d foot{0, stalk};
    m.add_lobe(foot, foot + Vec2d{std::sin(angle), std::cos(angle)} * lobe.y, half, 0.25);
  }
  return m.take();
}

// A middle lobe, and one on each side.
LeafShape oak() {
  ShapeMaker m;
  m.add_lobe({0, 0}, {0, 1}, {{0.17, 0.4}, {0.16, 0.85}}, 0.2);
  for (const double side : {1.0, -1.0}) m.add_lobe({0, 0.25}, {0.42 * side, 0.68}, {{0.24, 0.45}, {0.17, 0.85}}, 0.2);
  return m.take();
}

}  // namespace

const std::vector<std::string>& leaf_shape_names() {
  static const std::vector<std::string> names{"oval",          "triangle",       "oak_3_lobes", "maple_3_lobes",
                                              "maple_5_lobes", "three_leaflets", "needle"};
  return names;
}

const LeafShape& leaf_shape(int index) {
  static const LeafShape shapes[] = {
      one_blade({{0.46, 0.32}, {0.34, 0.76}}, 0.25),
      one_blade({{0.5, 0.12}}, 0.2),
      oak(),
      palmate(0.12, {{0, 0.88}, {60, 0.62}, {-60, 0.62}}, {{0.24, 0.45}, {0.13, 0.8}}),
      palmate(0.15, {{0, 0.85}, {45, 0.7}, {-45, 0.7}, {105, 0.42}, {-105, 0.42}}, {{0.22, 0.45}, {0.12, 0.8}}),
      palmate(0.3, {{0, 0.7}, {70, 0.55}, {-70, 0.55}}, {{0.26, 0.35}, {0.2, 0.75}}),
      one_blade({{0.5, 0.5}}, 0.3),
  };
  return shapes[index];
}

const LeafShape& simple_leaf_shape(int index) {
  static const std::vector<LeafShape> shapes = [] {
    std::vector<LeafShape> kites;
    for (std::size_t i = 0; i < leaf_shape_names().size(); ++i) {
      ShapeMaker m;
      m.add_kite(leaf_shape(int(i)).area);
      kites.push_back(m.take());
    }
    return kites;
  }();
  return shapes[std::size_t(index)];
}

}  // namespace meristem
