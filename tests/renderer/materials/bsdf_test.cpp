// Physics of the Bsdf: energy, reciprocity, densities; and that no input makes it other than finite.
#include "renderer/materials/bsdf.h"

#include "renderer/materials/ggx.h"
#include "renderer/materials/ggx_albedo.h"
#include "renderer/materials/glass_albedo.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

Vec2f spread_pair(int i) {
  const double x = 0.5 + 0.7548776662466927 * i, y = 0.5 + 0.5698402909980532 * i;
  return {float(x - std::floor(x)) * 0.999999f, float(y - std::floor(y)) * 0.999999f};
}
float random_number(int i, int what) { return uniform_float(hash_keys(Key(i), Key(what))); }

Vec3f from_up(float cosine, float turn = 0.4f) {
  const float s = std::sqrt(1 - cosine * cosine);
  return {s * std::cos(turn), cosine, s * std::sin(turn)};
}

// For light that leaves towards wo from a surface whose normals are as given.
Bsdf framed(const BsdfParameters& parameters, Vec3f wo, Vec3f shading = {0, 1, 0}) {
  ShadingPoint point;
  point.hit.geometric_normal = {0, 1, 0};
  point.hit.shading_normal = shading;
  point.wo = wo;
  return {parameters, point};
}

struct Case {
  const char* name;
  BsdfParameters bsdf;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

BsdfParameters plastic(float alpha, float f0 = 0.04f) {
  BsdfParameters b;
  b.diffuse = Spectrum(1.f);
  b.alpha = alpha;
  b.f0 = f0;
  return b;
}
BsdfParameters metal(float alpha, Spectrum f0, Spectrum f82 = Spectrum(1.f)) {
  BsdfParameters b;
  b.metalness = 1;
  b.alpha = alpha;
  b.metal_f0 = f0;
  b.metal_f82 = f82;
  return b;
}
BsdfParameters leaf() {
  BsdfParameters b;
  b.diffuse = {0.1f, 0.2f, 0.05f};
  b.transmitted = {0.2f, 0.5f, 0.1f};
  b.alpha = 0.25f;
  return b;
}
BsdfParameters lambert(float roughness) {
  BsdfParameters b;
  b.diffuse = Spectrum(1.f);
  b.f0 = 0;
  b.diffuse_roughness = roughness;
  return b;
}
BsdfParameters coated(BsdfParameters b, float weight = 1, float alpha = 0.01f) {
  b.coat = weight;
  b.coat_alpha = alpha;
  return b;
}
BsdfParameters fuzzy(BsdfParameters b, float roughness, float weight = 1) {
  b.fuzz = weight;
  b.fuzz_roughness = roughness;
  return b;
}
BsdfParameters glass(float alpha, float f0 = 0.04f, bool thin_walled = false) {
  BsdfParameters b;
  b.glass = 1;
  b.alpha = alpha;
  b.f0 = f0;
  b.thin_walled = thin_walled;
  return b;
}
BsdfParameters everything() {
  BsdfParameters b = coated(fuzzy(leaf(), 0.3f, 0.5f), 0.7f, 0.2f);
  b.coat_tint = {0.9f, 0.5f, 0.2f};
  b.metalness = 0.2f;
  b.metal_f0 = {0.9f, 0.7f, 0.4f};
  b.glass = 0.5f;
  b.thin_walled = true;
  return b;
}
BsdfParameters mixture() {
  BsdfParameters b = metal(0.2f, {0.9f, 0.6f, 0.3f}, {0.8f, 0.9f, 1});
  b.metalness = 0.4f;
  b.diffuse = {0.6f, 0.5f, 0.1f};
  b.diffuse_roughness = 0.7f;
  b.dielectric_tint = {1, 0.5f, 0.8f};
  return b;
}

class AnyBsdf : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    , AnyBsdf,
    testing::Values(Case{"lambert", lambert(0)}, Case{"rough_diffuse", lambert(1)}, Case{"plastic", plastic(0.09f)},
                    Case{"dull_plastic", plastic(0.8f)}, Case{"dense_glass", plastic(0.3f, 0.3f)},
                    Case{"gold", metal(0.2f, {1, 0.8f, 0.4f})}, Case{"dull_white_metal", metal(1, Spectrum(1.f))},
                    Case{"tinted_metal", metal(0.4f, {0.6f, 0.5f, 0.5f}, {0.3f, 0.6f, 1})}, Case{"leaf", leaf()},
                    Case{"mixture", mixture()}, Case{"lacquer", coated(plastic(0.5f))},
                    Case{"coated_metal", coated(metal(0.3f, {1, 0.8f, 0.4f}), 0.6f, 0.1f)},
                    Case{"velvet", fuzzy(plastic(0.5f), 0.3f)}, Case{"dusty", fuzzy(lambert(0.5f), 0.8f, 0.4f)},
                    Case{"glass", glass(0.1f)}, Case{"frosted_glass", glass(0.4f, 0.1f)},
                    Case{"thin_glass", glass(0.2f, 0.04f, true)}, Case{"everything", everything()}),
    [](const auto& test) { return test.param.name; });

constexpr float cosines[] = {0.02f, 0.2f, 0.5f, 0.8f, 1};

// The albedo by importance sampling: to some 0.0005, since each lobe gets a run of the spread pairs.
Spectrum albedo(const Bsdf& bsdf, Vec3f wo, int count = 20000) {
  Vec3d sum;
  for (int i = 0; i < count; ++i) {
    const BsdfSample s = bsdf.sample(wo, spread_pair(i), (float(i) + 0.5f) / float(count));
    if (s.pdf > 0) sum += Vec3d(s.weight);
  }
  return Spectrum(sum / double(count));
}

TEST_P(AnyBsdf, GivesBackNoMoreLightThanItGets) {
  for (float c : cosines) {
    const Vec3f wo = from_up(c);
    EXPECT_LE(max_component(albedo(framed(GetParam().bsdf, wo), wo)), 1.015f) << "cosine " << c;
  }
}

TEST_P(AnyBsdf, IsReciprocal) {
  const BsdfParameters& b = GetParam().bsdf;
  if (b.glass > 0 || ((b.coat > 0 || b.fuzz > 0) && b.f0 > 0)) return;  // below
  for (int i = 0; i < 200; ++i) {
    const Vec3f wo = from_up(0.01f + 0.99f * random_number(i, 0), 6 * random_number(i, 1));
    Vec3f wi = from_up(0.01f + 0.99f * random_number(i, 2), 6 * random_number(i, 3));
    if (i % 2) wi.y = -wi.y;
    const Spectrum there = framed(b, wo).evaluate(wo, wi) / std::abs(wi.y);
    const Spectrum back = framed(b, wi).evaluate(wi, wo) / std::abs(wo.y);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(there[k], back[k], 2e-4f * (1e-3f + there[k]));
  }
}

// Radiance grows by the square of the index inside glass; and what scatters between microfacets is given back by wo.
TEST(Bsdf, GlassIsReciprocalButForTheGain) {
  for (const BsdfParameters& b : {glass(0.1f), glass(0.4f, 0.1f), glass(0.2f, 0.04f, true)})
    for (int i = 0; i < 400; ++i) {
      const Vec3f wo = from_up(0.05f + 0.95f * random_number(i, 0), 6 * random_number(i, 1));
      Vec3f wi = from_up(0.05f + 0.95f * random_number(i, 2), 6 * random_number(i, 3));
      if (i % 2) wi.y = -wi.y;
      auto reduced = [&](Vec3f from, Vec3f to) {
        const Bsdf f = framed(b, from);
        const float eta = ggx::eta_of(b.f0), c = std::abs(from.y);
        const float kept = b.thin_walled ? ggx::Albedo::white(b.alpha).at(c)
                                         : ggx::glass_albedo(c, b.alpha, f.inside() ? 1 / eta : eta);
        return f.evaluate(from, to).y / std::abs(to.y) * kept / (f.inside() ? eta * eta : 1);
      };
      EXPECT_NEAR(reduced(wo, wi), reduced(wi, wo), 1e-3f * (1e-2f + reduced(wo, wi))) << i;
    }
}

// Below a layer a specular lobe is dimmed by what the layer passes of wo.
TEST(Bsdf, LobesBelowACoatAreReciprocalButForWhatItPasses) {
  const BsdfParameters b = coated(metal(0.3f, {1, 0.8f, 0.4f}), 0.8f, 0.1f);
  BsdfParameters coat_alone = b;
  coat_alone.metal_weight = 0;
  const auto coat_albedo = ggx::Albedo::dielectric(b.coat_alpha, b.coat_f0);
  auto metal_alone = [&](Vec3f from, Vec3f to) {
    const Spectrum f = framed(b, from).evaluate(from, to) - framed(coat_alone, from).evaluate(from, to);
    return f.y / to.y / (1 - b.coat * coat_albedo.at(from.y));
  };
  for (int i = 0; i < 200; ++i) {
    const Vec3f wo = from_up(0.05f + 0.95f * random_number(i, 0), 6 * random_number(i, 1));
    const Vec3f wi = from_up(0.05f + 0.95f * random_number(i, 2), 6 * random_number(i, 3));
    EXPECT_NEAR(metal_alone(wo, wi), metal_alone(wi, wo), 1e-3f * (1e-2f + metal_alone(wo, wi))) << i;
  }
}

// pdf over the sphere and how often samples land: per cell of (cosine, turn), the integral of pdf() is the share of
// samples.
TEST_P(AnyBsdf, SamplesFollowThePdf) {
  const Vec3f wo = from_up(0.6f);
  const Bsdf bsdf = framed(GetParam().bsdf, wo);
  constexpr int rings = 16, turns = 8, fine = 24, count = 100000;
  std::vector<double> expected(rings * turns), found(rings * turns);
  double integral = 0;
  for (int r = 0; r < rings * fine; ++r)
    for (int t = 0; t < turns * fine; ++t) {
      const float c = 2 * (float(r) + 0.5f) / (rings * fine) - 1;
      const double p = double(bsdf.pdf(wo, from_up(c, 2 * pi_f * (float(t) + 0.5f) / (turns * fine))));
      const double share = p * 4 * pi / (rings * turns * fine * fine);
      expected[std::size_t(r / fine * turns + t / fine)] += share;
      integral += share;
    }
  int absorbed = 0;
  for (int i = 0; i < count; ++i) {
    const BsdfSample s = bsdf.sample(wo, {random_number(i, 0), random_number(i, 1)}, random_number(i, 2));
    if (!(s.pdf > 0)) {
      ++absorbed;
      continue;
    }
    const double turn = std::atan2(double(s.wi.z), double(s.wi.x)) / (2 * pi);
    const int r = std::min(int((double(s.wi.y) + 1) / 2 * rings), rings - 1);
    const int t = std::min(int((turn - std::floor(turn)) * turns), turns - 1);
    found[std::size_t(r * turns + t)] += 1.0 / count;
  }
  EXPECT_NEAR(integral, 1 - double(absorbed) / count, 0.01);
  double chi2 = 0;
  int cells = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (expected[i] * count < 5) {
      EXPECT_LT(found[i] * count, 30);
      continue;
    }
    // the quadrature's own error, some 0.5 %, is added to the variance
    const double variance = expected[i] / count + std::pow(0.005 * expected[i], 2);
    chi2 += std::pow(found[i] - expected[i], 2) / variance;
    ++cells;
  }
  EXPECT_LT(chi2, cells + 5 * std::sqrt(2.0 * cells));
}

TEST_P(AnyBsdf, WeightIsValueOverPdf) {
  const Vec3f wo = from_up(0.35f);
  const Bsdf bsdf = framed(GetParam().bsdf, wo);
  for (int i = 0; i < 500; ++i) {
    const BsdfSample s = bsdf.sample(wo, spread_pair(i), random_number(i, 3));
    if (!(s.pdf > 0)) continue;
    EXPECT_FLOAT_EQ(s.pdf, bsdf.pdf(wo, s.wi));
    EXPECT_LT(max_component(abs(s.weight * s.pdf - bsdf.evaluate(wo, s.wi))), 1e-4f * (1 + s.pdf));
    EXPECT_EQ(s.is_transmission, s.wi.y < 0);
  }
}

TEST_P(AnyBsdf, IsFiniteForEveryDirectionAndShadingNormal) {
  for (int i = 0; i < 5000; ++i) {
    auto direction = [&](int what) {
      const Vec3f v{random_number(i, what) - 0.5f, (random_number(i, what + 1) - 0.5f) * std::pow(10.f, -float(i % 12)),
                    random_number(i, what + 2) - 0.5f};
      return normalize(v);
    };
    const Vec3f wo = direction(0), wi = direction(3);
    Vec3f shading = normalize(direction(6) + Vec3f{0, 0.2f, 0});
    if (i % 7 == 0) shading = {};
    if (i % 7 == 1) shading = {0, -1, 0};
    const Bsdf bsdf = framed(GetParam().bsdf, wo, shading);
    const Spectrum f = bsdf.evaluate(wo, wi);
    EXPECT_TRUE(is_finite(f) && f.x >= 0 && f.y >= 0 && f.z >= 0);
    EXPECT_TRUE(std::isfinite(bsdf.pdf(wo, wi)));
    const BsdfSample s = bsdf.sample(wo, {random_number(i, 9), random_number(i, 10)}, random_number(i, 11));
    if (s.pdf > 0) {
      EXPECT_TRUE(is_finite(s.weight) && is_finite(s.wi));
      EXPECT_EQ(s.is_transmission, (s.wi.y > 0) != (wo.y >= 0));  // no light leaks through
    }
  }
}

class White : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(, White,
                         testing::Values(Case{"lambert", lambert(0)}, Case{"half_rough", lambert(0.5f)},
                                         Case{"rough", lambert(1)}, Case{"plastic", plastic(0.09f)},
                                         Case{"mirrorlike_plastic", plastic(0.002f)}, Case{"dull_plastic", plastic(1)},
                                         Case{"dense", plastic(0.3f, 0.3f)}, Case{"metal", metal(0.1f, Spectrum(1.f))},
                                         Case{"dull_metal", metal(1, Spectrum(1.f))}),
                         [](const auto& test) { return test.param.name; });

TEST_P(White, FurnaceGivesAllLightBack) {
  const int count = GetParam().bsdf.diffuse_roughness > 0 ? 400000 : 20000;  // grazing light varies most
  for (float c : cosines) {
    const Vec3f wo = from_up(c);
    EXPECT_NEAR(albedo(framed(GetParam().bsdf, wo), wo, count).y, 1, 0.001) << "cosine " << c;
  }
}

// Every layer over every other, and each of them at the ends and in the midst of its range.
TEST(Bsdf, WhiteBasesBelowAnyLayersGiveAllLightBack) {
  constexpr int count = 50000;
  auto check = [](const BsdfParameters& b) {
    for (float c : {0.02f, 0.15f, 1.f}) {
      const Vec3f wo = from_up(c);
      EXPECT_NEAR(albedo(framed(b, wo), wo, count).y, 1, 0.001)
          << "cosine " << c << ", base " << b.diffuse_roughness << ", dielectric " << b.f0 << ", coat " << b.coat
          << " of " << b.coat_alpha << ", " << b.coat_f0 << ", fuzz " << b.fuzz << " of " << b.fuzz_roughness;
    }
  };
  for (float base : {0.f, 0.5f, 1.f})
    for (float f0 : {0.f, 0.04f}) {
      BsdfParameters b = plastic(0.3f, f0);
      b.diffuse_roughness = base;
      for (float roughness : {0.05f, 0.12f, 0.5f, 1.f}) check(fuzzy(b, roughness));
      for (float alpha : {0.001f, 0.1f, 1.f}) check(coated(fuzzy(b, 0.3f, 0.5f), 0.7f, alpha));
      for (float alpha : {0.001f, 0.1f, 1.f})
        for (float ior : {1.05f, 1.6f, 4.f}) {
          BsdfParameters lacquered = coated(b, 1, alpha);
          lacquered.coat_f0 = std::min(ggx::f0_of(ior), ggx::max_f0);
          check(lacquered);
        }
    }
}

// The second lobe of a rough base is reciprocal whatever lies above; specular lobes are not (below).
TEST(Bsdf, RoughBasesBelowLayersAreReciprocal) {
  BsdfParameters b = coated(fuzzy(lambert(0.8f), 0.3f, 0.7f), 0.9f, 0.2f);
  b.diffuse = {0.9f, 0.5f, 0.1f};
  BsdfParameters layers = b;
  layers.diffuse = {};
  auto base = [&](Vec3f from, Vec3f to) {
    return (framed(b, from).evaluate(from, to) - framed(layers, from).evaluate(from, to)) / to.y;
  };
  for (int i = 0; i < 200; ++i) {
    const Vec3f wo = from_up(0.05f + 0.95f * random_number(i, 0), 6 * random_number(i, 1));
    const Vec3f wi = from_up(0.05f + 0.95f * random_number(i, 2), 6 * random_number(i, 3));
    EXPECT_LT(max_component(abs(base(wo, wi) - base(wi, wo))), 1e-3f * (1e-2f + base(wo, wi).x)) << i;
  }
}

// All that is not reflected goes through, in power; radiance by 1 / eta^2, which is taken out here.
TEST(Bsdf, GlassKeepsItsEnergy) {
  constexpr int count = 50000;
  for (float alpha : {0.002f, 0.1f, 0.4f, 1.f})
    for (float index : {1.1f, 1.5f, 2.f})
      for (bool thin : {false, true})
        for (float side : {1.f, -1.f})
          for (float c : {0.05f, 0.2f, 0.5f, 1.f}) {
            const Vec3f wo = from_up(c) * side;
            const Bsdf b = framed(glass(alpha, ggx::f0_of(index), thin), wo);
            const float eta = thin ? 1 : side > 0 ? index : 1 / index;
            double sum = 0;
            for (int i = 0; i < count; ++i) {
              const BsdfSample s = b.sample(wo, spread_pair(i), (float(i) + 0.5f) / count);
              if (s.pdf > 0) sum += double(s.weight.y * (s.is_transmission ? eta * eta : 1)) / count;
            }
            EXPECT_NEAR(sum, 1, c < 0.1f ? 0.002 : 0.0015) << alpha << " " << index << " " << thin << side << " " << c;
          }
}

// Smooth glass bends light by Snell's law and lets through what Fresnel's terms leave.
TEST(Bsdf, SmoothGlassRefractsBySnell) {
  const Vec3f wo = from_up(0.6f, 0);
  const Bsdf b = framed(glass(ggx::min_alpha), wo);
  double through = 0;
  for (int i = 0; i < 4000; ++i) {
    const BsdfSample s = b.sample(wo, spread_pair(i), random_number(i, 3));
    if (!s.is_transmission || !(s.pdf > 0)) continue;
    EXPECT_NEAR(s.wi.x, -0.8f / 1.5f, 0.1f);
    through += double(s.weight.y) * 2.25 / 4000;
  }
  EXPECT_NEAR(through, 1 - double(ggx::fresnel_dielectric(0.6f, 1.5f)), 0.01);
}

TEST(Bsdf, GlassReflectsAllBeyondTheCriticalAngle) {
  const Vec3f wo = from_up(-0.6f);  // 53 degrees from below; the critical angle is 42
  const Bsdf b = framed(glass(ggx::min_alpha), wo);
  for (int i = 0; i < 200; ++i) EXPECT_FALSE(b.sample(wo, spread_pair(i), random_number(i, 3)).is_transmission);
}

TEST(Bsdf, CoatTintsLongerPathsMore) {
  BsdfParameters b = coated(lambert(0));
  b.coat_tint = {1, 0.5f, 0.25f};
  const Vec3f up = from_up(1), flat = from_up(0.2f);
  const Spectrum straight = framed(b, up).evaluate(up, from_up(0.96f));
  EXPECT_NEAR(straight.y / straight.x, 0.5f, 0.02f);
  EXPECT_NEAR(straight.z / straight.x, 0.25f, 0.02f);
  const Spectrum slanting = framed(b, flat).evaluate(flat, from_up(0.2f, 2));
  EXPECT_LT(slanting.y / slanting.x, 0.45f);
}

TEST(Bsdf, FuzzShinesAtTheRim) {
  BsdfParameters black = fuzzy(lambert(0), 0.3f);
  black.diffuse = {};
  const Vec3f up = from_up(1), flat = from_up(0.1f);
  EXPECT_GT(albedo(framed(black, flat), flat).y, 3 * albedo(framed(black, up), up).y);
}

TEST(Bsdf, LambertIsAlbedoOverPi) {
  BsdfParameters b = lambert(0);
  b.diffuse = {0.2f, 0.4f, 0.6f};
  const Vec3f wo = from_up(0.7f), wi = from_up(0.3f, 2);
  EXPECT_LT(length(framed(b, wo).evaluate(wo, wi) - b.diffuse * (0.3f / pi_f)), 1e-6f);
}

TEST(Bsdf, BothSidesAreAlike) {
  const Vec3f wo = from_up(0.7f), wi = from_up(0.3f, 2);
  EXPECT_EQ(framed(mixture(), wo).evaluate(wo, wi).x, framed(mixture(), -wo).evaluate(-wo, -wi).x);
}

TEST(Bsdf, ShadingNormalsFadeOutAtTheGeometricHorizon) {
  const Vec3f shading = normalize(Vec3f{1, 1, 0}), wo = from_up(0.9f, 0);
  const Bsdf bsdf = framed(lambert(0), wo, shading);
  EXPECT_LT(bsdf.evaluate(wo, normalize(Vec3f{1, 0.001f, 0})).x, 0.005f);
  EXPECT_EQ(bsdf.evaluate(wo, normalize(Vec3f{1, -0.001f, 0})).x, 0);
  EXPECT_NEAR(bsdf.evaluate(wo, {0, 1, 0}).x, std::sqrt(0.5f) / pi_f, 1e-4f);
}

TEST(Ggx, DistributionIsNormalised) {
  for (float alpha : {0.05f, 0.3f, 1.f}) {
    double sum = 0;
    constexpr int steps = 100000;
    for (int i = 0; i < steps; ++i) {
      const double angle = (i + 0.5) / steps * pi / 2;
      const Vec3f h(Vec3d{std::sin(angle), 0, std::cos(angle)});
      sum += double(ggx::distribution(h, alpha)) * std::cos(angle) * std::sin(angle) * 2 * pi * (pi / 2 / steps);
    }
    EXPECT_NEAR(sum, 1, 1e-3);
  }
}

// Normal incidence ((n-1)/(n+1))^2; Brewster's angle, where only the perpendicular half is left; grazing 1.
TEST(Ggx, FresnelAtKnownAngles) {
  EXPECT_NEAR(ggx::fresnel_dielectric(1, 1.5f), 0.04f, 1e-6f);
  EXPECT_NEAR(ggx::fresnel_dielectric(0, 1.5f), 1, 1e-6f);
  const double n = 1.5, perpendicular = (n * n - 1) / (n * n + 1);
  EXPECT_NEAR(ggx::fresnel_dielectric(float(std::cos(std::atan(n))), 1.5f), 0.5 * perpendicular * perpendicular, 1e-5);
  EXPECT_NEAR(ggx::eta_of(ggx::f0_of(1.33f)), 1.33f, 1e-5f);
}

TEST(Ggx, SmoothAlbedoIsTheFresnelTerm) {
  for (float c : {0.1f, 0.3f, 0.7f, 1.f})
    EXPECT_NEAR(ggx::Albedo::dielectric(ggx::min_alpha, 0.04f).at(c), ggx::fresnel_dielectric(c, 1.5f), 0.001f);
}

}  // namespace
}  // namespace meristem
