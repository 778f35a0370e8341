#include "renderer/materials/fuzz.h"

#include "renderer/materials/lazy_rows.h"
#include "renderer/scene/warps.h"

#include <algorithm>
#include <array>

namespace meristem::fuzz {
namespace {

// Not yet scaled to an albedo of at most 1.
float raw_reflectance(Vec3f wo, Vec3f wi, float roughness) {
  const Vec3f h = normalize(wo + wi);
  const float sine = std::sqrt(std::max(0.f, 1 - h.z * h.z)), exponent = 1 / roughness;
  const float distribution = (2 + exponent) * std::pow(sine, exponent) / (2 * pi_f);
  return distribution / (4 * (wo.z + wi.z - wo.z * wi.z));
}

// Over roughness and the root of the cosine, interpolated linearly.
class AlbedoTable {
 public:
  static const AlbedoTable& get() {
    static const AlbedoTable table;
    return table;
  }

  float at(float c, float roughness) const {
    const float x = std::clamp(std::sqrt(c), 0.f, 1.f) * (cosines - 1);
    const float y = std::clamp((roughness - min_roughness) / (1 - min_roughness), 0.f, 1.f) * (roughnesses - 1);
    const auto i = std::min(std::size_t(x), cosines - 2), k = std::min(std::size_t(y), roughnesses - 2);
    const float tx = x - float(i), ty = y - float(k);
    auto row = [&](std::size_t r) {
      const Row& values = rows_.at(r, make_row);
      return values[i] * (1 - tx) + values[i + 1] * tx;
    };
    return row(k) * (1 - ty) + row(k + 1) * ty;
  }

 private:
  static constexpr std::size_t cosines = 32, roughnesses = 20;

  using Row = std::array<float, cosines>;

  static Row make_row(std::size_t k) {
    const float roughness = min_roughness + (1 - min_roughness) * float(k) / (roughnesses - 1);
    Row row{};
    for (std::size_t i = 0; i < cosines; ++i) {
      const float root = float(i) / (cosines - 1);
      row[i] = integral(std::max(root * root, 1e-4f), roughness);
    }
    return row;
  }

  // By the midpoint rule over the hemisphere, finer towards its rim, where the fibres shine.
  static float integral(float c, float roughness) {
    constexpr int rings = 48, turns = 24;
    const Vec3f wo{std::sqrt(1 - c * c), 0, c};
    double sum = 0;
    for (int i = 0; i < rings; ++i) {
      const float root = (float(i) + 0.5f) / rings, z = root * root, sine = std::sqrt(1 - z * z);
      for (int k = 0; k < turns; ++k) {
        const float turn = pi_f * (float(k) + 0.5f) / turns;
        sum += double(raw_reflectance(wo, {sine * std::cos(turn), sine * std::sin(turn), z}, roughness) * z * 2 * root);
      }
    }
    return float(sum * 2 * pi / (rings * turns));
  }

  LazyRows<Row, roughnesses> rows_;
};

}  // namespace

// The visibility term lets grazing light through twice: what would come to more than 1 is scaled down, both ways alike.
float reflectance(Vec3f wo, Vec3f wi, float roughness) {
  if (!(wo.z > 0 && wi.z > 0)) return 0;
  const AlbedoTable& table = AlbedoTable::get();
  const float largest = std::max({1.f, table.at(wo.z, roughness), table.at(wi.z, roughness)});
  return raw_reflectance(wo, wi, roughness) / largest;
}

float albedo(float c, float roughness) { return std::min(1.f, AlbedoTable::get().at(c, roughness)); }

}  // namespace meristem::fuzz
