// openpbr: the standard surface: dielectrics over a diffuse base, metals, and thin leaves that light shines through.
//
// The part of OpenPBR Surface 1.1 (Academy Software Foundation 2024) that plants and rooms need, under its parameter
// names; every one is an expression over the symbols of material_symbols.h. What differs: base_weight dims the diffuse
// base and the metal alike; without geometry_thin_walled the subsurface is a diffuse reflection of its colour; emission
// is a radiance in scene units, emission_luminance * emission_color, not covered by a coat. Both sides of a surface
// look alike.
//
// A leaf: geometry_thin_walled true, subsurface_weight towards 1, subsurface_color its colour;
// subsurface_scatter_anisotropy from -1 (reflects all) over 0 (half and half) to 1 (transmits all).
#include "renderer/materials/bsdf.h"
#include "renderer/materials/ggx.h"
#include "renderer/materials/ggx_albedo.h"
#include "renderer/materials/material_symbols.h"

namespace meristem {
namespace {

constexpr float any = 1e6f;

class OpenPbr : public Material {
 public:
  explicit OpenPbr(Params& p)
      : base_weight_(p, "base_weight", "1", 0, 1, "multiplies base_color"),
        base_color_(p, "base_color", "0.8", 1, "colour of the diffuse base; of metal, seen face on"),
        metalness_(p, "base_metalness", "0", 0, 1, "0: dielectric over a diffuse base; 1: metal"),
        diffuse_roughness_(p, "base_diffuse_roughness", "0", 0, 1, "0: Lambert; 1: flat, like dust or the moon"),
        specular_weight_(p, "specular_weight", "1", 0, any, "strength of the reflection; 0: none"),
        specular_color_(p, "specular_color", "1", 1, "tint of the reflection; of metal, near its edges"),
        specular_roughness_(p, "specular_roughness", "0.3", 0, 1, "0: mirror; 1: dull"),
        specular_ior_(p, "specular_ior", "1.5", 1, 4, "index of refraction of the dielectric"),
        subsurface_weight_(p, "subsurface_weight", "0", 0, 1, "how much of the diffuse base is subsurface"),
        subsurface_color_(p, "subsurface_color", "0.8", 1, "colour of the subsurface"),
        anisotropy_(p, "subsurface_scatter_anisotropy", "0", -1, 1, "of thin walls: -1 reflects, 1 transmits"),
        emission_luminance_(p, "emission_luminance", "0", 0, any, "radiance of its own light"),
        emission_color_(p, "emission_color", "1", any, "colour of its own light"),
        opacity_(p, "geometry_opacity", "1", 0, 1, "the part of the surface that is there"),
        thin_walled_(p.boolean("geometry_thin_walled", false, "a sheet without inside, like a leaf")) {}

  void prepare() override { ggx::white_mean_albedo(1); }  // makes the tables

  void evaluate(const ShadingPoint& point, Bsdf& bsdf) const override {
    const MaterialValues v(point);
    bsdf = Bsdf{};
    bsdf.set_frame(point);
    bsdf.opacity = opacity_.at(v);
    bsdf.emission = emission_color_.at(v) * emission_luminance_.at(v);
    bsdf.metalness = metalness_.at(v);
    set_specular(v, bsdf);
    set_base(v, bsdf);
  }

  bool may_be_transparent() const override { return !opacity_.is_constant() || opacity_.at(MaterialValues({})) < 1; }

 private:
  void set_specular(const MaterialValues& v, Bsdf& bsdf) const {
    const float weight = specular_weight_.at(v), roughness = specular_roughness_.at(v);
    const Spectrum tint = specular_color_.at(v);
    bsdf.alpha = std::max(roughness * roughness, ggx::min_alpha);
    // specular_weight scales the reflectance face on; the index of refraction follows (OpenPBR, "Dielectric base")
    bsdf.f0 = std::min(weight * ggx::f0_of(specular_ior_.at(v)), ggx::max_f0);
    bsdf.dielectric_tint = tint;
    bsdf.metal_f82 = tint;
    bsdf.metal_weight = std::min(weight, 1.f);
  }

  void set_base(const MaterialValues& v, Bsdf& bsdf) const {
    const Spectrum base = base_color_.at(v) * base_weight_.at(v);
    bsdf.metal_f0 = base;
    bsdf.diffuse_roughness = diffuse_roughness_.at(v);
    const float weight = subsurface_weight_.at(v);
    const Spectrum subsurface = weight > 0 ? subsurface_color_.at(v) * weight : Spectrum{};
    const float through = thin_walled_ ? 0.5f * (1 + anisotropy_.at(v)) : 0;
    bsdf.diffuse = base * (1 - weight) + subsurface * (1 - through);
    bsdf.transmitted = subsurface * through;
  }

  ScalarParameter base_weight_;
  ColorParameter base_color_;
  ScalarParameter metalness_, diffuse_roughness_;
  ScalarParameter specular_weight_;
  ColorParameter specular_color_;
  ScalarParameter specular_roughness_, specular_ior_;
  ScalarParameter subsurface_weight_;
  ColorParameter subsurface_color_;
  ScalarParameter anisotropy_;
  ScalarParameter emission_luminance_;
  ColorParameter emission_color_;
  ScalarParameter opacity_;
  bool thin_walled_;
};

}  // namespace

void register_openpbr(MaterialRegistry& r) { r.add<OpenPbr>("openpbr", "The standard surface: base, metal, leaf"); }

}  // namespace meristem
