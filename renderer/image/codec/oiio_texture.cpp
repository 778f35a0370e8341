#include "renderer/image/codec/oiio_texture.h"

#include "renderer/image/atomic_file.h"

#include <OpenImageIO/texture.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace meristem {
namespace {

// One for all textures, so that one limit holds for all; never destroyed, since threads may end after it.
OIIO::TextureSystem& texture_system() {
  static OIIO::TextureSystem* const system = [] {
    OIIO::TextureSystem* const s = OIIO::TextureSystem::create(false);
    s->attribute("max_memory_MB", 512.0f);
    s->attribute("autotile", 64);
    s->attribute("automip", 0);
    return s;
  }();
  return *system;
}

OIIO::TextureOpt::Wrap wrap_of(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::Repeat: return OIIO::TextureOpt::WrapPeriodic;
    case TextureWrap::Clamp: return OIIO::TextureOpt::WrapClamp;
    case TextureWrap::Mirror: return OIIO::TextureOpt::WrapMirror;
    case TextureWrap::Black: return OIIO::TextureOpt::WrapBlack;
  }
  return OIIO::TextureOpt::WrapPeriodic;
}

// IEC 61966-2-1, section 5.2.
float decoded(float x) { return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f); }

class OiioTexture final : public Texture {
 public:
  OiioTexture(const std::string& path, const TextureOptions& options)
      : handle_(texture_system().get_texture_handle(OIIO::ustring(path))), wrap_(wrap_of(options.wrap)) {
    OIIO::ImageSpec spec;
    if (!handle_ || !texture_system().good(handle_) || !texture_system().get_imagespec(OIIO::ustring(path), 0, spec))
      throw FileError(fmt::format("cannot read {}: {}", path, texture_system().geterror()));
    width_ = float(spec.width);
    height_ = float(spec.height);
    channels_ = std::min(spec.nchannels, 3);
    encoded_ = options.encoding == TextureEncoding::Srgb ||
               (options.encoding == TextureEncoding::Auto && !spec.format.is_floating_point());
  }

  Vec3f at(Vec2f uv) const override {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return {};
    const float x = uv.x * width_ - 0.5f, y = (1 - uv.y) * height_ - 0.5f;  // texels, from the top left
    const float x0 = std::floor(x), y0 = std::floor(y), tx = x - x0, ty = y - y0;
    const Vec3f top = lerp(texel(x0, y0), texel(x0 + 1, y0), tx);
    return lerp(top, lerp(texel(x0, y0 + 1), texel(x0 + 1, y0 + 1), tx), ty);
  }

 private:
  Vec3f texel(float x, float y) const {
    OIIO::TextureOpt options;
    options.swrap = options.twrap = wrap_;
    options.interpmode = OIIO::TextureOpt::InterpClosest;
    options.mipmode = OIIO::TextureOpt::MipModeNoMIP;
    std::array<float, 3> c{};
    OIIO::TextureSystem& system = texture_system();
    const bool good = system.texture(handle_, system.get_perthread_info(), options, (x + 0.5f) / width_,
                                     (y + 0.5f) / height_, 0, 0, 0, 0, channels_, c.data());
    if (!good) {
      system.geterror();  // or messages pile up
      return {};
    }
    if (channels_ < 3) c[1] = c[2] = c[0];
    if (encoded_) std::ranges::transform(c, c.begin(), decoded);
    return {c[0], c[1], c[2]};
  }

  OIIO::TextureSystem::TextureHandle* handle_;
  OIIO::TextureOpt::Wrap wrap_;
  float width_ = 1, height_ = 1;
  int channels_ = 3;
  bool encoded_ = false;
};

}  // namespace

std::unique_ptr<const Texture> make_oiio_texture(const std::string& path, const TextureOptions& options) {
  return std::make_unique<OiioTexture>(path, options);
}

}  // namespace meristem
