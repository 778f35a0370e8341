#include "renderer/materials/fuzz.h"

#include "renderer/materials/lazy_rows.h"
#include "renderer/scene/warps.h"

#include <algorithm>
#include <array>

namespace meristem::fuzz {

namespace {
constexpr std::size_t cosines = 96, roughnesses = 24;
}  // namespace

struct FiberRow {  // albedos of one roughness, not yet scaled
  std::array<float, cosines> albedos;
  hemisphere_rule::Values at_rule;
};

namespace {

float mix(float a, float b, float t) { return a + (b - a) * t; }

// Not yet scaled to an albedo of at most 1.
float raw_reflectance(Vec3f wo, Vec3f wi, float exponent) {
  const Vec3f h = normalize(wo + wi);
  const float sine = std::sqrt(std::max(0.f, 1 - h.z * h.z));
  const float distribution = (2 + exponent) * std::pow(sine, exponent) / (2 * pi_f);
  return distribution / (4 * (wo.z + wi.z - wo.z * wi.z));
}

// Over the root of the exponent, which is 1 / roughness, and the root of the cosine: in these albedos are nearly
// linear.
class FiberTable {
 public:
  static const FiberTable& get() {
    static const FiberTable table;
    return table;
  }

  const FiberRow& row(std::size_t k) const { return rows_.at(k, make_row); }
  // Where between the rows.
  static float place(float exponent) {
    return (std::sqrt(exponent) - 1) / (largest_root() - 1) * float(roughnesses - 1);
  }

 private:
  static float largest_root() {
    static const float root = std::sqrt(1 / min_roughness);
    return root;
  }

  static FiberRow make_row(std::size_t k) {
    const float root = mix(1, largest_root(), float(k) / (roughnesses - 1));
    FiberRow row{};
    for (std::size_t i = 0; i < cosines; ++i) {
      const float c = float(i) / (cosines - 1);
      row.albedos[i] = integral(std::max(c * c, 1e-5f), root * root);
    }
    row.at_rule = hemisphere_rule::of_table(row.albedos);
    return row;
  }

  // By the midpoint rule over the hemisphere, finer towards its rim, where the fibres shine.
  static float integral(float c, float exponent) {
    constexpr int rings = 48, turns = 24;
    const Vec3f wo{std::sqrt(1 - c * c), 0, c};
    double sum = 0;
    for (int i = 0; i < rings; ++i) {
      const float root = (float(i) + 0.5f) / rings, z = root * root, sine = std::sqrt(1 - z * z);
      for (int k = 0; k < turns; ++k) {
        const float turn = pi_f * (float(k) + 0.5f) / turns;
        sum += double(raw_reflectance(wo, {sine * std::cos(turn), sine * std::sin(turn), z}, exponent) * z * 2 * root);
      }
    }
    return float(sum * 2 * pi / (rings * turns));
  }

  LazyRows<FiberRow, roughnesses> rows_;
};

}  // namespace

// The visibility term lets grazing light through twice: what would come to more than 1 there is scaled down, for all
// directions alike.
Fibers::Fibers(float roughness) : exponent_(1 / std::clamp(roughness, min_roughness, 1.f)) {
  const FiberTable& table = FiberTable::get();
  const float place = table.place(exponent_);
  const auto k = std::min(std::size_t(place), roughnesses - 2);
  smoother_ = &table.row(k), rougher_ = &table.row(k + 1);
  by_roughness_ = place - float(k);
  scale_ = 1 / std::max(1.f, mix(smoother_->albedos[0], rougher_->albedos[0], by_roughness_));
}

float Fibers::reflectance(Vec3f wo, Vec3f wi) const {
  if (!(wo.z > 0 && wi.z > 0)) return 0;
  return raw_reflectance(wo, wi, exponent_) * scale_;
}

float Fibers::albedo(float c) const {
  const float x = std::sqrt(std::clamp(c, 0.f, 1.f)) * (cosines - 1);
  const auto i = std::min(std::size_t(x), cosines - 2);
  const float t = x - float(i);
  const auto &a = smoother_->albedos, &b = rougher_->albedos;
  return mix(mix(a[i], a[i + 1], t), mix(b[i], b[i + 1], t), by_roughness_) * scale_;
}

hemisphere_rule::Values Fibers::albedo_at_rule() const {
  hemisphere_rule::Values values;
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = mix(smoother_->at_rule[i], rougher_->at_rule[i], by_roughness_) * scale_;
  return values;
}

}  // namespace meristem::fuzz
