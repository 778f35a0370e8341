// image: light from all sides as in a panoramic photograph (a lat-long EXR or HDR file), sampled by its brightness.
//
// The image's middle looks towards -z, its right quarter towards +x, its top row is up; `rotation` turns it around the
// vertical, counter-clockwise seen from above. `file` stands in the folder of the scene file or below it.
//
// What the camera sees of it, as a background, is its mean over a cone as wide as half a pixel, or `filter` pixels; all
// other rays look it up at a point, since they share their light with samples of its brightness
// (docs/decisions/light.md, "Image environments").
#include "renderer/image/image.h"
#include "renderer/lights/distribution_2d.h"
#include "renderer/lights/panorama.h"
#include "renderer/scene/asset_path.h"
#include "renderer/scene/interfaces.h"
#include "renderer/scene/warps.h"

namespace meristem {
namespace {

class ImageEnvironment : public Light {
 public:
  explicit ImageEnvironment(Params& params) {
    const std::string file = params.required_text("file", "lat-long image, EXR or HDR, scene-linear Rec.709");
    const Vec3d color = params.color("color", {1, 1, 1}, "multiplies the image");
    const double intensity = params.real("intensity", 1, not_negative, "scales the image");
    const double rotation = params.real("rotation", 0, {-360, 360, "deg"}, "turn around the vertical");
    filter_ = float(params.real("filter", 0.5, {0, 100, ""}, "width of the camera's lookups in pixels; 0: a point"));
    visible_ = params.boolean("visible", true, "whether the camera sees it, else nothing; mirrors do anyway");
    turn_ = float(rotation / 360);
    if (params.describing()) return;
    load(params, file, Spectrum(color * intensity));
    prepare_sampling();
  }

  LightSample sample(Vec3f, Vec2f random) const override {
    LightSample s;
    const Vec2f place = distribution_.sample(random);
    s.direction = to_direction(place);
    s.distance = std::numeric_limits<float>::infinity();
    const EscapedLight light = light_at(place, s.direction);
    s.radiance = light.radiance;
    s.pdf = light.pdf;
    return s;
  }

  EscapedLight escaped(Vec3f d) const override { return light_at(to_image(d), d); }
  Spectrum background(Vec3f d, float spread) const override { return image_.mean(to_image(d), filter_ * spread); }
  bool has_texture() const override { return filter_ > 0; }

  float environment_power() const override { return flux_; }
  bool seen_by_camera() const override { return visible_; }

 private:
  void load(Params& params, const std::string& file, Spectrum scale) {
    try {
      const auto path = asset_path(params, "file", file);
      if (!path) return;
      const Image image = read_image(*path);
      if (image.width < 1 || image.height < 1 || image.channels < 1) {
        params.error("file", "the image has no pixels");
        return;
      }
      std::vector<Spectrum> texels(std::size_t(image.width) * std::size_t(image.height));
      for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = color_of(image, i) * scale;
      image_ = Panorama(std::move(texels), image.width, image.height);
    } catch (const std::runtime_error& error) {
      params.error("file", error.what());
    }
  }

  // Negative and non-finite channels count as black.
  static Spectrum color_of(const Image& image, std::size_t pixel) {
    const float* p = image.pixels.data() + pixel * std::size_t(image.channels);
    const Spectrum c = image.channels >= 3 ? Spectrum{p[0], p[1], p[2]} : Spectrum(p[0]);
    auto clean = [](float x) { return std::isfinite(x) && x > 0 ? x : 0.f; };
    return {clean(c.x), clean(c.y), clean(c.z)};
  }

  // Each cell weighs as much as the brightest texel that its interpolation reads, so that no light is missed.
  void prepare_sampling() {
    const int width = image_.width(), height = image_.height();
    std::vector<float> weights;
    double flux = 0;
    for (int y = 0; y < height; ++y) {
      const float sine = std::sin(pi_f * (float(y) + 0.5f) / float(height));
      for (int x = 0; x < width; ++x) {
        float brightest = 0;
        for (int k = 0; k < 9; ++k)
          brightest = std::max(brightest, luminance(image_.texel(x + k % 3 - 1, y + k / 3 - 1)));
        weights.push_back(brightest * sine);
        flux += double(luminance(image_.texel(x, y)) * sine);
      }
    }
    flux_ = float(flux * 2 * pi * pi / (double(width) * height));
    distribution_ = Distribution2D(std::move(weights), width, height);
  }

  // Of a direction that is seen at this place of the image.
  EscapedLight light_at(Vec2f place, Vec3f d) const {
    const float sine = std::sqrt(std::max(0.f, 1 - d.y * d.y));
    return {image_.at(place), sine > 0 ? distribution_.pdf(place) / (2 * pi_f * pi_f * sine) : 0};
  }

  Vec2f to_image(Vec3f d) const {
    const float x = std::atan2(d.x, -d.z) / (2 * pi_f) + 0.5f + turn_;
    return {x - std::floor(x), std::acos(std::clamp(d.y, -1.f, 1.f)) / pi_f};
  }
  Vec3f to_direction(Vec2f p) const {
    const float angle = 2 * pi_f * (p.x - 0.5f - turn_), polar = pi_f * p.y;
    return {std::sin(polar) * std::sin(angle), std::cos(polar), -std::sin(polar) * std::cos(angle)};
  }

  Panorama image_;
  Distribution2D distribution_;
  float filter_ = 0;
  float turn_ = 0;  // rotation / 360 degrees
  bool visible_ = true;
  float flux_ = 0;  // luminance integrated over all directions
};

}  // namespace

void register_image_environment(LightRegistry& r) { r.add<ImageEnvironment>("image", "Light from a panoramic image"); }

}  // namespace meristem
