#include "renderer/loading/load_scene.h"

#include "geometry/base/parallel.h"
#include "geometry/base/sha256.h"
#include "geometry/fields/time.h"
#include "procedural/growth/forecast.h"
#include "renderer/cameras/moving_camera.h"
#include "renderer/language/override.h"
#include "renderer/language/scene_file.h"
#include "renderer/loading/all_components.h"
#include "renderer/loading/glowing_objects.h"
#include "renderer/loading/load_part.h"
#include "renderer/loading/load_settings.h"
#include "renderer/loading/scene_files.h"
#include "renderer/loading/scene_grids.h"
#include "renderer/media/expression_medium.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

namespace meristem {

namespace {

// What the scene's camera wants to see of geometry.
class CameraFootprint final : public Footprint {
 public:
  CameraFootprint(const Scene& scene, double detail)
      : camera_(*scene.camera),
        width_(scene.settings.width),
        height_(scene.settings.height),
        detail_(detail),
        fades_(scene.settings.fade) {}
  double at(Vec3d position) const override { return wanted(camera_.footprint(Vec3f(position), width_, height_)); }
  double at(Vec3d position, int time) const override {
    return wanted(camera_.footprint_at(Vec3f(position), share_of_shutter(time), width_, height_));
  }
  Range range(const Bounds3d& box) const override {
    const auto [least, most] = camera_.footprint_range(Vec3f(box.center()), float(box.diagonal() / 2), width_, height_);
    return {wanted(least), wanted(most)};
  }
  bool fades() const override { return fades_; }

 private:
  double wanted(float pixel) const {
    constexpr double smallest = 1e-9;  // at the camera itself
    return std::max(detail_ * double(pixel), smallest);
  }

  const Camera& camera_;
  const int width_, height_;
  const double detail_;  // pixels
  const bool fades_;
};

std::shared_ptr<const Footprint> camera_footprint(const Scene& scene, double detail) {
  if (detail <= 0) return nullptr;
  return std::make_shared<CameraFootprint>(scene, detail);
}

std::shared_ptr<const Footprint> camera_footprint(const Scene& scene) {
  return camera_footprint(scene, scene.settings.detail);
}

// What classes of rays want to see beside it.
void add_class_footprints(const Scene& scene, WorldOptions& options) {
  const auto [diffuse, shadow] = std::pair(scene.settings.diffuse_detail, scene.settings.shadow_detail);
  if (diffuse >= 0 && diffuse != scene.settings.detail) options.diffuse_footprint = camera_footprint(scene, diffuse);
  if (shadow >= 0 && shadow != scene.settings.detail)
    options.shadow_footprint = shadow == diffuse ? options.diffuse_footprint : camera_footprint(scene, shadow);
}

class SceneBuilder {
 public:
  SceneBuilder(const std::string& path, const LoadOptions& options) : path_(path), options_(options) {}

  LoadedScene build() {
    Value file = read_scene_file(path_, diagnostics_);
    diagnostics_.throw_if_errors();
    auto texts = scene_texts(file);
    for (const std::string& text : options_.set) apply_override(file, text, options_.frame.value_or(0), diagnostics_);
    diagnostics_.throw_if_errors();
    Params params(file, "scene", diagnostics_);
    params.raw("format", false, "", "");
    const Value* materials = section(params, "materials", Value::Kind::Object);
    const Value* models = section(params, "models", Value::Kind::Object);
    const Value* grid_section = section(params, "grids", Value::Kind::Object);
    const Value* objects = section(params, "objects", Value::Kind::Array);
    const Value* lights = section(params, "lights", Value::Kind::Array);
    const Value* media = section(params, "media", Value::Kind::Array);
    const Value* camera = section(params, "camera", Value::Kind::Object);
    const Value* cameras = section(params, "cameras", Value::Kind::Object);
    const Value* render = section(params, "render", Value::Kind::Object);
    params.finish();

    scene_ = std::make_unique<Scene>();
    add_render(render);
    shutter_ = shutter();
    TimeScope opening(shutter_.opens);
    name_materials(materials);
    const ModelContext context{
        [this](const std::string& name, const Location& where) { return material_index(name, where); },
        folder(),
        diagnostics_,
        {},
        0,
        [this](const std::string& name) { return production_number(name); },
        [this](const std::string& name, const Model& model) { forecast(name, model); }};
    PartLibrary library(models, context, shutter_);
    SceneGrids grids(grid_section, std::filesystem::path(path_ == "-" ? "" : path_).parent_path().string(),
                     shutter_.opens, library, diagnostics_);
    const GridScope expressions_may_name(&grids);
    add_materials(materials);
    add_lights(lights);
    add_media(media);
    choose_camera(file, camera, cameras);
    std::vector<Placement> world = objects ? library.place(*objects) : std::vector<Placement>{};
    scene_->moves = scene_->moves || library.moves();
    const std::size_t productions = scene_->names.productions.size(), forecasts = forecasts_.size();
    library.check_unused();
    scene_->names.productions.resize(productions);
    forecasts_.resize(forecasts);
    grids.check_unused();
    if (objects) scene_->names.objects = object_names(*objects);
    diagnostics_.throw_if_errors();
    if (wants_motion()) add_motion_vectors(objects, world);
    diagnostics_.throw_if_errors();

    add_glowing_objects(world, *scene_);
    LoadedScene result;
    result.models = std::move(forecasts_);
    if (options_.keep_objects) {
      result.objects = std::move(world);
      result.footprint = camera_footprint(*scene_);
    } else {
      make_intersector(std::move(world), render ? render->location : file.location);
      fill_media(media);
      diagnostics_.throw_if_errors();
    }
    if (!options_.check_only) scene_->prepare();
    result.scene = std::move(scene_);
    result.sha256 = sha256(file.location.source ? file.location.source->text : "");
    result.warnings = diagnostics_.list();
    result.texts = std::move(texts);
    result.files = all_files(file, grids);
    return result;
  }

 private:
  void make_intersector(std::vector<Placement> world, const Location& where) {
    const int threads = options_.threads > 0 ? options_.threads : default_thread_count();
    WorldOptions world_options{options_.expand, scene_->settings.budget_bytes, threads, camera_footprint(*scene_),
                               options_.record};
    add_class_footprints(*scene_, world_options);
    world_options.scratch_directory = options_.scratch_directory;
    if (!options_.keeps_uv) world_options.uv_readers = uv_readers();
    check_budget(world, world_options, where);
    scene_->intersector = make_world(std::move(world), world_options);
  }

  UvReaders uv_readers() const {
    const std::vector<Aov>& aovs = scene_->settings.aovs;
    if (std::ranges::find(aovs, Aov::Uv) != aovs.end()) return {};
    std::vector<bool> reads;
    for (const auto& material : scene_->materials) reads.push_back(material->reads_uv());
    return UvReaders(std::move(reads));
  }

  void check_budget(const std::vector<Placement>& world, const WorldOptions& options, const Location& where) {
    constexpr double kibibyte = 1 << 10, mebibyte = 1 << 20;
    const auto shown = [](std::uint64_t bytes) {
      return double(bytes) < mebibyte ? fmt::format("{:.3g} KiB", double(bytes) / kibibyte)
                                      : fmt::format("{:.4g} MiB", double(bytes) / mebibyte);
    };
    const std::uint64_t least = least_budget(world, options);
    if (options.budget_bytes >= least) return;
    diagnostics_.error(where, fmt::format("the budget of {} is too small: a ray of each of {} threads needs {}; at "
                                          "least --budget {:.0f}M, or fewer --threads",
                                          shown(options.budget_bytes), options.threads, shown(least),
                                          std::ceil(double(least) / mebibyte)));
    diagnostics_.throw_if_errors();
  }

  std::string folder() const {
    return path_ == "-" ? std::filesystem::current_path().string()
                        : std::filesystem::absolute(path_).parent_path().string();
  }

  // Those that texts of the scene name, and those that expressions in them name.
  std::vector<std::pair<std::string, std::string>> all_files(const Value& file, const SceneGrids& grids) const {
    auto files = named_files(file, folder());
    for (const auto& entry : grids.files())
      if (std::ranges::find(files, entry.first, [](const auto& f) { return f.first; }) == files.end())
        files.push_back(entry);
    return files;
  }

  const Value* section(Params& params, const char* name, Value::Kind kind) {
    const Value* value = params.raw(name, false, "", "");
    if (!value || value->kind == kind) return value;
    diagnostics_.error(value->location,
                       fmt::format("\"{}\" is {}, found {}", name,
                                   kind == Value::Kind::Array ? "an array" : "an object", value->kind_name()));
    return nullptr;
  }

  // An object that stands for "all defaults".
  Value empty_object() const {
    Value value;
    value.kind = Value::Kind::Object;
    return value;
  }

  template <class Interface>
  std::unique_ptr<Interface> make(const Registry<Interface>& registry, const Value* value, const char* fallback) {
    const Value defaults = empty_object();
    return registry.create(value ? *value : defaults, fallback, diagnostics_);
  }

  // Before anything is made: a material may ask a grid that is made of a model, which names materials.
  void name_materials(const Value* materials) {
    scene_->names.materials.push_back("default");
    for (const Member& m : materials ? materials->members : std::vector<Member>{}) {
      material_names_[m.key] = int(scene_->names.materials.size());
      scene_->names.materials.push_back(m.key);
    }
  }

  void add_materials(const Value* materials) {
    scene_->materials.push_back(make<Material>(all_components().materials, nullptr, default_material));
    for (const Member& m : materials ? materials->members : std::vector<Member>{})
      scene_->materials.push_back(make(all_components().materials, &m.value, default_material));
  }

  int material_index(const std::string& name, const Location& where) {
    if (name.empty()) return 0;
    if (const auto it = material_names_.find(name); it != material_names_.end()) return it->second;
    std::vector<std::string> names;
    for (const auto& [known, index] : material_names_) names.push_back(known);
    const std::string_view near = nearest_name(name, names);
    diagnostics_.error(
        where, fmt::format("no material named \"{}\"{}; known: {}", name,
                           near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near), fmt::join(names, ", ")));
    return 0;
  }

  // Individuals of one model share their numbers. The last one stays free: it is no_production.
  std::uint16_t production_number(const std::string& name) {
    std::vector<std::string>& names = scene_->names.productions;
    const auto [known, is_new] = production_numbers_.try_emplace(name, std::uint16_t(names.size()));
    if (!is_new) return known->second;
    if (names.size() < no_production) names.push_back(name);
    return known->second;
  }

  // Individuals of one model have about as many.
  void forecast(const std::string& name, const Model& model) {
    if (!options_.check_only || options_.keep_objects) return;
    const bool is_known = std::ranges::any_of(forecasts_, [&](const auto& f) { return f.first == name; });
    if (!is_known) forecasts_.emplace_back(name, expected_faces(model));
  }

  void add_lights(const Value* lights) {
    if (!lights) return;
    for (const Value& light : lights->items)
      if (auto made = all_components().lights.create(light, "", diagnostics_))
        scene_->lights.push_back(std::move(made));
  }

  void add_media(const Value* media) {
    for (const Value& value : media ? media->items : std::vector<Value>{}) {
      if (value.kind != Value::Kind::Object) {
        diagnostics_.error(value.location, fmt::format("a medium is an object, found {}", value.kind_name()));
        continue;
      }
      Params params(value, "medium", diagnostics_);
      media_.push_back(new ExpressionMedium(params));
      scene_->media.emplace_back(media_.back());
      params.finish();
    }
  }

  // Once it is known how far the scene reaches.
  void fill_media(const Value* media) {
    for (std::size_t i = 0; i < media_.size(); ++i) {
      try {
        media_[i]->fill(scene_->intersector->bounds());
      } catch (const std::runtime_error& error) {
        diagnostics_.error(media->items[i].location, error.what());
      }
    }
  }

  // "camera" is one, "cameras" are several by name; --camera picks one of these.
  void choose_camera(const Value& file, const Value* camera, const Value* cameras) {
    std::vector<std::string> names;
    const Value* chosen = options_.camera.empty() ? camera : nullptr;
    if (camera) all_components().cameras.create(*camera, default_camera, diagnostics_);
    for (const Member& m : cameras ? cameras->members : std::vector<Member>{}) {
      names.push_back(m.key);
      all_components().cameras.create(m.value, default_camera, diagnostics_);
    }
    if (!chosen && cameras)
      for (const Member& m : cameras->members)
        if (options_.camera.empty() ? !chosen : m.key == options_.camera) chosen = &m.value;
    if (!chosen) diagnostics_.error(camera ? camera->location : file.location, missing_camera(names));
    if (chosen) make_camera(*chosen);
  }

  std::string missing_camera(const std::vector<std::string>& names) const {
    if (options_.camera.empty()) return "the scene has no \"camera\"";
    if (names.empty())
      return fmt::format("no camera named \"{}\": the scene's only one has no name; --camera chooses among \"cameras\"",
                         options_.camera);
    return fmt::format("no camera named \"{}\"; known: {}", options_.camera, fmt::join(names, ", "));
  }

  void make_camera(const Value& chosen) {
    TimeScope opening(shutter_.opens);
    Diagnostics reported_already;
    scene_->camera = all_components().cameras.create(chosen, default_camera, reported_already);
    if (reported_already.has_errors() || !opening.was_read()) return;
    if (wants_motion()) later_camera_ = camera_at(chosen, shutter_.opens + 1);
    if (!shutter_.is_open()) return;
    std::vector<std::unique_ptr<Camera>> keys;
    for (int key = 0; key < Shutter::keys; ++key) {
      keys.push_back(camera_at(chosen, shutter_.key_time(key)));
      if (!keys.back()) return;
    }
    scene_->camera = std::make_unique<MovingCamera>(std::move(keys));
    scene_->moves = true;
  }

  // Null, with an error, if it is none at that time.
  std::unique_ptr<Camera> camera_at(const Value& chosen, double time) {
    TimeScope scope(time);
    Diagnostics found;
    auto camera = all_components().cameras.create(chosen, default_camera, found);
    return report_errors_at(time, found, diagnostics_) ? nullptr : std::move(camera);
  }

  bool wants_motion() const {
    return std::ranges::find(scene_->settings.aovs, Aov::Motion) != scene_->settings.aovs.end();
  }

  void add_motion_vectors(const Value* objects, const std::vector<Placement>& world) {
    std::vector<MotionVectors::Object> list;
    bool moves = later_camera_ != nullptr;
    for (std::size_t i = 0; i < world.size(); ++i) {
      const Affine3d& now = world[i].to_parent;
      const auto later = object_transform(objects->items[i], shutter_.opens + 1, diagnostics_);
      list.push_back({now, later.value_or(now), world[i].motion});
      moves = moves || list.back().later != now;
    }
    if (moves) scene_->motion_vectors = std::make_unique<MotionVectors>(std::move(later_camera_), std::move(list));
  }

  void add_render(const Value* render) {
    const Value defaults = empty_object();
    Params params(render ? *render : defaults, "render", diagnostics_);
    const RenderSection section = read_render(params);
    params.finish();
    scene_->settings = section.settings;
    override_settings(scene_->settings);
    scene_->integrator = make(all_components().integrators, section.integrator, default_integrator);
    scene_->sampler = make(all_components().samplers, section.sampler, default_sampler);
    scene_->filter = make(all_components().filters, section.filter, default_filter);
  }

  // An export shows the frame's own time.
  Shutter shutter() const {
    const RenderSettings& s = scene_->settings;
    return {double(options_.frame.value_or(0)), options_.keep_objects ? 0 : s.shutter, s.shutter_moments};
  }

  void override_settings(RenderSettings& s) const {
    s.width = options_.width.value_or(s.width);
    s.height = options_.height.value_or(s.height);
    s.samples = options_.samples.value_or(s.samples);
    s.max_depth = options_.max_depth.value_or(s.max_depth);
    s.detail = options_.detail.value_or(s.detail);
    s.shutter = options_.shutter.value_or(s.shutter);
    s.seed = options_.seed.value_or(s.seed);
    s.budget_bytes = options_.budget_bytes.value_or(s.budget_bytes);
    s.queue_bytes = options_.queue_bytes.value_or(s.queue_bytes);
    s.ray_order = options_.ray_order.value_or(s.ray_order);
    s.noise = options_.noise.value_or(s.noise);
    s.aovs.insert(s.aovs.end(), options_.aovs.begin(), options_.aovs.end());
    std::ranges::sort(s.aovs);
    s.aovs.erase(std::unique(s.aovs.begin(), s.aovs.end()), s.aovs.end());
  }

  const std::string path_;
  const LoadOptions& options_;
  Diagnostics diagnostics_;
  std::unique_ptr<Scene> scene_;
  Shutter shutter_;
  std::unique_ptr<Camera> later_camera_;  // a frame later; null: it is where it was, or nobody asks
  std::map<std::string, int> material_names_;
  std::map<std::string, std::uint16_t> production_numbers_;
  std::vector<std::pair<std::string, double>> forecasts_;
  std::vector<ExpressionMedium*> media_;  // those of the scene
};

}  // namespace

LoadedScene load_scene(const std::string& path, const LoadOptions& options) {
  return SceneBuilder(path, options).build();
}

}  // namespace meristem
