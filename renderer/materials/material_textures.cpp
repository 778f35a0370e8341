#include "renderer/materials/material_textures.h"

#include "renderer/image/image.h"
#include "renderer/scene/asset_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace meristem {
namespace {

constexpr const char* schema =
    R"({"type": "object", "maxProperties": 8, "additionalProperties": {"type": "object", "required": ["file"], )"
    R"("additionalProperties": false, "properties": {"file": {"type": "string"}, )"
    R"("u": {"type": ["string", "number"]}, "v": {"type": ["string", "number"]}, )"
    R"("wrap": {"enum": ["repeat", "clamp", "mirror", "black"]}, )"
    R"("color_space": {"enum": ["auto", "srgb", "linear"]}}}})";

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
      "\"v\": expression, \"wrap\": repeat, clamp, mirror or black, \"color_space\": auto, srgb or linear}}");
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

MaterialValues MaterialTextures::at(const ShadingPoint& point) const {
  MaterialValues v(point);
  for (const Entry& e : entries_) {
    const Vec2f uv{v.scalar(*e.u), v.scalar(*e.v)};
    v.values[std::size_t(v.count++)] = e.texture ? e.texture->at(uv) : Vec3f{};
  }
  return v;
}

}  // namespace meristem
