// VisibleRing: of the normals of microfacets that a direction sees, those of one ring: for integrals over them that are
// cut where the integrand has its edges.
//
// It is sample_visible_normal() (ggx.h) with t = sqrt(1 - random.y), in [0, 1], and a turn in [0, pi] for random.x; the
// other half of a ring is its mirror image. Visible normals have the density 2 t dt by t and an even one by the turn.
// A normal that is not yet of unit length, h, and its product with wo have the length and the size
// "h . h = m + n x", "wo . h = p + q x", linear or nearly so in the cosine x of the turn: edges are roots.
#pragma once

#include "renderer/materials/ggx.h"
#include "renderer/scene/warps.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace meristem::ggx {

class VisibleRing {
 public:
  using Turns = std::array<float, 2>;

  // wo lies in the plane of x and z.
  VisibleRing(Vec3f wo, float alpha, float t) : alpha_(alpha), cosine_(wo.z) {
    const Vec3f v = normalize(Vec3f{alpha * wo.x, 0, wo.z});
    const float z = t * t * (1 + v.z) - v.z;
    sine_ = std::sqrt(std::max(0.f, 1 - z * z));
    x_ = v.x;
    z_ = z + v.z;
    p_ = alpha * wo.x * x_ + wo.z * z_;
    q_ = alpha * wo.x * sine_;
    m_ = alpha * alpha * (sine_ * sine_ + x_ * x_) + z_ * z_;
    n_ = 2 * alpha * alpha * sine_ * x_;
  }
  // The t of the ring that a normal in the plane of wo lies on, of any length; 0 if none does.
  static float through(Vec3f wo, float alpha, Vec3f normal) {
    const Vec3f v = normalize(Vec3f{alpha * wo.x, 0, wo.z}), u = normalize(Vec3f{normal.x / alpha, 0, normal.z});
    return std::sqrt(std::clamp(2 * dot(u, v) * u.z / (1 + v.z), 0.f, 1.f));
  }

  Vec3f normal(float turn) const {
    return normalize(Vec3f{alpha_ * (sine_ * std::cos(turn) + x_), alpha_ * sine_ * std::sin(turn), z_});
  }

  // From where to where mirror directions lie above the horizon: "2 (wo . h) h.z > wo.z (h . h)".
  Turns mirrored_above() const {
    const float slope = 2 * q_ * z_ - cosine_ * n_, least = cosine_ * m_ - 2 * p_ * z_;  // slope * x > least
    if (std::abs(slope) <= 1e-12f) return least >= 0 ? Turns{0, 0} : Turns{0, pi_f};
    const float edge = std::acos(std::clamp(least / slope, -1.f, 1.f));
    return slope > 0 ? Turns{0, edge} : Turns{edge, pi_f};
  }
  // Where total reflection by the relative index eta begins or ends, "(wo . h)^2 = (1 - eta^2) (h . h)"; 0 if nowhere.
  Turns critical(float eta) const {
    const float cosine2 = 1 - eta * eta;
    if (cosine2 <= 0) return {};
    const float a = q_ * q_, b = p_ * q_ - cosine2 * n_ / 2, c = p_ * p_ - cosine2 * m_, root2 = b * b - a * c;
    if (!(root2 > 0)) return {};
    auto turn = [](float x) { return std::abs(x) < 1 ? std::acos(x) : 0; };
    return {turn((-b - std::sqrt(root2)) / a), turn((-b + std::sqrt(root2)) / a)};
  }

 private:
  float alpha_, cosine_;  // of wo
  float sine_, x_, z_;    // h = (alpha (sine cos(turn) + x), alpha sine sin(turn), z)
  float p_, q_, m_, n_;
};

}  // namespace meristem::ggx
