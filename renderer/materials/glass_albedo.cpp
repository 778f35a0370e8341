#include "renderer/materials/glass_albedo.h"

#include "renderer/materials/albedo_grid.h"
#include "renderer/materials/lazy_rows.h"
#include "renderer/materials/visible_ring.h"

#include <array>

namespace meristem::ggx {

namespace {

constexpr int fresnels = 96, alphas = 64, cosines = 64;

// Calls visit(CrowdedNode) for the nodes of all parts that are not empty, each cut into so many.
template <class Visit>
void visit_parts(const std::array<float, 6>& ends, int cuts, const Visit& visit) {
  for (std::size_t i = 1; i < ends.size(); ++i) {
    if (!(ends[i - 1] < ends[i])) continue;
    for (int cut = 0; cut < cuts; ++cut)
      for (int k = 0; k < rule_size; ++k)
        visit(CrowdedNode(k, mix(ends[i - 1], ends[i], float(cut) / float(cuts)),
                          mix(ends[i - 1], ends[i], float(cut + 1) / float(cuts))));
  }
}

// The t of rings at which turns of another kind begin or end: there the mirrored direction is horizontal, or the
// reflection just total, in the plane of wo.
std::array<float, 6> ring_edges(Vec3f wo, float alpha, float eta) {
  auto through = [&](Vec3f normal) { return VisibleRing::through(wo, alpha, normal); };
  const float c = std::sqrt(std::max(0.f, 1 - eta * eta)), s = std::min(1.f, eta);  // of the critical angle
  std::array<float, 6> edges{0,
                             through({wo.x + 1, 0, wo.z}),
                             through({wo.x - 1, 0, wo.z}),
                             through({wo.x * c + wo.z * s, 0, wo.z * c - wo.x * s}),
                             through({wo.x * c - wo.z * s, 0, wo.z * c + wo.x * s}),
                             1};
  std::ranges::sort(edges);
  return edges;
}

// The mean of F G2 / G1 of what is mirrored and (1 - F) G2 / G1 of what is refracted, over visible normals.
float integrate(float c, float alpha, float eta) {
  const Vec3f wo{std::sqrt(1 - c * c), 0, c};
  const float lambda_o = lambda(wo, alpha);
  auto unmasked = [&](Vec3f w) { return (1 + lambda_o) / (1 + lambda_o + lambda(w, alpha)); };
  auto kept = [&](Vec3f h) {
    const float cosine = dot(wo, h), f = fresnel_dielectric(cosine, eta);
    const Vec3f mirrored = h * (2 * cosine) - wo, refracted = refract(wo, h, eta);
    return (mirrored.z > 0 ? f * unmasked(mirrored) : 0) + (refracted.z < 0 ? (1 - f) * unmasked(refracted) : 0);
  };
  auto of_ring = [&](const VisibleRing& ring) {
    const auto mirrored = ring.mirrored_above(), critical = ring.critical(eta);
    std::array<float, 6> ends{0, mirrored[0], mirrored[1], critical[0], critical[1], pi_f};
    std::ranges::sort(ends);
    float sum = 0;
    visit_parts(ends, 1, [&](CrowdedNode turn) { sum += turn.weight / pi_f * kept(ring.normal(turn.at)); });
    return sum;
  };
  float sum = 0;
  // From inside total reflection may begin between two turns as well, at an edge that is not sought
  visit_parts(ring_edges(wo, alpha, eta), eta < 1 ? 2 : 1, [&](CrowdedNode t) {
    sum += t.weight * 2 * t.at * of_ring({wo, alpha, t.at});
  });
  return sum;
}

using Row = std::array<float, cosines>;  // of one side, f0 and alpha

std::size_t row_index(bool inside, int f, int a) { return std::size_t((inside * fresnels + f) * alphas + a); }

Row make_row(std::size_t i) {
  const bool inside = i >= row_index(true, 0, 0);
  // Nothing is refracted by an index of 1: the first layer stands for the limit
  const float f0 = std::max(f0_at(int(i) / alphas % fresnels, fresnels), 1e-8f), eta = eta_of(f0);
  Row row{};
  for (int c = 0; c < cosines; ++c) {
    const float root = std::max(float(c) / (cosines - 1), 0.01f);
    row[std::size_t(c)] = integrate(root * root, alpha_at(int(i) % alphas, alphas), inside ? 1 / eta : eta);
  }
  return row;
}

}  // namespace

float glass_albedo(float c, float alpha, float eta) {
  static const LazyRows<Row, 2 * fresnels * alphas> rows;
  const bool inside = eta < 1;
  const Place f = place_of_f0(f0_of(eta), fresnels), a = place_of_alpha(alpha, alphas), p = place_of_cosine(c, cosines);
  auto row = [&](int f_index, int a_index) {
    const float* v = rows.at(row_index(inside, f_index, a_index), make_row).data() + p.index;
    return mix(v[0], v[1], p.fraction);
  };
  auto layer = [&](int i) { return mix(row(i, a.index), row(i, a.index + 1), a.fraction); };
  return mix(layer(f.index), layer(f.index + 1), f.fraction);
}

}  // namespace meristem::ggx
