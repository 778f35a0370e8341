// openpbr: the standard surface: dielectrics over a diffuse base, metals, glass, coats, fuzz, and thin leaves that
// light shines through.
//
// OpenPBR Surface 1.1 (Academy Software Foundation 2024) under its parameter names; every one is an expression over the
// symbols of material_symbols.h and the material's textures. What differs:
//  - base_weight dims the diffuse base and the metal alike;
//  - subsurface is an approximation: without geometry_thin_walled a diffuse reflection of its colour, so light does not
//    travel below the surface;
//  - glass: no dispersion, no scattering inside (transmission_scatter); transmission_color without transmission_depth
//    tints each of the two crossings by its root; light samples do not see through it, so that what it throws on other
//    surfaces is found by bounces alone and small lights make it noisy;
//  - no coat_darkening, no anisotropic roughness, no thin film;
//  - emission is a radiance in scene units, emission_luminance * emission_color, not covered by coat or fuzz.
// Both sides of a surface look alike but for glass, whose inside is what the normal points away from.
//
// A leaf: geometry_thin_walled true, subsurface_weight towards 1, subsurface_color its colour;
// subsurface_scatter_anisotropy from -1 (reflects all) over 0 (half and half) to 1 (transmits all).
#include "renderer/materials/bsdf.h"
#include "renderer/materials/fuzz.h"
#include "renderer/materials/ggx.h"
#include "renderer/materials/material_textures.h"

namespace meristem {
namespace {

constexpr float any = 1e6f;

class OpenPbr : public Material {
 public:
  explicit OpenPbr(Params& p)
      : textures_(p),
        base_weight_(scalar(p, "base_weight", "1", 0, 1, "multiplies base_color")),
        base_color_(color(p, "base_color", "0.8", 1, "colour of the diffuse base; of metal, seen face on")),
        metalness_(scalar(p, "base_metalness", "0", 0, 1, "0: dielectric over a diffuse base; 1: metal")),
        diffuse_roughness_(
            scalar(p, "base_diffuse_roughness", "0", 0, 1, "0: Lambert; 1: flat, like dust or the moon")),
        specular_weight_(scalar(p, "specular_weight", "1", 0, any, "strength of the reflection; 0: none")),
        specular_color_(color(p, "specular_color", "1", 1, "tint of the reflection; of metal, near its edges")),
        specular_roughness_(scalar(p, "specular_roughness", "0.3", 0, 1, "0: mirror; 1: dull")),
        specular_ior_(scalar(p, "specular_ior", "1.5", 1, 4, "index of refraction of the dielectric")),
        transmission_weight_(scalar(p, "transmission_weight", "0", 0, 1, "how much of the dielectric's base is glass")),
        transmission_color_(color(p, "transmission_color", "1", 1, "colour of light that has crossed the glass")),
        transmission_depth_(
            scalar(p, "transmission_depth", "0", 0, any, "metres of glass that give that colour; 0: any")),
        subsurface_weight_(scalar(p, "subsurface_weight", "0", 0, 1, "how much of the diffuse base is subsurface")),
        subsurface_color_(color(p, "subsurface_color", "0.8", 1, "colour of the subsurface")),
        anisotropy_(scalar(p, "subsurface_scatter_anisotropy", "0", -1, 1, "of thin walls: -1 reflects, 1 transmits")),
        coat_weight_(scalar(p, "coat_weight", "0", 0, 1, "how much of the surface has a clear coat")),
        coat_color_(color(p, "coat_color", "1", 1, "tint of what is seen through the coat")),
        coat_roughness_(scalar(p, "coat_roughness", "0", 0, 1, "of the coat; 0: mirror")),
        coat_ior_(scalar(p, "coat_ior", "1.6", 1, 4, "index of refraction of the coat")),
        fuzz_weight_(scalar(p, "fuzz_weight", "0", 0, 1, "how much of the surface has fuzz: dust, velvet, peach skin")),
        fuzz_color_(color(p, "fuzz_color", "1", 1, "colour of the fuzz")),
        fuzz_roughness_(
            scalar(p, "fuzz_roughness", "0.5", fuzz::min_roughness, 1, "0: only the rim shines; 1: all around")),
        emission_luminance_(scalar(p, "emission_luminance", "0", 0, any, "radiance of its own light")),
        emission_color_(color(p, "emission_color", "1", any, "colour of its own light")),
        opacity_(scalar(p, "geometry_opacity", "1", 0, 1, "the part of the surface that is there")),
        bump_(scalar(p, "geometry_bump", "0", -any, any, "height of fine relief in metres, shaded only")),
        thin_walled_(p.boolean("geometry_thin_walled", false, "a sheet without inside, like a leaf")) {
    if (constant_) set_parameters(MaterialValues({}), same_everywhere_);
  }

  Bsdf evaluate(const ShadingPoint& point) const override {
    if (constant_) return Bsdf(same_everywhere_, point);
    const MaterialValues v = textures_.at(point);
    BsdfParameters parameters = same_everywhere_;
    set_parameters(v, parameters);
    if (bump_.is_constant()) return Bsdf(parameters, point);
    ShadingPoint bumped = point;
    bumped.hit.shading_normal = bumped_normal(point, bump_.at(v));
    return Bsdf(parameters, bumped);
  }

  bool is_uniform() const override { return constant_; }
  bool has_textures() const override { return !textures_.empty(); }
  bool reads_uv() const override { return reads_uv_ || has_textures(); }
  bool may_emit() const override { return !is_zero(emission_luminance_); }
  Spectrum emission(const ShadingPoint& point) const override {
    const MaterialValues v = textures_.at(point);
    return emission_color_.at(v) * (emission_luminance_.at(v) * opacity_.at(v));
  }

  bool may_be_transparent() const override { return !opacity_.is_constant() || opacity_.constant_value() < 1; }

 private:
  ScalarParameter scalar(Params& p, const char* name, const char* fallback, float lower, float upper, const char* doc) {
    ScalarParameter parameter(p, textures_.symbols(), name, fallback, lower, upper, doc);
    constant_ = constant_ && parameter.is_constant();
    reads_uv_ = reads_uv_ || parameter.reads_uv();
    return parameter;
  }
  ColorParameter color(Params& p, const char* name, const char* fallback, float upper, const char* doc) {
    ColorParameter parameter(p, textures_.symbols(), name, fallback, upper, doc);
    constant_ = constant_ && parameter.is_constant();
    reads_uv_ = reads_uv_ || parameter.reads_uv();
    return parameter;
  }

  // The normal of the surface raised by the bump: Blinn 1978, by differences over a step that is small in the picture.
  Vec3f bumped_normal(const ShadingPoint& point, float height) const {
    constexpr float part_of_distance = 5e-4f;
    const Frame frame(point.hit.shading_normal);
    const float step = std::max(part_of_distance * point.hit.t, 16 * max_component(point.hit.position_error));
    auto slope = [&](Vec3f tangent) { return (bump_.at(textures_.at(moved(point, tangent * step))) - height) / step; };
    const Vec3f normal = normalize(frame.n - frame.s * slope(frame.s) - frame.t * slope(frame.t));
    return is_finite(normal) ? normal : frame.n;
  }

  // The point beside a hit, on the tangent plane, with the texture coordinates that it has there.
  static ShadingPoint moved(const ShadingPoint& point, Vec3f by) {
    ShadingPoint other = point;
    const Vec2f step = uv_step(point.hit, by);
    other.hit.position += by;
    other.hit.u += step.x;
    other.hit.v += step.y;
    return other;
  }

  void set_parameters(const MaterialValues& v, BsdfParameters& bsdf) const {
    bsdf.opacity = opacity_.at(v);
    bsdf.emission = emission_color_.at(v) * emission_luminance_.at(v);
    bsdf.metalness = metalness_.at(v);
    set_specular(v, bsdf);
    set_base(v, bsdf);
    if (!is_zero(transmission_weight_)) set_glass(v, bsdf);
    if (!is_zero(fuzz_weight_)) set_fuzz(v, bsdf);
    if (!is_zero(coat_weight_)) set_coat(v, bsdf);
  }

  void set_specular(const MaterialValues& v, BsdfParameters& bsdf) const {
    const float weight = specular_weight_.at(v), roughness = specular_roughness_.at(v);
    const Spectrum tint = specular_color_.at(v);
    bsdf.alpha = std::max(roughness * roughness, ggx::min_alpha);
    // specular_weight scales the reflectance face on; the index of refraction follows (OpenPBR, "Dielectric base")
    bsdf.f0 = std::min(weight * ggx::f0_of(specular_ior_.at(v)), ggx::max_f0);
    bsdf.dielectric_tint = tint;
    bsdf.metal_f82 = tint;
    bsdf.metal_weight = std::min(weight, 1.f);
  }

  void set_base(const MaterialValues& v, BsdfParameters& bsdf) const {
    const Spectrum base = base_color_.at(v) * base_weight_.at(v);
    bsdf.metal_f0 = base;
    bsdf.diffuse_roughness = diffuse_roughness_.at(v);
    const float weight = subsurface_weight_.at(v);
    const Spectrum subsurface = weight > 0 ? subsurface_color_.at(v) * weight : Spectrum{};
    const float through = thin_walled_ ? 0.5f * (1 + anisotropy_.at(v)) : 0;
    bsdf.diffuse = base * (1 - weight) + subsurface * (1 - through);
    bsdf.transmitted = subsurface * through;
  }

  // Colour by a depth is Beer's law; without one it tints each of the two crossings by its root.
  void set_glass(const MaterialValues& v, BsdfParameters& bsdf) const {
    bsdf.glass = transmission_weight_.at(v);
    bsdf.thin_walled = thin_walled_;
    const Spectrum color = transmission_color_.at(v);
    const float depth = transmission_depth_.at(v);
    if (thin_walled_ || depth == 0) {
      for (int k = 0; k < 3; ++k) bsdf.glass_tint[k] = thin_walled_ ? color[k] : std::sqrt(color[k]);
    } else {
      for (int k = 0; k < 3; ++k) bsdf.absorption[k] = -std::log(std::max(color[k], 1e-6f)) / depth;
    }
  }

  void set_fuzz(const MaterialValues& v, BsdfParameters& bsdf) const {
    bsdf.fuzz = fuzz_weight_.at(v);
    bsdf.fuzz_color = fuzz_color_.at(v);
    bsdf.fuzz_roughness = fuzz_roughness_.at(v);
  }

  // The coat also roughens what lies below it, and takes the place of air before it (OpenPBR, "Coat").
  void set_coat(const MaterialValues& v, BsdfParameters& bsdf) const {
    const float weight = coat_weight_.at(v), roughness = coat_roughness_.at(v), ior = coat_ior_.at(v);
    bsdf.coat = weight;
    bsdf.coat_tint = coat_color_.at(v);
    bsdf.coat_alpha = std::max(roughness * roughness, ggx::min_alpha);
    bsdf.coat_f0 = ggx::f0_of(ior);
    const float alpha = std::sqrt(std::min(1.f, bsdf.alpha * bsdf.alpha + 2 * bsdf.coat_alpha * bsdf.coat_alpha));
    bsdf.alpha += weight * (alpha - bsdf.alpha);
    const float relative = ggx::eta_of(bsdf.f0) / (1 + weight * (ior - 1));
    bsdf.f0 = std::min(ggx::f0_of(std::max(relative, 1 / relative)), ggx::max_f0);
  }

  static bool is_zero(const ScalarParameter& p) { return p.is_constant() && p.constant_value() == 0; }

  MaterialTextures textures_;
  bool reads_uv_ = false;
  bool constant_ = true;            // no parameter depends on the hit; then all hits have
  BsdfParameters same_everywhere_;  // these
  ScalarParameter base_weight_;
  ColorParameter base_color_;
  ScalarParameter metalness_, diffuse_roughness_;
  ScalarParameter specular_weight_;
  ColorParameter specular_color_;
  ScalarParameter specular_roughness_, specular_ior_;
  ScalarParameter transmission_weight_;
  ColorParameter transmission_color_;
  ScalarParameter transmission_depth_;
  ScalarParameter subsurface_weight_;
  ColorParameter subsurface_color_;
  ScalarParameter anisotropy_;
  ScalarParameter coat_weight_;
  ColorParameter coat_color_;
  ScalarParameter coat_roughness_, coat_ior_;
  ScalarParameter fuzz_weight_;
  ColorParameter fuzz_color_;
  ScalarParameter fuzz_roughness_;
  ScalarParameter emission_luminance_;
  ColorParameter emission_color_;
  ScalarParameter opacity_;
  ScalarParameter bump_;
  bool thin_walled_;
};

}  // namespace

void register_openpbr(MaterialRegistry& r) { r.add<OpenPbr>("openpbr", "The standard surface: base, metal, leaf"); }

}  // namespace meristem
