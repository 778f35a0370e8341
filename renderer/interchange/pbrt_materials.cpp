#include "renderer/interchange/pbrt_materials.h"

#include "renderer/interchange/blackbody.h"
#include "renderer/language/json_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace meristem {

namespace {

struct Metal {
  std::string_view name;
  Vec3d reflectance;  // face on, scene-linear Rec.709
};
// From the indices of refraction of the metals; by pbrt's names.
constexpr std::array metals{Metal{"metal-Ag", {0.972, 0.960, 0.915}},   Metal{"metal-Al", {0.913, 0.922, 0.924}},
                            Metal{"metal-Au", {1.0, 0.782, 0.344}},     Metal{"metal-Cu", {0.955, 0.638, 0.538}},
                            Metal{"metal-CuZn", {0.910, 0.778, 0.423}}, Metal{"metal-MgO", {0.072, 0.072, 0.073}},
                            Metal{"metal-TiO2", {0.216, 0.224, 0.249}}};

struct Glass {
  std::string_view name;
  double index;
};
constexpr std::array glasses{Glass{"glass-BK7", 1.5168},   Glass{"glass-BAF10", 1.6700}, Glass{"glass-FK51A", 1.4866},
                             Glass{"glass-LASF9", 1.8503}, Glass{"glass-F5", 1.6034},    Glass{"glass-F10", 1.6228},
                             Glass{"glass-F11", 1.6206},   Glass{"glass-SF11", 1.7847}};

std::string color_text(Vec3d c) {
  return c.x == c.y && c.y == c.z ? fmt::format("{}", c.x) : fmt::format("[{}, {}, {}]", c.x, c.y, c.z);
}

Value openpbr() { return json::object({{"type", json::text("openpbr")}}); }

void put(Value& object, const char* name, Value value) { object.members.push_back({name, {}, std::move(value)}); }

// A number or an expression.
Value expression_value(const std::string& text) {
  const bool is_number = text.find_first_not_of("0123456789.e-") == std::string::npos;
  return is_number ? json::number(std::stod(text)) : json::text(text);
}

}  // namespace

std::optional<Vec3d> PbrtMaterials::color(PbrtParameters& params, std::string_view name) {
  const PbrtParameter* p = params.find(name);
  if (!p) return std::nullopt;
  if (p->type == "blackbody" && !p->numbers.empty()) return blackbody_color(p->numbers[0]);
  if ((p->type == "rgb" || p->type == "color") && p->numbers.size() == 3)
    return Vec3d{p->numbers[0], p->numbers[1], p->numbers[2]};
  if (p->type == "float" && p->numbers.size() == 1) return Vec3d(p->numbers[0]);
  if (p->type == "spectrum" && p->numbers.size() >= 2 && p->numbers.size() % 2 == 0) {
    double sum = 0;  // pairs of wavelength and value: a mean, without colour
    for (std::size_t i = 1; i < p->numbers.size(); i += 2) sum += p->numbers[i];
    diagnostics_.warning(p->where, "a spectrum by wavelengths became grey");
    return Vec3d(2 * sum / double(p->numbers.size()));
  }
  if (p->type == "spectrum" && p->texts.size() == 1 && p->texts[0].starts_with("stdillum")) return Vec3d(1);
  diagnostics_.warning(p->where, fmt::format("\"{}\" was left out: {} {} is not understood", name, p->type, name));
  return std::nullopt;
}

PbrtMaterials::Pattern PbrtMaterials::referenced(const PbrtParameter& p, const std::string& fallback) {
  const std::string name = p.texts.empty() ? "" : p.texts[0];
  if (const auto known = textures_.find(name); known != textures_.end()) return known->second;
  diagnostics_.error(p.where, fmt::format("there is no texture named \"{}\" before this", name));
  return {fallback, {}};
}

PbrtMaterials::Pattern PbrtMaterials::spectrum(PbrtParameters& params, std::string_view name,
                                               const std::string& fallback, Value& material) {
  const PbrtParameter* p = params.find(name);
  if (!p) return {fallback, {}};
  if (p->type == "texture") {
    const Pattern pattern = referenced(*p, fallback);
    add_images(pattern, material);
    return pattern;
  }
  const std::optional<Vec3d> c = color(params, name);
  return {c ? color_text(*c) : fallback, {}};
}

PbrtMaterials::Pattern PbrtMaterials::scalar(PbrtParameters& params, std::string_view name, const std::string& fallback,
                                             Value& material) {
  const PbrtParameter* p = params.find(name);
  if (!p) return {fallback, {}};
  if (p->type != "texture") return {p->numbers.size() == 1 ? fmt::format("{}", p->numbers[0]) : fallback, {}};
  Pattern pattern = referenced(*p, fallback);
  add_images(pattern, material);
  if (!pattern.images.empty()) pattern.text = fmt::format("({})[0]", pattern.text);
  return pattern;
}

void PbrtMaterials::add_images(const Pattern& pattern, Value& material) const {
  if (pattern.images.empty()) return;
  if (!material.find("textures")) put(material, "textures", json::object({}));
  Value& textures = std::ranges::find(material.members, "textures", &Member::key)->value;
  for (const std::string& name : pattern.images)
    if (!textures.find(name)) textures.members.push_back({name, {}, images_.at(name)});
}

void PbrtMaterials::set(Value& material, const char* name, const Pattern& pattern) const {
  put(material, name, expression_value(pattern.text));
}

// ---- Textures

PbrtMaterials::Pattern PbrtMaterials::image(PbrtParameters& params, const Location& where) {
  const std::string file = params.text("filename", ""), wrap = params.text("wrap", "repeat");
  const std::string path = path_inside(folder_, file);
  const PbrtParameter* const named = params.find("filename");
  const Location& place = named ? named->where : where;
  if (path.empty()) diagnostics_.error(place, fmt::format("the image \"{}\" leaves the folder of the scene", file));
  const std::string copy = path.empty() ? "" : assets_.copy(path, place, diagnostics_);
  if (copy.empty()) return {"0.5", {}};
  const std::string mapping = params.text("mapping", "uv");
  if (mapping != "uv") diagnostics_.warning(where, fmt::format("the mapping \"{}\" became uv", mapping));
  const auto coordinate = [&](const char* axis, const char* scale, const char* offset) {
    const double s = params.number(scale, 1), o = params.number(offset, 0);
    return s == 1 && o == 0 ? std::string(axis) : fmt::format("{}*{} + {}", s, axis, o);
  };
  Value value = json::object({{"file", json::text(copy)},
                              {"u", json::text(coordinate("u", "uscale", "udelta"))},
                              {"v", json::text(coordinate("v", "vscale", "vdelta"))}});
  if (wrap == "black" || wrap == "clamp") put(value, "wrap", json::text(wrap));
  if (params.text("encoding", "sRGB") == "linear") put(value, "color_space", json::text("linear"));
  const std::string name = fmt::format("image{}", images_.size() + 1);
  images_[name] = std::move(value);
  std::string text = name;
  if (params.boolean("invert", false)) text = fmt::format("(1 - {})", text);
  if (const double scale = params.number("scale", 1); scale != 1) text = fmt::format("({}*{})", scale, text);
  return {text, {name}};
}

void PbrtMaterials::add_texture(const std::string& name, const std::string& type, PbrtParameters& params,
                                const Location& where) {
  Value images = json::object({});  // whatever the parts read, the whole does
  const auto part = [&](std::string_view parameter, const char* fallback) {
    return spectrum(params, parameter, fallback, images);
  };
  Pattern pattern;
  if (type == "constant") {
    pattern = part("value", "1");
  } else if (type == "imagemap") {
    pattern = image(params, where);
  } else if (type == "scale") {
    const Pattern a = part("tex", "1"), b = part("scale", "1");
    pattern = {fmt::format("({})*({})", a.text, b.text), {}};
  } else if (type == "mix") {
    const Pattern a = part("tex1", "0"), b = part("tex2", "1"), amount = part("amount", "0.5");
    pattern = {fmt::format("mix({}, {}, {})", a.text, b.text, amount.text), {}};
  } else if (type == "checkerboard") {
    const Pattern a = part("tex1", "1"), b = part("tex2", "0");
    pattern = {fmt::format("(floor({}*u) + floor({}*v)) % 2 == 0 ? ({}) : ({})", params.number("uscale", 1),
                           params.number("vscale", 1), a.text, b.text),
               {}};
  } else {
    diagnostics_.warning(where, fmt::format("the texture \"{}\" of type {} became grey", name, type));
    pattern = {"0.5", {}};
  }
  if (const Value* read = images.find("textures"))
    for (const Member& m : read->members) pattern.images.insert(m.key);
  textures_[name] = std::move(pattern);
}

// ---- Materials

// pbrt's roughness is remapped to alpha by its root, unless it says not to; here alpha is the square of the roughness.
void PbrtMaterials::set_roughness(Value& material, const char* name, PbrtParameters& params, std::string_view parameter,
                                  const std::string& fallback) {
  const std::string prefix(parameter.substr(0, parameter.rfind("roughness")));
  const bool remap = params.boolean("remaproughness", true);
  std::string_view chosen = parameter;
  const std::string u = prefix + "uroughness";
  if (!params.find(parameter) && params.find(u)) {
    chosen = u;
    params.find(prefix + "vroughness");
  }
  const Pattern p = scalar(params, chosen, fallback, material);
  const double power = remap ? 0.25 : 0.5;
  if (p.text.find_first_not_of("0123456789.e-") == std::string::npos)
    put(material, name, tidy_number(std::min(std::pow(std::stod(p.text), power), 1.0)));
  else
    put(material, name, json::text(fmt::format("pow({}, {})", p.text, power)));
}

double PbrtMaterials::index_of_refraction(PbrtParameters& params, std::string_view name, double fallback) {
  const PbrtParameter* p = params.find(name);
  if (!p) return fallback;
  if (p->numbers.size() == 1) return std::clamp(p->numbers[0], 1.0, 4.0);
  for (const Glass& g : glasses)
    if (!p->texts.empty() && p->texts[0] == g.name) return g.index;
  diagnostics_.warning(p->where, fmt::format("the index of refraction became {}", fallback));
  return fallback;
}

void PbrtMaterials::set_metal(Value& material, PbrtParameters& params, const std::string& prefix) {
  put(material, "base_metalness", json::number(1));
  if (params.find(prefix + "reflectance")) {
    set(material, "base_color", spectrum(params, prefix + "reflectance", "1", material));
    return;
  }
  const PbrtParameter* eta = params.find(prefix + "eta");
  const PbrtParameter* k = params.find(prefix + "k");
  Vec3d face_on = metals[3].reflectance;  // copper, as in pbrt
  if (eta && k && eta->numbers.size() == 3 && k->numbers.size() == 3) {
    for (int i = 0; i < 3; ++i) {
      const double n = eta->numbers[std::size_t(i)], kk = k->numbers[std::size_t(i)];
      face_on[i] = ((n - 1) * (n - 1) + kk * kk) / ((n + 1) * (n + 1) + kk * kk);
    }
  } else if (eta) {
    const std::string name = eta->texts.empty() ? "" : eta->texts[0].substr(0, eta->texts[0].rfind("-eta"));
    const auto metal = std::ranges::find(metals, name, &Metal::name);
    if (metal != metals.end())
      face_on = metal->reflectance;
    else
      diagnostics_.warning(eta->where, fmt::format("the metal \"{}\" became copper", name));
  }
  put(material, "base_color", json::text(color_text(face_on)));
}

Value PbrtMaterials::material(const std::string& type, PbrtParameters& params, const Location& where) {
  Value m = openpbr();
  if (type == "diffuse") {
    set(m, "base_color", spectrum(params, "reflectance", "0.5", m));
    put(m, "specular_weight", json::number(0));
  } else if (type == "coateddiffuse") {
    set(m, "base_color", spectrum(params, "reflectance", "0.5", m));
    set_roughness(m, "specular_roughness", params, "roughness", "0");
    put(m, "specular_ior", json::number(index_of_refraction(params, "eta", 1.5)));
  } else if (type == "conductor") {
    set_metal(m, params, "");
    set_roughness(m, "specular_roughness", params, "roughness", "0");
  } else if (type == "coatedconductor") {
    set_metal(m, params, params.find("reflectance") ? "" : "conductor.");
    set_roughness(m, "specular_roughness", params, "conductor.roughness", "0");
    put(m, "coat_weight", json::number(1));
    set_roughness(m, "coat_roughness", params, "interface.roughness", "0");
    put(m, "coat_ior", json::number(index_of_refraction(params, "interface.eta", 1.5)));
  } else if (type == "dielectric" || type == "thindielectric") {
    put(m, "transmission_weight", json::number(1));
    put(m, "specular_ior", json::number(index_of_refraction(params, "eta", 1.5)));
    if (type == "dielectric") set_roughness(m, "specular_roughness", params, "roughness", "0");
    if (type == "thindielectric") put(m, "specular_roughness", json::number(0));
    if (type == "thindielectric") put(m, "geometry_thin_walled", json::boolean(true));
  } else if (type == "diffusetransmission") {
    // Two colours here are one colour and the share that goes through
    const Pattern back = spectrum(params, "reflectance", "0.25", m);
    const Pattern through = spectrum(params, "transmittance", "0.25", m);
    const std::string sum = fmt::format("(({}) + ({}))", back.text, through.text);
    put(m, "specular_weight", json::number(0));
    put(m, "geometry_thin_walled", json::boolean(true));
    put(m, "subsurface_weight", json::number(1));
    put(m, "subsurface_color", json::text(fmt::format("{}*{}", params.number("scale", 1), sum)));
    put(m, "subsurface_scatter_anisotropy",
        json::text(fmt::format("2*length([1, 1, 1]*({}))/max(length([1, 1, 1]*{}), 1e-6) - 1", through.text, sum)));
  } else {
    if (type != "interface" && !type.empty())
      diagnostics_.warning(where, fmt::format("the material \"{}\" became grey", type));
    set(m, "base_color", spectrum(params, "reflectance", "0.5", m));
    put(m, "specular_weight", json::number(0));
  }
  return m;
}

}  // namespace meristem
