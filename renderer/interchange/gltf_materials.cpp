#include "renderer/interchange/gltf_materials.h"

#include "renderer/language/json_value.h"

#include <fmt/format.h>

#include <algorithm>

namespace meristem {

namespace {

void put(Value& object, const char* name, Value value) { object.members.push_back({name, {}, std::move(value)}); }

// A color of three numbers, or the fallback.
Vec3d color_of(const Value* object, const char* name, Vec3d fallback) {
  const Value* v = object ? object->find(name) : nullptr;
  if (!v || v->items.size() < 3) return fallback;
  for (std::size_t i = 0; i < 3; ++i)
    if (v->items[i].kind == Value::Kind::Number) fallback[int(i)] = v->items[i].number;
  return fallback;
}

// A factor times a texture.
std::string product(const std::string& factor, const std::string& texture, bool is_one) {
  return texture.empty() ? factor : is_one ? texture : fmt::format("{}*{}", factor, texture);
}

std::string color_text(Vec3d c) { return fmt::format("[{}, {}, {}]", c.x, c.y, c.z); }

}  // namespace

std::string GltfMaterials::image_file(const Value& image) {
  if (const auto known = files_.find(&image); known != files_.end()) return known->second;
  std::string& file = files_[&image];
  if (const Value* uri = image.find("uri")) {
    const std::string path = uri->text.starts_with("data:") ? "" : path_inside(buffers_.folder(), uri->text);
    if (path.empty())
      diagnostics_.warning(uri->location, "an image that is no file in the folder was left out");
    else
      file = assets_.copy(path, uri->location, diagnostics_);
  } else {
    const std::string_view bytes = buffers_.view(image.find("bufferView"));
    const bool is_png = bytes.starts_with("\x89PNG");
    if (!is_png && !bytes.starts_with("\xff\xd8"))
      diagnostics_.warning(image.location, "an image that is neither PNG nor JPEG was left out");
    else
      file = assets_.write(fmt::format("image-{}.{}", files_.size(), is_png ? "png" : "jpg"), bytes);
  }
  return file;
}

std::string GltfMaterials::texture(const Value* info, const char* name, const char* color_space, Value& material) {
  if (!info) return {};
  const Value* texture = buffers_.item("textures", info->find("index"));
  const Value* image = texture ? buffers_.item("images", texture->find("source")) : nullptr;
  const std::string file = image ? image_file(*image) : "";
  if (file.empty()) {
    diagnostics_.warning(info->location, "a texture was left out");
    return {};
  }
  if (gltf_count(*info, "texCoord", 0) != 0)
    diagnostics_.warning(info->location, "a second set of texture coordinates became the first");
  if (const Value* extensions = info->find("extensions"))
    diagnostics_.warning(extensions->location, "the transform of a texture was left out");
  constexpr double clamp = 33071, mirror = 33648;  // of the specification
  const Value* sampler = buffers_.item("samplers", texture->find("sampler"));
  const double wrap = gltf_number(sampler, "wrapS", 0);
  if (!material.find("textures")) put(material, "textures", json::object({}));
  Value entry = json::object({{"file", json::text(file)}, {"color_space", json::text(color_space)}});
  if (wrap == clamp || wrap == mirror) put(entry, "wrap", json::text(wrap == clamp ? "clamp" : "mirror"));
  std::ranges::find(material.members, "textures", &Member::key)->value.members.push_back({name, {}, std::move(entry)});
  return name;
}

Value GltfMaterials::material(const Value& gltf) {
  Value m = json::object({{"type", json::text("openpbr")}});
  const Value* pbr = gltf.find("pbrMetallicRoughness");
  const auto extension = [&](const char* name) {
    const Value* all = gltf.find("extensions");
    return all ? all->find(name) : nullptr;
  };
  const auto info = [](const Value* object, const char* name) { return object ? object->find(name) : nullptr; };
  const Vec3d base = color_of(pbr, "baseColorFactor", Vec3d(1));
  put(m, "base_color",
      json::text(
          product(color_text(base), texture(info(pbr, "baseColorTexture"), "base", "srgb", m), base == Vec3d(1))));
  const double metal = gltf_number(pbr, "metallicFactor", 1), rough = gltf_number(pbr, "roughnessFactor", 1);
  const std::string both = texture(info(pbr, "metallicRoughnessTexture"), "metal_rough", "linear", m);
  put(m, "base_metalness", json::text(product(fmt::format("{}", metal), both.empty() ? "" : both + "[2]", metal == 1)));
  put(m, "specular_roughness",
      json::text(product(fmt::format("{}", rough), both.empty() ? "" : both + "[1]", rough == 1)));
  if (const Value* ior = extension("KHR_materials_ior"))
    put(m, "specular_ior", json::number(std::clamp(gltf_number(ior, "ior", 1.5), 1.0, 4.0)));
  if (const double glass = gltf_number(extension("KHR_materials_transmission"), "transmissionFactor", 0); glass > 0) {
    put(m, "transmission_weight", json::number(std::min(glass, 1.0)));
    put(m, "transmission_color", json::text(color_text(base)));
  }
  if (const double coat = gltf_number(extension("KHR_materials_clearcoat"), "clearcoatFactor", 0); coat > 0) {
    put(m, "coat_weight", json::number(std::min(coat, 1.0)));
    put(m, "coat_roughness",
        json::number(gltf_number(extension("KHR_materials_clearcoat"), "clearcoatRoughnessFactor", 0)));
  }
  const Vec3d glow = color_of(&gltf, "emissiveFactor", {});
  if (glow != Vec3d{}) {
    put(m, "emission_luminance",
        json::number(gltf_number(extension("KHR_materials_emissive_strength"), "emissiveStrength", 1)));
    put(m, "emission_color",
        json::text(
            product(color_text(glow), texture(info(&gltf, "emissiveTexture"), "glow", "srgb", m), glow == Vec3d(1))));
  }
  const Value* mode = gltf.find("alphaMode");
  const Value* factor = info(pbr, "baseColorFactor");
  if (mode && mode->text != "OPAQUE") {
    if (factor && factor->items.size() == 4) put(m, "geometry_opacity", json::number(factor->items[3].number));
    if (info(pbr, "baseColorTexture"))
      diagnostics_.warning(mode->location, "the opacity of the base colour's texture was left out");
  }
  for (const char* left_out : {"normalTexture", "occlusionTexture"})
    if (const Value* v = gltf.find(left_out))
      diagnostics_.warning(v->location, fmt::format("{} was left out", left_out));
  return m;
}

}  // namespace meristem
