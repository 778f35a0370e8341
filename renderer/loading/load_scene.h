// From a scene file to a Scene ready to render: read, check, build. Nothing is traced yet.
//
// With ExpandMode::Lazy geometry expands where rays hit; Eager expands every cell while loading; Flat expands
// everything into one Embree scene without cells or cache. The three show the same image (docs/architecture.md names
// the exceptions).
#pragma once

#include "geometry/accel/world.h"
#include "geometry/base/source.h"
#include "renderer/scene/scene.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace meristem {

// What the command line says over the scene file; what is not set stays as the file has it.
struct LoadOptions {
  ExpandMode expand = ExpandMode::Lazy;
  int threads = 0;                            // for eager expansion; 0: default_thread_count()
  std::optional<std::uint64_t> budget_bytes;  // of the geometry cache
  std::optional<std::uint64_t> queue_bytes;   // of rays that wait
  std::optional<RayOrder> ray_order;
  std::optional<int> width, height, samples, max_depth;
  std::optional<std::uint64_t> seed;
  std::optional<double> detail;   // pixels; 0: everything in full
  std::optional<double> shutter;  // frames that it is open
  std::string scratch_directory;  // for surfaces that are evicted; empty: none
  bool record = false;            // what expansion does, for Intersector::profile()
  bool keeps_uv = false;          // of all surfaces, whether materials and AOVs read u, v or not
  bool check_only = false;        // the scene will not be rendered: Scene::prepare() is left out
  bool keep_objects = false;      // LoadedScene::objects in place of a world to trace rays into; with check_only
  std::string camera;             // name of one of the file's cameras; empty: the file's first
  std::optional<double> noise;
  std::vector<Aov> aovs;         // besides those of the file
  std::vector<std::string> set;  // overrides of single values: renderer/language/override.h
  std::optional<int> frame;      // its number: `time` of expressions and `frame` of overrides; 0 if there is none
};

struct LoadedScene {
  std::unique_ptr<Scene> scene;  // never null
  std::string sha256;            // of the scene text, 64 hexadecimal digits
  std::vector<Diagnostic> warnings;
  std::vector<std::pair<std::string, std::string>> texts = {};  // read, included ones too: name and SHA-256
  std::vector<std::pair<std::string, std::string>> files = {};  // that the scene names: name and path
  std::vector<std::pair<std::string, double>> models = {};      // with check_only: how many faces they have in full
  std::vector<Placement> objects = {};                          // if they are kept
  std::shared_ptr<const Footprint> footprint = nullptr;         // with them; borrows the scene's camera
};

// `path` is a file, or "-" for standard input. Throws SceneErrors with every error of the pass, an unreadable file
// among them.
LoadedScene load_scene(const std::string& path, const LoadOptions& options);

}  // namespace meristem
