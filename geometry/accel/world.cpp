#include "geometry/accel/world.h"

#include "geometry/accel/model_root.h"
#include "geometry/mesh/limit.h"
#include "geometry/mesh/refine_plan.h"

#include <atomic>
#include <limits>
#include <map>

namespace meristem {

namespace {

constexpr std::size_t unlimited_bytes = std::numeric_limits<std::size_t>::max();

// Of the tables that all cells share.
std::size_t shared_plan_bytes() { return refine_plan_bytes() + limit_plan_bytes(); }

std::unique_ptr<ExpansionRecorder> make_recorder(const WorldOptions& options) {
  if (!options.record || options.mode == ExpandMode::Flat) return nullptr;
  const std::size_t budget = options.mode == ExpandMode::Lazy ? options.budget_bytes : 0;
  return std::make_unique<ExpansionRecorder>(budget, shared_plan_bytes);
}

// While one lives, the ray counts the cells it meets, if there is a recorder and the ray is in its sample.
class SampledRay {
 public:
  SampledRay(ExpansionRecorder* recorder, RayContext& context) : recorder_(recorder) {
    if (recorder_ && !(context.visits = recorder_->begin_ray())) recorder_ = nullptr;
  }
  ~SampledRay() {
    if (recorder_) recorder_->end_ray();
  }
  SampledRay(const SampledRay&) = delete;
  SampledRay& operator=(const SampledRay&) = delete;

 private:
  ExpansionRecorder* recorder_;
};

class World final : public Intersector {
 public:
  World(std::vector<WorldObject> objects, const WorldOptions& options)
      : recorder_(make_recorder(options)),
        cache_(options.mode == ExpandMode::Lazy ? options.budget_bytes : unlimited_bytes, recorder_.get()),
        counts_(recorder_.get()) {
    std::map<const Model*, const ModelRoot*> roots;
    for (WorldObject& o : objects) {
      const ModelRoot*& root = roots[o.model.get()];
      if (!root) {
        roots_.push_back(make_root(o.model, options));
        root = roots_.back().get();
      }
      objects_.emplace_back(*root, o.to_world);
      bounds_.extend(objects_.back().bounds);
    }
    build_scene();
  }

  bool intersect(const Ray& ray, SurfaceHit& hit) const override {
    RTCRayHit query;
    if (!start(ray, query.ray)) return false;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RayContext context;
    rtcInitIntersectContext(&context.embree);
    const SampledRay sampled(recorder_.get(), context);
    if (is_single_identity_) {
      context.object = 0;
      objects_[0].root.intersect(context, query);
    } else {
      rtcIntersect1(scene_.get(), &context.embree, &query);
    }
    if (!context.patch) return false;
    hit = objects_[std::size_t(context.patch_object)].to_world_surface(
        context.patch->surface_at({query.hit.geomID, query.hit.primID, query.hit.u, query.hit.v}));
    hit.t = query.ray.tfar;
    hit.object = context.patch_object;
    return true;
  }

  bool occluded(const Ray& ray) const override {
    RTCRay query;
    if (!start(ray, query)) return false;
    RayContext context;
    rtcInitIntersectContext(&context.embree);
    const SampledRay sampled(recorder_.get(), context);
    if (is_single_identity_)
      objects_[0].root.occluded(context, query);
    else
      rtcOccluded1(scene_.get(), &context.embree, &query);
    return query.tfar < 0;
  }

  void quiescent() const override { cache_.leave(); }
  Bounds3f bounds() const override { return bounds_; }

  ExpansionStatistics statistics() const override {
    ExpansionStatistics s;
    const CacheStatistics c = cache_.statistics();
    counts_.write(s);
    s.cells_expanded = c.expansions;
    s.reexpanded = c.reexpansions;
    s.evicted = c.evictions;
    s.failed += c.failures;
    s.waits = c.waits;
    s.resident_bytes_peak = c.resident_bytes_peak;
    s.limbo_bytes_peak = c.limbo_bytes_peak;
    s.plan_bytes = shared_plan_bytes();
    s.invalid_rays = invalid_rays_.load();
    return s;
  }

  std::optional<ExpansionProfile> profile() const override {
    return recorder_ ? std::optional(recorder_->profile()) : std::nullopt;
  }

 private:
  struct Object {
    Object(const ModelRoot& r, const Affine3d& m)
        : root(r),
          to_world(m_float(m)),
          from_world(m_float(m.inverse())),
          is_identity(m.is_identity()),
          bounds(round_outwards(m.bounds(Bounds3d{Vec3d(r.bounds().lower), Vec3d(r.bounds().upper)}))) {
      if (is_identity) bounds = r.bounds();
    }
    static Affine3f m_float(const Affine3d& m) { return {Vec3f(m.x), Vec3f(m.y), Vec3f(m.z), Vec3f(m.origin)}; }

    SurfaceHit to_world_surface(SurfaceHit hit) const {
      if (is_identity) return hit;
      const Vec3f p = hit.position, e = hit.position_error;
      hit.position = to_world.point(p);
      // The error carried over, and that of the product: gamma(4) of the sum of magnitudes.
      auto magnitudes = [&](Vec3f v) {
        return abs(to_world.x) * std::abs(v.x) + abs(to_world.y) * std::abs(v.y) + abs(to_world.z) * std::abs(v.z);
      };
      hit.position_error = magnitudes(e) + (magnitudes(p) + abs(to_world.origin)) * (4 * 0x1p-24f);
      hit.geometric_normal = normalize(from_world.transposed_vector(hit.geometric_normal));
      hit.shading_normal = normalize(from_world.transposed_vector(hit.shading_normal));
      hit.dpdu = to_world.vector(hit.dpdu);
      hit.dpdv = to_world.vector(hit.dpdv);
      return hit;
    }

    const ModelRoot& root;
    Affine3f to_world, from_world;
    bool is_identity;
    Bounds3f bounds;
  };

  std::unique_ptr<ModelRoot> make_root(const std::shared_ptr<const Model>& model, const WorldOptions& options) {
    if (options.mode == ExpandMode::Flat) return make_flat_root(model, counts_, options.threads);
    auto root = make_lazy_root(model, cache_, counts_);
    if (options.mode == ExpandMode::Eager) expand_everything(*root, options.threads);
    return root;
  }

  void build_scene() {
    is_single_identity_ = objects_.size() == 1 && objects_[0].is_identity;
    scene_.reset(rtcNewScene(embree_device()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, unsigned(objects_.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, object_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect_object);
    rtcSetGeometryOccludedFunction(geometry, occluded_object);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    commit_scene(scene_.get());
  }

  bool start(const Ray& ray, RTCRay& query) const {
    if (!is_finite(ray.origin) || !is_finite(ray.direction) || ray.direction == Vec3f{}) {
      invalid_rays_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    if (objects_.empty()) return false;
    cache_.enter();
    query = {ray.origin.x,
             ray.origin.y,
             ray.origin.z,
             ray.t_min,
             ray.direction.x,
             ray.direction.y,
             ray.direction.z,
             ray.time,
             ray.t_max,
             ~0u,
             0,
             0};
    return true;
  }

  static void object_bounds(const RTCBoundsFunctionArguments* args) {
    const Bounds3f& b = static_cast<const World*>(args->geometryUserPtr)->objects_[args->primID].bounds;
    *args->bounds_o = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z, 0};
  }

  // The ray in the object's frame; its direction keeps its length, so t is the same in both.
  static void transform(const Object& object, RTCRay& ray) {
    const Vec3f o = object.from_world.point({ray.org_x, ray.org_y, ray.org_z});
    const Vec3f d = object.from_world.vector({ray.dir_x, ray.dir_y, ray.dir_z});
    ray.org_x = o.x, ray.org_y = o.y, ray.org_z = o.z;
    ray.dir_x = d.x, ray.dir_y = d.y, ray.dir_z = d.z;
  }

  static void intersect_object(const RTCIntersectFunctionNArguments* args) {
    if (!args->valid[0]) return;
    const Object& object = static_cast<const World*>(args->geometryUserPtr)->objects_[args->primID];
    auto& context = *reinterpret_cast<RayContext*>(args->context);
    auto& ray = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    context.object = int(args->primID);
    if (object.is_identity) return object.root.intersect(context, ray);
    RTCRayHit local = ray;
    transform(object, local.ray);
    object.root.intersect(context, local);
    ray.ray.tfar = local.ray.tfar;
    ray.hit = local.hit;
  }

  static void occluded_object(const RTCOccludedFunctionNArguments* args) {
    if (!args->valid[0]) return;
    const Object& object = static_cast<const World*>(args->geometryUserPtr)->objects_[args->primID];
    auto& context = *reinterpret_cast<RayContext*>(args->context);
    auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
    if (object.is_identity) return object.root.occluded(context, ray);
    RTCRay local = ray;
    transform(object, local);
    object.root.occluded(context, local);
    ray.tfar = local.tfar;
  }

  const std::unique_ptr<ExpansionRecorder> recorder_;  // null: nothing is recorded
  mutable GeometryCache cache_;
  ExpansionCounts counts_;
  mutable std::atomic<std::uint64_t> invalid_rays_{0};
  std::vector<std::unique_ptr<ModelRoot>> roots_;
  std::vector<Object> objects_;
  Bounds3f bounds_;
  ScenePtr scene_;
  bool is_single_identity_ = false;
};

}  // namespace

std::unique_ptr<Intersector> make_world(std::vector<WorldObject> objects, const WorldOptions& options) {
  return std::make_unique<World>(std::move(objects), options);
}

}  // namespace meristem
