#include "renderer/materials/material_textures.h"

#include "renderer/image/image.h"
#include "renderer/scene/asset_path.h"
#include "renderer/scene/warps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>

namespace meristem {
namespace {

constexpr const char* schema =
    R"({"type": "object", "maxProperties": 8, "additionalProperties": {"type": "object", "required": ["file"], )"
    R"("additionalProperties": false, "properties": {"file": {"type": "string"}, )"
    R"("u": {"type": ["string", "number"]}, "v": {"type": ["string", "number"]}, )"
    R"("wrap": {"enum": ["repeat", "clamp", "mirror", "black"]}, )"
    R"("color_space": {"enum": ["auto", "srgb", "linear"]}, "filter": {"type": "number", "minimum": 0}}}})";

bool is_name(const std::string& text) {
  auto letter = [](unsigned char c) { return std::isalpha(c) || c == '_'; };
  return !text.empty() && letter(static_cast<unsigned char>(text[0])) &&
         std::ranges::all_of(text, [&](unsigned char c) { return letter(c) || std::isdigit(c); });
}

}  // namespace

MaterialTextures::MaterialTextures(Params& params) {
  const Value* textures = params.raw(
      "textures", false, schema,
      "image files by the names under which expressions read their colours: {name: {\"file\": ..., \"u\": expression, "
      "\"v\": expression, \"wrap\": repeat, clamp, mirror or black, \"color_space\": auto, srgb or linear, \"filter\": "
      "width in pixels}}");
  if (!textures) return;
  if (textures->kind != Value::Kind::Object || textures->members.size() > max_textures) {
    params.error("textures", fmt::format("\"textures\" is an object of at most {} textures", max_textures));
    return;
  }
  for (const Member& m : textures->members)
    if (!is_name(m.key) || symbols_.find(m.key) >= 0)
      params.diagnostics().error(m.key_location, fmt::format("\"{}\" cannot be the name of a texture", m.key));
    else
      add(m.key, m.value, params.diagnostics());
}

void MaterialTextures::add(const std::string& name, const Value& value, Diagnostics& diagnostics) {
  if (value.kind != Value::Kind::Object)
    return diagnostics.error(value.location, R"(a texture is {"file": name, ...})");
  Params params(value, fmt::format("texture \"{}\"", name), diagnostics);
  Entry entry;
  TextureOptions options;
  const std::string file = params.required_text("file", "image: EXR, PNG, JPEG, HDR or TIFF");
  entry.u = params.scalar_expression("u", "u", material_symbols(), "to the right; the image lies in [0, 1]");
  entry.v = params.scalar_expression("v", "v", material_symbols(), "up; the image lies in [0, 1]");
  options.wrap = TextureWrap(params.choice("wrap", 0, {"repeat", "clamp", "mirror", "black"}, "outside of [0, 1]"));
  options.encoding = TextureEncoding(
      params.choice("color_space", 0, {"auto", "srgb", "linear"}, "of the file; auto: linear for floats, else sRGB"));
  entry.filter = float(params.real("filter", 0.5, {0, 100, ""}, "width of a lookup in pixels; 0: a point"));
  params.finish();
  symbols_.add(name, ValueType::Vector, "colour of the texture");
  if (params.has("file"))
    if (const auto path = asset_path(params, "file", file)) try {
        entry.texture = open_texture(*path, options);
      } catch (const FileError& error) {
        params.error("file", error.what());
      }
  entries_.push_back(std::move(entry));
}

// The symbols at a point and at both ends of both axes of its footprint: an ellipse on the surface, as wide as the
// point's footprint and longer towards the eye as the surface is seen aslant.
class MaterialTextures::Neighbours {
 public:
  Neighbours(const ShadingPoint& point, const MaterialValues& here) {
    const Vec3f n = point.hit.geometric_normal, along = point.wo - n * dot(n, point.wo);
    Frame frame(n);
    if (length_squared(along) > 0) {
      frame.s = normalize(along);
      frame.t = cross(n, frame.s);
    }
    constexpr float least_cosine = 1e-3f;
    const float cosine = std::max(std::abs(dot(n, point.wo)), least_cosine);
    const Vec3f long_axis = frame.s * (point.footprint / cosine), short_axis = frame.t * point.footprint;
    const Vec3f steps[count] = {{}, long_axis, -long_axis, short_axis, -short_axis};
    for (std::size_t i = 0; i < count; ++i) {
      const Vec2f uv = uv_step(point.hit, steps[i]);
      const Vec3f position = point.hit.position + steps[i];
      u_[i] = point.hit.u + uv.x, v_[i] = point.hit.v + uv.y;
      x_[i] = position.x, y_[i] = position.y, z_[i] = position.z;
    }
    keys_.fill(here.key);
    for (std::size_t i = 0; i < inputs_.size(); ++i)
      inputs_[i] = {&here.values[i].x, &here.values[i].y, &here.values[i].z, 0};
    inputs_[0] = {u_, nullptr, nullptr, 1};
    inputs_[1] = {v_, nullptr, nullptr, 1};
    inputs_[2] = {x_, y_, z_, 1};
  }

  Vec3f look_up(const Entry& e) const {
    float u[count], v[count];
    const Block block{int(count), inputs_, keys_.data(), 0};
    e.u->evaluate(block, u, nullptr, nullptr);
    e.v->evaluate(block, v, nullptr, nullptr);
    // The smaller of the steps ahead and back: expressions may jump, where a pattern begins anew
    const auto step = [&](std::size_t ahead, std::size_t back) {
      const Vec2f a{u[ahead] - u[0], v[ahead] - v[0]}, b{u[0] - u[back], v[0] - v[back]};
      return (b.x * b.x + b.y * b.y < a.x * a.x + a.y * a.y ? b : a) * e.filter;
    };
    return e.texture->mean({u[0], v[0]}, {step(1, 2), step(3, 4)});
  }

 private:
  static constexpr std::size_t count = 5;
  float u_[count], v_[count], x_[count], y_[count], z_[count];
  std::array<Key, count> keys_;
  std::array<Input, material_symbol_count> inputs_;
};

MaterialValues MaterialTextures::at(const ShadingPoint& point) const {
  MaterialValues v(point);
  if (entries_.empty()) return v;
  std::optional<Neighbours> neighbours;
  for (const Entry& e : entries_) {
    Vec3f& value = v.values[std::size_t(v.count)];
    const bool is_wide = point.footprint > 0 && e.filter > 0;
    if (is_wide && !neighbours) neighbours.emplace(point, v);
    if (e.texture) value = is_wide ? neighbours->look_up(e) : e.texture->at({v.scalar(*e.u), v.scalar(*e.v)});
    ++v.count;
  }
  return v;
}

}  // namespace meristem
