// Scene: everything a render needs, built once from a scene file and prepared, then read-only.
#pragma once

#include "renderer/scene/aov.h"
#include "renderer/scene/interfaces.h"
#include "renderer/scene/medium.h"
#include "renderer/scene/motion_vectors.h"

#include <memory>
#include <string>
#include <vector>

namespace meristem {

// In which order rays are traced. The image is the same.
enum class RayOrder : std::uint8_t {
  DepthFirst,  // each path at once
  Queued,      // many paths at once, each of which waits for cells that are not resident
  Auto         // depth-first, until cells are expanded again too often
};

// The settings of the member "render" of a scene file; command line options override them.
struct RenderSettings {
  int width = 1280, height = 720;
  int samples = 64;
  int max_depth = 8;                               // bounces
  double detail = 1;                               // wanted size of faces in pixels; 0: every level, however small
  bool fade = false;                               // whether the last level of a vertex fades in
  double diffuse_detail = -1, shadow_detail = -1;  // `detail` of what rays of these classes meet; negative: the same
  std::uint64_t seed = 0;
  std::uint64_t budget_bytes = std::uint64_t(2) << 30;  // of the geometry cache
  RayOrder ray_order = RayOrder::Auto;
  std::uint64_t queue_bytes = std::uint64_t(128) << 20;  // of paths that wait; beside the budget
  double shutter = 0;                                    // how long it is open, in frames
  int shutter_moments = 8;                               // at which growth that changes is built, while it is open
  double noise = 0;       // a pixel takes no more samples when its noise falls below it (film/noise.h); 0: never
  std::vector<Aov> aovs;  // beside the beauty; sorted, each once
};

// What things are called, for mattes. Indices are those of SurfaceHit::object, FaceOrigin::material and ::production.
struct SceneNames {
  std::vector<std::string> objects, materials, productions;
};

class Scene {
 public:
  std::unique_ptr<Camera> camera;
  std::vector<std::unique_ptr<Light>> lights;
  std::vector<std::unique_ptr<Material>> materials;  // by FaceOrigin::material; never empty: [0] is the default
  std::vector<std::unique_ptr<Medium>> media;
  std::unique_ptr<Integrator> integrator;
  std::unique_ptr<Sampler> sampler;
  std::unique_ptr<Filter> filter;
  std::unique_ptr<Intersector> intersector;
  RenderSettings settings;
  SceneNames names;
  bool moves = false;                             // something does while the shutter is open: paths draw a time
  std::unique_ptr<MotionVectors> motion_vectors;  // null: nobody asks for them, or they are all 0

  // Makes what rendering needs and checking does not, such as tables of lights. Once, before the first ray.
  void prepare() {
    for (const auto& light : lights) light->prepare();
    integrator->prepare(*this);
  }

  std::size_t material_index(const SurfaceHit& hit) const {
    const int i = hit.origin.material;
    return i >= 0 && std::size_t(i) < materials.size() ? std::size_t(i) : 0;
  }
  const Material& material_of(const SurfaceHit& hit) const { return *materials[material_index(hit)]; }
};

}  // namespace meristem
