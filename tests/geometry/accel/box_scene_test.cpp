#include "geometry/accel/box_scene.h"

#include "geometry/base/key.h"
#include "geometry/base/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace meristem {
namespace {

float random(Key key, Key what) { return 2 * uniform_float(hash_keys(key, what)) - 1; }

std::vector<Bounds3f> boxes_of(std::size_t count) {
  std::vector<Bounds3f> boxes(count);
  for (Key i = 0; i < count; ++i) {
    if (i % 7 == 6) continue;  // nothing is in it
    const Vec3f center{3 * random(i, 1), 3 * random(i, 2), 3 * random(i, 3)};
    boxes[i] = Bounds3f{center, center}.inflated(Vec3f{1.1f + random(i, 4), 1.1f + random(i, 5), i % 5 ? 0.5f : 0.f});
  }
  return boxes;
}

struct TestRay {
  Vec3f origin, direction;
  explicit TestRay(Key key) : origin{5 * random(key, 6), 5 * random(key, 7), 5 * random(key, 8)} {
    direction = Vec3f{2 * random(key, 9), 2 * random(key, 10), 2 * random(key, 11)} - origin;
    if (key % 4 == 0) direction = {0, 0, direction.z > 0 ? 1.f : -1.f};  // along an axis
  }
  // Where it enters a box, exactly; infinity: nowhere.
  double entry(const Bounds3f& box) const {
    double from = 0, to = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
      const double o = double(origin[axis]), d = double(direction[axis]);
      const double a = (double(box.lower[axis]) - o) / d, b = (double(box.upper[axis]) - o) / d;
      if (d == 0 && (o < double(box.lower[axis]) || o > double(box.upper[axis]))) return INFINITY;
      if (d == 0) continue;
      from = std::max(from, std::min(a, b));
      to = std::min(to, std::max(a, b));
    }
    return !box.empty() && from <= to ? from : INFINITY;
  }
};

// What a ray went through, in that order; it ends where it is told to.
struct Visits {
  std::vector<std::uint32_t> boxes;
  float end = INFINITY;
  std::size_t most = ~std::size_t(0);
  static void intersect(void* self, std::uint32_t box, RayContext&, RTCRayHit& ray) {
    static_cast<Visits*>(self)->boxes.push_back(box);
    ray.ray.tfar = std::min(ray.ray.tfar, static_cast<Visits*>(self)->end);
  }
  static void occluded(void* self, std::uint32_t box, RayContext&, RTCRay& ray) {
    auto& visits = *static_cast<Visits*>(self);
    visits.boxes.push_back(box);
    if (visits.boxes.size() == visits.most) ray.tfar = -INFINITY;
  }
};

class Scene {
 public:
  explicit Scene(std::size_t count) : boxes(boxes_of(count)) {
    run_isolated([&] { scene_.emplace(boxes, BoxContents{&visits_, Visits::intersect, Visits::occluded}); });
  }

  Visits trace(const TestRay& ray, float end = INFINITY) {
    visits_ = {};
    visits_.end = end;
    run(ray, [&](RayContext& context, RTCRayHit& query) { scene_->intersect(context, query); });
    return visits_;
  }
  Visits occlude(const TestRay& ray, std::size_t most) {
    visits_ = {};
    visits_.most = most;
    run(ray, [&](RayContext& context, RTCRayHit& query) { scene_->occluded(context, query.ray); });
    return visits_;
  }

  std::optional<std::size_t> entered(const TestRay& ray, FewBoxes::List& list) const {
    return scene_->entered(TreeRay(ray.origin, ray.direction), 0, INFINITY, list);
  }

  const std::vector<Bounds3f> boxes;

 private:
  template <class Trace>
  static void run(const TestRay& ray, const Trace& trace) {
    RayContext context;
    rtcInitIntersectContext(&context.embree);
    const TreeRay tree(ray.origin, ray.direction);
    context.tree_ray = &tree;
    RTCRayHit query = query_of(Ray{ray.origin, ray.direction});
    trace(context, query);
  }

  Visits visits_;
  std::optional<BoxScene> scene_;
};

constexpr std::size_t counts[] = {1, 2, 5, FewBoxes::most, FewBoxes::most + 1, 200, 1100};

TEST(BoxScene, KnowsItsBoxesIfTheyAreFew) {
  const BoxContents nothing{nullptr, nullptr, nullptr};
  for (const std::size_t count : {1, 3, 32}) {
    const std::vector<Bounds3f> boxes = boxes_of(count), few = BoxScene(boxes, nothing).few_boxes();
    ASSERT_EQ(few.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(few[i].empty(), boxes[i].empty()) << i;
      EXPECT_EQ(few[i].lower, boxes[i].lower) << i;
      EXPECT_EQ(few[i].upper, boxes[i].upper) << i;
    }
  }
  run_isolated([&] { EXPECT_TRUE(BoxScene(boxes_of(33), nothing).few_boxes().empty()); });
}

TEST(BoxScene, ARayVisitsEachBoxThatItEntersOnce) {
  for (const std::size_t count : counts) {
    Scene scene(count);
    std::size_t entered = 0, visited = 0;
    for (Key key = 0; key < 500; ++key) {
      const TestRay ray(key);
      const Visits visits = scene.trace(ray);
      const std::set<std::uint32_t> seen(visits.boxes.begin(), visits.boxes.end());
      EXPECT_EQ(seen.size(), visits.boxes.size());
      visited += seen.size();
      for (std::uint32_t i = 0; i < count; ++i) {
        const bool enters = ray.entry(scene.boxes[i]) < INFINITY;
        entered += enters;
        EXPECT_TRUE(!enters || seen.count(i)) << count << " boxes, ray " << key << ", box " << i;
      }
    }
    EXPECT_GT(entered, 0u);
    EXPECT_LE(double(visited), 1.03 * double(entered)) << count;  // in trees boxes are kept in bytes
  }
}

TEST(BoxScene, FewAreVisitedInTheirOrderUpToTheEndOfTheRay) {
  Scene scene(FewBoxes::most);
  std::size_t spared = 0;
  for (Key key = 0; key < 500; ++key) {
    const TestRay ray(key);
    const std::vector<std::uint32_t> all = scene.trace(ray).boxes;
    const auto entry = [&](std::uint32_t i) { return ray.entry(scene.boxes[i]); };
    for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LE(entry(all[i - 1]), entry(all[i]) + 1e-4);
    if (all.size() < 2) continue;
    const double end = 0.5 * (entry(all.front()) + entry(all.back()));
    const std::vector<std::uint32_t> some = scene.trace(ray, float(end)).boxes;
    EXPECT_LT(some.size(), entry(all.front()) < entry(all.back()) - 1e-3 ? all.size() : all.size() + 1);
    spared += all.size() - some.size();
  }
  EXPECT_GT(spared, 100u);
}

TEST(BoxScene, ListsWhatARayEntersOfFew) {
  Scene scene(FewBoxes::most);
  std::size_t all = 0;
  for (Key key = 0; key < 500; ++key) {
    const TestRay ray(key);
    FewBoxes::List list;
    const auto entered = scene.entered(ray, list);
    ASSERT_TRUE(entered);
    all += *entered;
    const auto end = list.begin() + std::ptrdiff_t(*entered);
    for (std::uint32_t i = 0; i < FewBoxes::most; ++i) {
      const double entry = ray.entry(scene.boxes[i]);
      if (!(entry < INFINITY)) continue;
      const auto found = std::find_if(list.begin(), end, [i](const FewBoxes::Entered& e) { return e.box == i; });
      ASSERT_NE(found, end) << "ray " << key << ", box " << i;
      EXPECT_LE(found->t, entry + 1e-6);
      EXPECT_GE(found->t, entry - 1e-3);
    }
    EXPECT_TRUE(std::ranges::is_sorted(list.begin(), end, {}, [](const FewBoxes::Entered& e) { return e.t; }));
  }
  EXPECT_GT(all, 500u);
  FewBoxes::List list;
  EXPECT_FALSE(Scene(FewBoxes::most + 1).entered(TestRay(1), list)) << "not few";
}

TEST(BoxScene, OneThatIsInTheWayIsEnough) {
  for (const std::size_t count : counts) {
    Scene scene(count);
    for (Key key = 0; key < 100; ++key) {
      const TestRay ray(key);
      const std::size_t all = scene.trace(ray).boxes.size();
      EXPECT_EQ(scene.occlude(ray, 1).boxes.size(), std::min<std::size_t>(all, 1));
      EXPECT_EQ(scene.occlude(ray, ~std::size_t(0)).boxes.size(), all);
    }
  }
}

}  // namespace
}  // namespace meristem
