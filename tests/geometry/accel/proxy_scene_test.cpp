#include "geometry/accel/proxy_scene.h"

#include "geometry/base/parallel.h"

#include <gtest/gtest.h>

#include <cmath>

namespace meristem {
namespace {

void count_entered(void* count, std::uint32_t, RayContext&, RTCRayHit&) { ++*static_cast<int*>(count); }

// How many boxes a ray along the z axis enters.
int entered(const ProxyScene& proxies, int& count) {
  RTCRayHit query = query_of(Ray{{0, 0, -2}, {0, 0, 1}});
  const TreeRay tree(tree_ray(query.ray));
  RayContext context{};
  context.tree_ray = &tree;
  count = 0;
  proxies.scene().intersect(context, query);
  return count;
}

// Wide boxes around the axis, in all of which something small lies beside it. The last is never expanded, as cells are
// that no ray needs: the others' real bounds must come to be used all the same.
TEST(ProxyScene, UsesRealBoundsThoughSomeChildrenStayUnknown) {
  constexpr std::size_t children = 64;
  const Bounds3f wide{Vec3f(-1.f), Vec3f(1.f)}, real{Vec3f(0.5f), Vec3f(0.6f)};
  const std::vector<Bounds3f> bounds(children, wide);
  int count = 0;
  const BoxContents contents{&count, count_entered, nullptr};
  std::unique_ptr<ProxyScene> proxies;
  run_isolated(
      [&] { proxies = std::make_unique<ProxyScene>(bounds, contents, std::make_shared<KnownChildren>(children)); });
  EXPECT_EQ(entered(*proxies, count), int(children));
  for (std::size_t i = 0; i + 1 < children; ++i) proxies->tighten(i, real, {});
  EXPECT_LE(entered(*proxies, count), 2);
}

// An end at infinity is behind everything, but nowhere is no place before it.
TEST(ProxyScene, ARayWithoutEndDoesNotEnterWhatItPassesBy) {
  const RaySpan ray{{0, 0, -2}, {0, 0, 1}, 0, INFINITY};
  EXPECT_TRUE(enters(earliest_entry({Vec3f(-1.f), Vec3f(1.f)}, ray), ray.t_max));
  EXPECT_FALSE(enters(earliest_entry({Vec3f(0.5f), Vec3f(0.6f)}, ray), ray.t_max));
}

}  // namespace
}  // namespace meristem
