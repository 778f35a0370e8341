#include "geometry/mesh/face_sums.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

constexpr std::size_t lanes = 32;  // faces or vertices at a time: their rows stay in the nearest cache

struct Rows3 {
  double x[lanes], y[lanes], z[lanes];
};

// The two diagonals of each quad, and what follows from them.
struct Quads {
  Rows3 a, b, normal;
  double diagonal[lanes];
};

inline __attribute__((always_inline)) void normalize_rows(Rows3& v) {
  for (std::size_t i = 0; i < lanes; ++i) {
    const double l = std::sqrt(v.x[i] * v.x[i] + v.y[i] * v.y[i] + v.z[i] * v.z[i]);
    const bool is_zero = !(l > 0);
    const double divisor = is_zero ? 1 : l;
    v.x[i] = is_zero ? 0 : v.x[i] / divisor;
    v.y[i] = is_zero ? 0 : v.y[i] / divisor;
    v.z[i] = is_zero ? 0 : v.z[i] / divisor;
  }
}

inline __attribute__((always_inline)) void finish_quads(Quads& q, double unit_magic, double magic) {
  Rows3 &a = q.a, &b = q.b, &n = q.normal;
  for (std::size_t i = 0; i < lanes; ++i) {
    n.x[i] = a.y[i] * b.z[i] - a.z[i] * b.y[i];
    n.y[i] = a.z[i] * b.x[i] - a.x[i] * b.z[i];
    n.z[i] = a.x[i] * b.y[i] - a.y[i] * b.x[i];
  }
  normalize_rows(n);
  for (std::size_t i = 0; i < lanes; ++i) {
    n.x[i] = (n.x[i] + unit_magic) - unit_magic;
    n.y[i] = (n.y[i] + unit_magic) - unit_magic;
    n.z[i] = (n.z[i] + unit_magic) - unit_magic;
    const double la = std::sqrt(a.x[i] * a.x[i] + a.y[i] * a.y[i] + a.z[i] * a.z[i]);
    const double lb = std::sqrt(b.x[i] * b.x[i] + b.y[i] * b.y[i] + b.z[i] * b.z[i]);
    q.diagonal[i] = (0.5 * (la + lb) + magic) - magic;
  }
}

struct Kernels {
  void (*finish)(Quads&, double unit_magic, double magic);
  void (*normalize)(Rows3&);
};

void finish_baseline(Quads& q, double unit_magic, double magic) { finish_quads(q, unit_magic, magic); }
void normalize_baseline(Rows3& v) { normalize_rows(v); }
__attribute__((target("avx2"))) void finish_avx2(Quads& q, double unit_magic, double magic) {
  finish_quads(q, unit_magic, magic);
}
__attribute__((target("avx2"))) void normalize_avx2(Rows3& v) { normalize_rows(v); }

const Kernels& kernels() {
  static const Kernels best = __builtin_cpu_supports("avx2") ? Kernels{finish_avx2, normalize_avx2}
                                                             : Kernels{finish_baseline, normalize_baseline};
  return best;
}

void set(Rows3& rows, std::size_t i, Vec3d v) { rows.x[i] = v.x, rows.y[i] = v.y, rows.z[i] = v.z; }
Vec3d get(const Rows3& rows, std::size_t i) { return {rows.x[i], rows.y[i], rows.z[i]}; }

}  // namespace

void add_quads(std::span<const Vec3d> positions, std::span<const std::uint32_t> corners, const Quantum& quantum,
               std::span<FaceSum> sums) {
  Quads q{};
  for (std::size_t begin = 0; begin < corners.size(); begin += 4 * lanes) {
    const std::size_t count = std::min(lanes, (corners.size() - begin) / 4);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t* c = &corners[begin + 4 * i];
      set(q.a, i, positions[c[2]] - positions[c[0]]);
      set(q.b, i, positions[c[3]] - positions[c[1]]);
    }
    kernels().finish(q, unit_quantum.magic(), quantum.magic());
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3d normal = get(q.normal, i);
      for (std::size_t k = 0; k < 4; ++k) {
        FaceSum& sum = sums[corners[begin + 4 * i + k]];
        sum.normal += normal;
        sum.diagonal += q.diagonal[i];
      }
    }
  }
}

void unit_normals(std::span<const FaceSum> sums, Vec3d* normals) {
  Rows3 rows{};
  for (std::size_t begin = 0; begin < sums.size(); begin += lanes) {
    const std::size_t count = std::min(lanes, sums.size() - begin);
    for (std::size_t i = 0; i < count; ++i) set(rows, i, sums[begin + i].normal);
    kernels().normalize(rows);
    for (std::size_t i = 0; i < count; ++i) normals[begin + i] = get(rows, i);
  }
}

}  // namespace meristem
