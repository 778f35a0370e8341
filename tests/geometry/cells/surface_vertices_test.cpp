#include "geometry/cells/surface_vertices.h"

#include "geometry/base/key.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

using namespace meristem;

namespace {

constexpr float step = 0x1p-12f;

// On a lattice, so many steps an axis apart at most; the extremes of each axis are there.
std::vector<Vec3f> on_lattice(std::size_t count, std::uint32_t most_steps) {
  const Vec3f origin{-7 * step, 1000 * step, -3};
  std::vector<Vec3f> positions{origin, origin + Vec3f(float(most_steps) * step)};
  for (Key k = 2; k < count; ++k) {
    const auto number = [&](Key axis) { return float(hash_keys(k, axis) % (most_steps + 1)); };
    positions.push_back(origin + Vec3f{number(0), number(1), number(2)} * step);
  }
  return positions;
}

std::vector<PackedAttributes> attributes(std::size_t count) {
  std::vector<PackedAttributes> all(count);
  for (std::size_t v = 0; v < count; ++v)
    all[v] = {{std::int16_t(v), std::int16_t(-int(v))}, {std::uint16_t(3 * v), std::uint16_t(5 * v)}};
  return all;
}

SurfaceVertices vertices_of(const std::vector<Vec3f>& positions, bool has_uv = true) {
  return {positions, attributes(positions.size()), has_uv};
}

void expect_same_bits(const SurfaceVertices& vertices, const std::vector<Vec3f>& positions) {
  ASSERT_EQ(vertices.size(), positions.size());
  using Bits = std::array<std::uint32_t, 3>;
  for (std::size_t v = 0; v < positions.size(); ++v)
    ASSERT_EQ(std::bit_cast<Bits>(vertices.positions()[v]), std::bit_cast<Bits>(positions[v])) << v;
}

}  // namespace

TEST(SurfaceVertices, TakeSixBytesAPositionOnALattice) {
  for (const std::uint32_t most : {1u, 1000u, 65535u}) {
    const std::vector<Vec3f> positions = on_lattice(500, most);
    const SurfaceVertices vertices = vertices_of(positions);
    EXPECT_TRUE(vertices.positions().is_packed()) << most;
    expect_same_bits(vertices, positions);
    EXPECT_EQ(vertices.bytes(), 500u * (6 + 8) + 2);
    EXPECT_EQ(vertices.bounds().lower, positions[0]);
    EXPECT_EQ(vertices.bounds().upper, positions[1]);
  }
}

TEST(SurfaceVertices, StayFloatsWherePackingWouldLoseSomething) {
  const auto expect_floats = [](const std::vector<Vec3f>& positions, const char* why) {
    const SurfaceVertices vertices = vertices_of(positions);
    EXPECT_FALSE(vertices.positions().is_packed()) << why;
    expect_same_bits(vertices, positions);
    EXPECT_EQ(vertices.bytes(), positions.size() * (12 + 8) + 12);
  };
  expect_floats(on_lattice(500, 65536), "a step too many");
  std::vector<Vec3f> off = on_lattice(500, 65535);
  off[250].y += 0.5f * step;
  expect_floats(off, "one between two planes");
  std::vector<Vec3f> negative_zero = on_lattice(500, 65535);
  negative_zero[250].x = -0.f;
  expect_floats(negative_zero, "the sign of zero");
  std::vector<Vec3f> not_finite = on_lattice(500, 65535);
  for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    not_finite[250].z = bad;
    expect_floats(not_finite, "not finite");
  }
  expect_floats({{1e30f, 0, 0}, {-1e30f, 0, 0}}, "very large");
  expect_floats({{0, 0, 0}, {std::numeric_limits<float>::denorm_min(), 0, 0}}, "very small");
}

TEST(SurfaceVertices, OneAloneAndNone) {
  expect_same_bits(vertices_of({{0.1f, -0.2f, 0.3f}}), {{0.1f, -0.2f, 0.3f}});
  EXPECT_EQ(vertices_of({}).size(), 0u);
  EXPECT_TRUE(vertices_of({}).bounds().empty());
}

TEST(SurfaceVertices, KeepUvOnlyIfItIsWanted) {
  const std::vector<Vec3f> positions = on_lattice(100, 500);
  const SurfaceVertices with = vertices_of(positions), without = vertices_of(positions, false);
  EXPECT_TRUE(with.has_uv());
  EXPECT_FALSE(without.has_uv());
  EXPECT_EQ(with.bytes() - without.bytes(), 400u);
  const std::vector<PackedAttributes> all = attributes(100);
  for (std::uint32_t v = 0; v < 100; ++v) {
    const PackedAttributes& expected = all[v];
    EXPECT_EQ(*with.attributes(v), std::bit_cast<std::uint32_t>(expected.normal));
    EXPECT_EQ(*without.attributes(v), std::bit_cast<std::uint32_t>(expected.normal));
    EXPECT_EQ(with.attributes(v)[1], std::bit_cast<std::uint32_t>(expected.uv));
  }
}
