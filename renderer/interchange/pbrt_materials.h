// The textures and materials of a pbrt scene as expressions and openpbr materials.
#pragma once

#include "renderer/interchange/foreign_scene.h"
#include "renderer/interchange/pbrt_parameters.h"

#include <map>
#include <optional>
#include <set>
#include <string>

namespace meristem {

class PbrtMaterials {
 public:
  PbrtMaterials(const std::string& folder, AssetFolder& assets, Diagnostics& diagnostics)
      : folder_(folder), assets_(assets), diagnostics_(diagnostics) {}

  void add_texture(const std::string& name, const std::string& type, PbrtParameters& params, const Location& where);
  // An openpbr material as a scene file has it.
  Value material(const std::string& type, PbrtParameters& params, const Location& where);
  // "[r, g, b]" scene-linear of a spectrum that is no texture.
  std::optional<Vec3d> color(PbrtParameters& params, std::string_view name);

 private:
  // An expression, and the textures that it reads.
  struct Pattern {
    std::string text;
    std::set<std::string> images;
  };
  Pattern spectrum(PbrtParameters& params, std::string_view name, const std::string& fallback, Value& material);
  Pattern scalar(PbrtParameters& params, std::string_view name, const std::string& fallback, Value& material);
  Pattern referenced(const PbrtParameter& parameter, const std::string& fallback);
  Pattern image(PbrtParameters& params, const Location& where);
  void add_images(const Pattern& pattern, Value& material) const;
  void set(Value& material, const char* name, const Pattern& pattern) const;
  void set_roughness(Value& material, const char* name, PbrtParameters& params, std::string_view parameter,
                     const std::string& fallback);
  void set_metal(Value& material, PbrtParameters& params, const std::string& prefix);
  double index_of_refraction(PbrtParameters& params, std::string_view name, double fallback);

  const std::string& folder_;
  AssetFolder& assets_;
  Diagnostics& diagnostics_;
  std::map<std::string, Pattern> textures_;
  std::map<std::string, Value> images_;  // by the names that expressions know them by
};

}  // namespace meristem
