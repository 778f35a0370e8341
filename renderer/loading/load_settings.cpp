#include "renderer/loading/load_settings.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>

namespace meristem {

namespace {

constexpr int largest_side = 65536;

void read_size(Params& params, RenderSettings& settings) {
  const Value* size = params.raw("size", false,
                                 R"({"type": "array", "items": {"type": "integer", "minimum": 1, "maximum": 65536}, )"
                                 R"("minItems": 2, "maxItems": 2, "default": [1280, 720]})",
                                 "width and height of the image in pixels");
  if (!size) return;
  auto is_side = [](const Value& v) {
    return v.kind == Value::Kind::Number && v.number >= 1 && v.number <= largest_side &&
           v.number == std::floor(v.number);
  };
  if (size->kind != Value::Kind::Array || size->items.size() != 2 || !is_side(size->items[0]) ||
      !is_side(size->items[1]))
    return params.error("size", "\"size\" is [width, height] in whole pixels from 1 to 65536");
  settings.width = int(size->items[0].number);
  settings.height = int(size->items[1].number);
}

// What a suffix multiplies by: "", "K", "KB", "KiB", ... in either case; 0 if it is none.
double unit_factor(std::string_view suffix) {
  if (suffix.empty()) return 1;
  constexpr std::string_view units = "kmgt";
  const std::size_t power = units.find(char(std::tolower(static_cast<unsigned char>(suffix[0]))));
  const std::string_view rest = suffix.substr(1);
  if (power == units.npos || !(rest.empty() || rest == "B" || rest == "iB")) return 0;
  return std::exp2(10.0 * double(power + 1));
}

void read_bytes(Params& params, const char* name, const char* fallback, const char* doc, std::uint64_t& result) {
  const auto bytes = parse_bytes(params.text(name, fallback, doc));
  if (!bytes) return params.error(name, fmt::format("\"{}\" is a number of bytes such as \"512M\" or \"2G\"", name));
  result = *bytes;
}

// "aovs": a list of names, or "all".
void read_aovs(Params& params, RenderSettings& settings) {
  const Value* aovs = params.raw("aovs", false, R"({"type": "array", "items": {"type": "string"}, "default": []})",
                                 "what EXR files hold beside the picture, such as [\"albedo\", \"normal\", \"Z\"]");
  if (!aovs) return;
  if (aovs->kind != Value::Kind::Array) return params.error("aovs", "\"aovs\" is a list of names");
  std::string list;
  for (const Value& name : aovs->items) {
    if (name.kind != Value::Kind::Text || name.text.find(',') != std::string::npos) {
      params.diagnostics().error(name.location, "\"aovs\" is a list of names");
      continue;
    }
    try {
      parse_aovs(name.text);
      list += (list.empty() ? "" : ",") + name.text;
    } catch (const std::invalid_argument& error) {
      params.diagnostics().error(name.location, error.what());
    }
  }
  if (!list.empty()) settings.aovs = parse_aovs(list);
}

// Of what scattered and shadow rays meet. Absent: as the camera.
void read_ray_class_detail(Params& params, RenderSettings& settings) {
  const Value* section = params.raw(
      "ray_class_detail", false,
      R"({"type": "object", "additionalProperties": false, "properties": )"
      R"({"diffuse": {"type": "number", "minimum": 0.01, "maximum": 1024}, )"
      R"("shadow": {"type": "number", "minimum": 0.01, "maximum": 1024}}})",
      "\"detail\" of what \"diffuse\" rays (scattered widely) and \"shadow\" rays meet, where it is not the camera's");
  if (!section) return;
  if (section->kind != Value::Kind::Object)
    return params.error("ray_class_detail", R"("ray_class_detail" is an object such as { "diffuse": 4, "shadow": 4 })");
  Params classes(*section, "ray_class_detail", params.diagnostics());
  const auto read = [&](const char* name, const char* doc, double& detail) {
    const double given = classes.real(name, settings.detail, {0.01, 1024, "px"}, doc);
    if (section->find(name)) detail = given;
  };
  read("diffuse", "for rays that are scattered widely", settings.diffuse_detail);
  read("shadow", "for rays towards lights", settings.shadow_detail);
  classes.finish();
}

}  // namespace

std::optional<std::uint64_t> parse_bytes(const std::string& text) {
  double number = 0;
  const auto [after, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const double bytes = number * unit_factor(std::string_view(after, std::size_t(text.data() + text.size() - after)));
  if (error != std::errc() || !(bytes >= 1 && bytes < 0x1p60)) return std::nullopt;
  return std::uint64_t(bytes);
}

RenderSection read_render(Params& params) {
  RenderSection section;
  RenderSettings& s = section.settings;
  read_size(params, s);
  s.samples = params.integer("samples", s.samples, {1, 1 << 20, ""}, "camera paths for each pixel");
  s.max_depth = params.integer("max_depth", s.max_depth, {0, 1024, ""},
                               "bounces of a path at most; 0: emission only, 1: direct light");
  s.detail = params.real("detail", s.detail, {0, 1024, "px"},
                         "wanted size of faces: finer levels are left out; 0: none is, however small");
  s.fade = params.boolean("fade", false,
                          "the finest level of each place fades in as it comes nearer, for cameras that move");
  read_ray_class_detail(params, s);
  s.seed = std::uint64_t(
      params.integer("seed", 0, {0, 2147483647, ""}, "another seed gives other noise, not another scene"));
  s.noise = params.real("noise", 0, {0, 1, ""}, "pixels whose noise is below it take no more samples; 0: all take all");
  s.shutter = params.real("shutter", 0, {0, 1, "frames"},
                          "how long it is open, from the frame's time on; 0: nothing is blurred, 0.5: as in film");
  s.shutter_moments = params.integer("shutter_moments", s.shutter_moments, {1, 256, ""},
                                     "models whose expressions name time are built for so many moments of the shutter");
  read_aovs(params, s);
  read_bytes(params, "budget", "2G", "memory for expanded geometry, such as 512M or 2G", s.budget_bytes);
  s.ray_order =
      RayOrder(params.choice("ray_order", int(s.ray_order), {"depth-first", "queued", "auto"},
                             "each path at once, or many that wait for the same cells; the image is the same"));
  read_bytes(params, "queue_memory", "128M", "memory of rays that wait, beside \"budget\"", s.queue_bytes);
  section.integrator =
      params.raw("integrator", false, R"({"$ref": "#/definitions/integrator"})", "how light is gathered");
  section.sampler = params.raw("sampler", false, R"({"$ref": "#/definitions/sampler"})", "where samples lie");
  section.filter =
      params.raw("filter", false, R"({"$ref": "#/definitions/filter"})", "reconstruction filter of the film");
  return section;
}

}  // namespace meristem
