#include "geometry/base/transform.h"

#include "geometry/base/key.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

double random(Key key, const char* purpose) { return 2 * uniform_double(hash_keys(key, hash_text(purpose))) - 1; }
Vec3d random_vector(Key key, Key which) {
  return {random(hash_keys(key, which), "x"), random(hash_keys(key, which), "y"), random(hash_keys(key, which), "z")};
}
Affine3d random_map(Key key) {
  return {random_vector(key, 1), random_vector(key, 2), random_vector(key, 3), random_vector(key, 4)};
}

void expect_near(Vec3d a, Vec3d b, double tolerance = 1e-12) {
  EXPECT_LE(length(a - b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(Affine, IdentityChangesNothing) {
  EXPECT_TRUE(Affine3d{}.is_identity());
  EXPECT_EQ(Affine3d{}.point({1, 2, 3}), Vec3d(1, 2, 3));
  EXPECT_FALSE(Affine3d::translation({0, 0, 1}).is_identity());
}

TEST(Affine, VectorsDoNotMoveWithTheOrigin) {
  const Affine3d m = Affine3d::translation({1, 2, 3});
  EXPECT_EQ(m.vector({5, 0, 0}), Vec3d(5, 0, 0));
  EXPECT_EQ(m.point({5, 0, 0}), Vec3d(6, 2, 3));
}

TEST(Affine, RotationIsRightHanded) {
  const Vec3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  expect_near(Affine3d::rotation(z, pi / 2).vector(x), y);
  expect_near(Affine3d::rotation(x, pi / 2).vector(y), z);
  expect_near(Affine3d::rotation(y, pi / 2).vector(z), x);
}

TEST(Affine, RotationKeepsItsAxisAndLengths) {
  for (Key k = 0; k < 100; ++k) {
    const Vec3d axis = normalize(random_vector(k, 1)), v = random_vector(k, 2);
    const Affine3d turn = Affine3d::rotation(axis, 3 * random(k, "angle"));
    expect_near(turn.vector(axis), axis);
    EXPECT_NEAR(length(turn.vector(v)), length(v), 1e-12);
    EXPECT_NEAR(turn.determinant(), 1, 1e-12);
  }
}

TEST(Affine, ProductAppliesTheRightOneFirst) {
  for (Key k = 0; k < 100; ++k) {
    const Affine3d a = random_map(k), b = random_map(k + 1000);
    const Vec3d p = random_vector(k, 5);
    expect_near((a * b).point(p), a.point(b.point(p)));
    EXPECT_NEAR((a * b).determinant(), a.determinant() * b.determinant(), 1e-12);
  }
}

TEST(Affine, InverseUndoes) {
  for (Key k = 0; k < 100; ++k) {
    const Affine3d m = random_map(k);
    if (std::abs(m.determinant()) < 0.01) continue;
    const Vec3d p = random_vector(k, 5);
    expect_near(m.inverse().point(m.point(p)), p, 1e-10);
    expect_near(m.point(m.inverse().point(p)), p, 1e-10);
  }
}

TEST(Affine, NormalsStayNormalToTheirPlane) {
  for (Key k = 0; k < 100; ++k) {
    const Affine3d m = random_map(k);
    if (std::abs(m.determinant()) < 0.01) continue;
    const Vec3d s = random_vector(k, 5), t = random_vector(k, 6), n = cross(s, t);
    const Vec3d moved = m.inverse().transposed_vector(n);
    EXPECT_NEAR(dot(moved, m.vector(s)), 0, 1e-10);
    EXPECT_NEAR(dot(moved, m.vector(t)), 0, 1e-10);
  }
}

TEST(Affine, BoundsContainTheImageTightly) {
  const Bounds3d box{{-1, 0, 2}, {1, 3, 2.5}};
  for (Key k = 0; k < 50; ++k) {
    const Affine3d m = random_map(k);
    const Bounds3d image = m.bounds(box).inflated(Vec3d(1e-12));
    for (Key i = 0; i < 200; ++i) {
      const Vec3d r = (random_vector(k, 100 + i) + Vec3d(1.0)) * 0.5;
      EXPECT_TRUE(image.contains(m.point(box.lower + box.size() * r)));
    }
  }
  EXPECT_EQ(Affine3d::scaling({2, 1, -1}).bounds(box).lower, Vec3d(-2, 0, -2.5));
}

TEST(Affine, BasisIsOrthonormalAndRightHanded) {
  for (Key k = 0; k < 100; ++k) {
    const Vec3d n = k == 0 ? Vec3d(0, 0, -1) : normalize(random_vector(k, 1));
    Vec3d s, t;
    orthonormal_basis(n, s, t);
    EXPECT_NEAR(length(s), 1, 1e-12);
    EXPECT_NEAR(dot(s, n), 0, 1e-12);
    expect_near(cross(s, t), n);
  }
}

}  // namespace
}  // namespace meristem
