#include "renderer/interchange/pbrt_reader.h"

#include "renderer/interchange/pbrt_materials.h"
#include "renderer/interchange/pbrt_shapes.h"
#include "renderer/language/json_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

namespace meristem {

namespace {

constexpr double light_radius = 0.01;  // of a sphere that stands for a point

// What statements change and AttributeBegin keeps.
struct GraphicsState {
  Affine3d to_world;
  std::string material;  // name of one of the converted scene's
  std::optional<Vec3d> glow;
  bool is_reversed = false;
};

class PbrtReader {
 public:
  PbrtReader(const std::string& path, AssetFolder& assets, Diagnostics& diagnostics)
      : tokens_(path, diagnostics), diagnostics_(diagnostics), materials_(tokens_.folder(), assets, diagnostics) {}

  ForeignScene read() {
    for (PbrtToken token = tokens_.next(); token.kind != PbrtToken::Kind::End; token = tokens_.next()) {
      if (token.kind != PbrtToken::Kind::Word) {
        error(token.where, fmt::format("expected the name of a statement, found \"{}\"", token.text));
      } else {
        statement_ = token.where;
        statement(std::string(token.text));
      }
      if (errors_ >= most_errors) break;
    }
    finish();
    return std::move(scene_);
  }

 private:
  static constexpr int most_errors = 20;

  void statement(const std::string& name) {
    if (transform_statement(name) || attribute_statement(name)) return;
    if (name == "Include" || name == "Import") return tokens_.include(text(), statement_);
    if (name == "WorldBegin") {
      state_.to_world = {};
      named_["world"] = {};
    } else if (name == "Camera") {
      with_parameters([&](const std::string& type, PbrtParameters& p) { camera(type, p); });
    } else if (name == "Film") {
      with_parameters([&](const std::string&, PbrtParameters& p) { film(p); });
    } else if (name == "Sampler") {
      with_parameters([&](const std::string&, PbrtParameters& p) { samples_ = p.integer("pixelsamples", 16); });
    } else if (name == "Integrator") {
      with_parameters([&](const std::string&, PbrtParameters& p) { depth_ = p.integer("maxdepth", 5); });
    } else if (name == "Shape") {
      with_parameters([&](const std::string& type, PbrtParameters& p) { shape(type, p); });
    } else if (name == "LightSource") {
      with_parameters([&](const std::string& type, PbrtParameters& p) { light(type, p); });
    } else if (name == "PixelFilter" || name == "Accelerator" || name == "ColorSpace") {
      text();
      PbrtParameters ignored(tokens_, diagnostics_);  // ours do as well
    } else {
      leave_out(name);
    }
  }

  // ---- Transforms

  bool transform_statement(const std::string& name) {
    Affine3d& m = state_.to_world;
    if (name == "Identity") {
      m = {};
    } else if (name == "Translate") {
      m = m * Affine3d::translation(vector());
    } else if (name == "Scale") {
      m = m * Affine3d::scaling(checked_scale(vector()));
    } else if (name == "Rotate") {
      const double angle = number();
      const Vec3d axis = vector();
      if (length(axis) > 0) m = m * Affine3d::rotation(normalize(axis), angle * pi / 180);
    } else if (name == "LookAt") {
      m = m * look_at();
    } else if (name == "Transform" || name == "ConcatTransform") {
      const Affine3d read = matrix();
      m = name == "Transform" ? read : m * read;
    } else if (name == "CoordinateSystem") {
      named_[text()] = m;
    } else if (name == "CoordSysTransform") {
      const std::string of = text();
      if (const auto known = named_.find(of); known != named_.end())
        m = known->second;
      else
        error(statement_, fmt::format("there is no coordinate system named \"{}\" before this", of));
    } else {
      return false;
    }
    if (!(std::abs(m.determinant()) > 1e-30) || !std::isfinite(m.determinant())) {
      error(statement_, "the transform cannot be inverted");
      m = {};
    }
    return true;
  }

  Vec3d checked_scale(Vec3d s) const { return {s.x == 0 ? 1 : s.x, s.y == 0 ? 1 : s.y, s.z == 0 ? 1 : s.z}; }

  // From the world to a camera that looks along z, as pbrt has it: a left-handed frame.
  Affine3d look_at() {
    const Vec3d eye = vector(), at = vector(), up = vector();
    const Vec3d forward = normalize(at - eye), right = normalize(cross(normalize(up), forward));
    if (length_squared(right) == 0) {
      error(statement_, "LookAt looks along its own up");
      return {};
    }
    return Affine3d{right, cross(forward, right), forward, eye}.inverse();
  }

  Affine3d matrix() {
    std::array<double, 16> m{};
    if (tokens_.peek().kind == PbrtToken::Kind::Open) tokens_.next();
    for (double& x : m) x = number();
    if (tokens_.peek().kind == PbrtToken::Kind::Close) tokens_.next();
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) error(statement_, "the last row of a matrix is 0 0 0 1");
    return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
  }

  // ---- Attributes

  bool attribute_statement(const std::string& name) {
    if (name == "AttributeBegin" || name == "TransformBegin") {
      stack_.push_back(state_);
      if (stack_.size() > 1024) error(statement_, "attributes nest deeper than 1024");
    } else if (name == "AttributeEnd" || name == "TransformEnd") {
      pop(name == "TransformEnd");
    } else if (name == "ObjectBegin") {
      stack_.push_back(state_);
      object_ = text();
      scene_.groups.emplace_back("object-" + object_, std::vector<ForeignObject>{});
      is_in_object_ = true;
    } else if (name == "ObjectEnd") {
      is_in_object_ = false;
      pop(false);
    } else if (name == "ObjectInstance") {
      instance(text());
    } else if (name == "ReverseOrientation") {
      state_.is_reversed = !state_.is_reversed;
    } else if (name == "Material") {
      with_parameters([&](const std::string& type, PbrtParameters& p) {
        state_.material = add_material(fmt::format("material-{}", ++materials_made_), type, p);
      });
    } else if (name == "MakeNamedMaterial") {
      with_parameters([&](const std::string& own, PbrtParameters& p) {
        add_material("named-" + own, p.text("type", "diffuse"), p);
      });
    } else if (name == "NamedMaterial") {
      const std::string of = text();
      state_.material = "named-" + of;
      if (!material_named(state_.material))
        error(statement_, fmt::format("there is no material named \"{}\" before this", of));
    } else if (name == "Texture") {
      texture();
    } else if (name == "AreaLightSource") {
      with_parameters([&](const std::string& type, PbrtParameters& p) { area_light(type, p); });
    } else {
      return false;
    }
    return true;
  }

  void pop(bool transform_only) {
    if (stack_.empty()) return error(statement_, "this ends what has not begun");
    if (transform_only)
      state_.to_world = stack_.back().to_world;
    else
      state_ = stack_.back();
    stack_.pop_back();
  }

  void instance(const std::string& of) {
    const auto known = std::ranges::find(scene_.groups, "object-" + of, [](const auto& g) { return g.first; });
    if (known == scene_.groups.end())
      return error(statement_, fmt::format("there is no object named \"{}\" before this", of));
    if (!known->second.empty()) scene_.objects.push_back({known->first, state_.to_world});
  }

  std::string add_material(const std::string& name, const std::string& type, PbrtParameters& params) {
    if (!material_named(name)) scene_.materials.push_back({name, {}, materials_.material(type, params, statement_)});
    return name;
  }
  const Member* material_named(const std::string& name) const {
    const auto m = std::ranges::find(scene_.materials, name, &Member::key);
    return m == scene_.materials.end() ? nullptr : &*m;
  }

  void texture() {
    const std::string name = text();
    text();  // spectrum or float: expressions know
    with_parameters(
        [&](const std::string& type, PbrtParameters& p) { materials_.add_texture(name, type, p, statement_); });
  }

  void area_light(const std::string& type, PbrtParameters& params) {
    if (type != "diffuse") return diagnostics_.warning(statement_, fmt::format("the light \"{}\" was left out", type));
    state_.glow = materials_.color(params, "L").value_or(Vec3d(1)) * params.number("scale", 1);
    if (!params.boolean("twosided", false)) is_one_sided_ = true;
  }

  // ---- What is shown

  void shape(const std::string& type, PbrtParameters& params) {
    if (type == "sphere" && state_.glow && !is_in_object_ && glowing_sphere(params)) return;
    auto made = read_pbrt_shape(type, params, tokens_.folder(), state_.is_reversed, statement_, diagnostics_);
    if (!made) return;
    made->model.name = fmt::format("{}-{}", type, scene_.models.size() + 1);
    made->model.material = shown_material();
    if (state_.glow && is_one_sided_) {
      diagnostics_.warning(statement_, "a glowing surface glows on both sides here");
      is_one_sided_ = false;  // said once a light
    }
    const ForeignObject object{made->model.name, state_.to_world * made->to_object};
    (is_in_object_ ? scene_.groups.back().second : scene_.objects).push_back(object);
    scene_.models.push_back(std::move(made->model));
  }

  // The current material, and one that glows as well.
  std::string shown_material() {
    if (state_.material.empty()) {
      PbrtParameters none(diagnostics_);
      state_.material = add_material("default", "diffuse", none);
    }
    if (!state_.glow) return state_.material;
    const Vec3d glow = *state_.glow;
    const std::string name = fmt::format("{}-glowing-{}-{}-{}", state_.material, glow.x, glow.y, glow.z);
    if (!material_named(name)) {
      const Member* plain = material_named(state_.material);
      Value value = plain ? plain->value : json::object({{"type", json::text("openpbr")}});
      value.members.push_back({"emission_luminance", {}, json::number(1)});
      value.members.push_back({"emission_color", {}, json::text(fmt::format("[{}, {}, {}]", glow.x, glow.y, glow.z))});
      scene_.materials.push_back({name, {}, std::move(value)});
    }
    return name;
  }

  // A ball of light is better asked for light than a mesh.
  bool glowing_sphere(PbrtParameters& params) {
    const Affine3d& m = state_.to_world;
    const double size = length(m.x);
    if (std::abs(length(m.y) - size) > 1e-6 * size || std::abs(length(m.z) - size) > 1e-6 * size) return false;
    add_sphere_light(m.origin, params.number("radius", 1) * size, *state_.glow);
    return true;
  }

  void add_sphere_light(Vec3d center, double radius, Vec3d radiance) {
    lights_.push_back({center, radius,
                       json::object({{"type", json::text("sphere")},
                                     {"radius", json::number(radius)},
                                     {"color", tidy_vector(radiance)},
                                     {"intensity", json::number(1)}}),
                       true});
  }

  void light(const std::string& type, PbrtParameters& params) {
    const double scale = params.number("scale", 1);
    const Affine3d& m = state_.to_world;
    if (type == "infinite") {
      const Vec3d color = materials_.color(params, "L").value_or(Vec3d(1)) * scale;
      if (params.find("filename"))
        diagnostics_.warning(statement_, "the image of an infinite light was left out: it shines evenly");
      lights_.push_back(
          {{}, 0, json::object({{"type", json::text("constant")}, {"color", tidy_vector(color)}}), false});
    } else if (type == "distant") {
      Vec3d color = materials_.color(params, "L").value_or(Vec3d(1)) * scale;
      const Vec3d from = one_point(params, "from", {0, 0, 0}), to = one_point(params, "to", {0, 0, 1});
      if (const double wanted = params.number("illuminance", -1); wanted > 0)
        color = color * (wanted / std::max(dot(color, Vec3d{0.2126, 0.7152, 0.0722}), 1e-30));
      lights_.push_back(
          {m.vector(to - from), 0,
           json::object(
               {{"type", json::text("distant")}, {"irradiance", tidy_vector(color)}, {"angle", json::number(0)}}),
           false});
    } else if (type == "point") {
      const Vec3d intensity = materials_.color(params, "I").value_or(Vec3d(1)) * scale;
      const Vec3d at = m.point(one_point(params, "from", {0, 0, 0}));
      add_sphere_light(at, light_radius, intensity / (pi * light_radius * light_radius));
      diagnostics_.warning(statement_, fmt::format("a point became a glowing ball of radius {}", light_radius));
    } else {
      diagnostics_.warning(statement_, fmt::format("the light \"{}\" was left out", type));
    }
  }

  static Vec3d one_point(PbrtParameters& params, std::string_view name, Vec3d fallback) {
    const std::vector<Vec3d> points = params.points(name);
    return points.size() == 1 ? points[0] : fallback;
  }

  // ---- Camera and film

  void camera(const std::string& type, PbrtParameters& params) {
    named_["camera"] = state_.to_world.inverse();
    if (type != "perspective" && type != "orthographic")
      return diagnostics_.warning(statement_, fmt::format("the camera \"{}\" was left out", type));
    camera_to_world_ = named_["camera"];
    if (type == "orthographic") {
      camera_ = json::object({{"type", json::text("orthographic")}}).members;
      return;
    }
    fov_ = params.number("fov", 90);
    camera_ = json::object({{"type", json::text("pinhole")}}).members;
    if (const double radius = params.number("lensradius", 0); radius > 0) {
      camera_ = json::object({{"type", json::text("thin_lens")},
                              {"aperture_radius", json::number(radius)},
                              {"focus_distance", json::number(params.number("focaldistance", 1e6))}})
                    .members;
    }
  }

  void film(PbrtParameters& params) {
    width_ = std::clamp(params.integer("xresolution", 1280), 1, 65536);
    height_ = std::clamp(params.integer("yresolution", 720), 1, 65536);
    params.text("filename", "");
    params.number("diagonal", 35);
  }

  // pbrt's images show a left-handed world. Where that makes a mirror image of ours, the world is mirrored.
  void finish() {
    const Affine3d c = camera_to_world_;
    const bool mirrors = dot(c.x, cross(c.z, c.y)) < 0;
    const Affine3d mirror = mirrors ? Affine3d::scaling({1, 1, -1}) : Affine3d{};
    for (ForeignObject& object : scene_.objects) object.to_parent = mirror * object.to_parent;
    for (Light& light : lights_) {
      const bool is_distant = !light.has_center && light.at != Vec3d{};
      if (light.has_center) light.value.members.push_back({"center", {}, tidy_vector(mirror.point(light.at))});
      if (is_distant) light.value.members.push_back({"direction", {}, tidy_vector(mirror.vector(light.at))});
      scene_.lights.push_back(std::move(light.value));
    }
    if (!camera_.empty()) add_camera(mirror * c);
    scene_.render = json::object({{"size", json::array({json::number(width_), json::number(height_)})},
                                  {"samples", json::number(std::clamp(samples_, 1, 1 << 20))},
                                  {"max_depth", json::number(std::clamp(depth_, 0, 1024))}})
                        .members;
    std::erase_if(scene_.groups, [](const auto& group) { return group.second.empty(); });
  }

  void add_camera(const Affine3d& m) {
    camera_.push_back({"from", {}, tidy_vector(m.origin)});
    camera_.push_back({"to", {}, tidy_vector(m.origin + m.z)});
    camera_.push_back({"up", {}, tidy_vector(m.y)});
    // The angle, or the size, is that of the shorter side
    const double aspect = double(width_) / double(height_), higher = aspect >= 1 ? 1 : 1 / aspect;
    if (camera_[0].value.text == "orthographic") {
      camera_.push_back({"height", {}, tidy_number(std::clamp(2 * higher * length(m.y), 1e-9, 1e9))});
    } else {
      const double vertical = 360 / pi * std::atan(std::tan(fov_ * pi / 360) * higher);
      camera_.push_back({"fov", {}, tidy_number(std::clamp(vertical, 0.01, 170.0))});
    }
    Value value = json::object({});
    value.members = camera_;
    scene_.cameras.push_back({"camera", {}, std::move(value)});
  }

  // ---- Words

  // Reads the type and the parameters of a statement, and says which of them nobody asked for.
  template <class Read>
  void with_parameters(const Read& read) {
    const std::string type = text();
    PbrtParameters params(tokens_, diagnostics_);
    read(type, params);
    for (const PbrtParameter& p : params.list())
      if (!p.is_used) diagnostics_.warning(p.where, fmt::format("\"{}\" was left out", p.name));
  }

  void leave_out(const std::string& name) {
    static constexpr std::array known{"Option",          "Attribute",       "MediumInterface",
                                      "MakeNamedMedium", "ActiveTransform", "TransformTimes"};
    const bool is_known = std::ranges::find(known, name) != known.end();
    if (is_known)
      diagnostics_.warning(statement_, fmt::format("{} was left out", name));
    else
      error(statement_, fmt::format("\"{}\" is no statement of pbrt-v4 that is read here", name));
    while (tokens_.peek().kind == PbrtToken::Kind::Text || (is_known && is_value(tokens_.peek()))) tokens_.next();
  }
  static bool is_value(const PbrtToken& token) {
    if (token.kind == PbrtToken::Kind::Word)
      return token.text.find_first_not_of("0123456789.+-eE") == std::string_view::npos || token.text == "All" ||
             token.text == "StartTime" || token.text == "EndTime" || token.text == "true" || token.text == "false";
    return token.kind != PbrtToken::Kind::End;
  }

  std::string text() {
    if (tokens_.peek().kind == PbrtToken::Kind::Text) return std::string(tokens_.next().text);
    error(tokens_.peek().where.source ? tokens_.peek().where : statement_, "expected a name in quotes");
    return {};
  }

  double number() {
    const PbrtToken& token = tokens_.peek();
    double value = 0;
    const char* begin = token.text.data() + (token.text.starts_with('+') ? 1 : 0);
    const auto [next, code] = std::from_chars(begin, token.text.data() + token.text.size(), value);
    if (token.kind != PbrtToken::Kind::Word || code != std::errc{} || next != token.text.data() + token.text.size() ||
        !std::isfinite(value)) {
      error(token.where.source ? token.where : statement_, "expected a number");
      return 0;
    }
    tokens_.next();
    return value;
  }

  Vec3d vector() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }

  void error(const Location& where, std::string message) {
    ++errors_;
    diagnostics_.error(where, std::move(message));
  }

  struct Light {
    Vec3d at;  // its center, or where it goes
    double radius;
    Value value;
    bool has_center;
  };

  PbrtTokens tokens_;
  Diagnostics& diagnostics_;
  PbrtMaterials materials_;
  ForeignScene scene_;
  GraphicsState state_;
  std::vector<GraphicsState> stack_;
  std::map<std::string, Affine3d> named_;
  std::vector<Light> lights_;
  std::vector<Member> camera_;  // empty: none
  Affine3d camera_to_world_;
  Location statement_;
  std::string object_;
  bool is_in_object_ = false, is_one_sided_ = false;
  double fov_ = 90;
  int width_ = 1280, height_ = 720, samples_ = 16, depth_ = 5, materials_made_ = 0, errors_ = 0;
};

}  // namespace

ForeignScene read_pbrt(const std::string& path, AssetFolder& assets, Diagnostics& diagnostics) {
  ForeignScene scene = PbrtReader(path, assets, diagnostics).read();
  diagnostics.throw_if_errors();
  return scene;
}

}  // namespace meristem
