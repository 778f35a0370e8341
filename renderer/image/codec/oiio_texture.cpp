#include "renderer/image/codec/oiio_texture.h"

#include "renderer/image/atomic_file.h"
#include "renderer/image/codec/decoded_input.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>

namespace meristem {
namespace {

// One for all textures, so that one limit holds for all; never destroyed, since threads may end after it.
OIIO::TextureSystem& texture_system() {
  static OIIO::TextureSystem* const system = [] {
    OIIO::TextureSystem* const s = OIIO::TextureSystem::create(false);
    s->attribute("max_memory_MB", 512.0f);
    s->attribute("autotile", 64);
    s->attribute("automip", 1);
    s->imagecache()->attribute("unassociatedalpha", 1);
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

// Makes a file known under a name by which its texels are read decoded.
OIIO::ustring decoded_name(const std::string& path) {
  const OIIO::ustring name(DecodedInput::prefix + path);
  texture_system().imagecache()->add_file(name, [] { return static_cast<OIIO::ImageInput*>(new DecodedInput); });
  return name;
}

bool is_encoded(const std::string& path, TextureEncoding encoding) {
  OIIO::ImageSpec spec;
  if (encoding != TextureEncoding::Auto) return encoding == TextureEncoding::Srgb;
  return texture_system().get_imagespec(OIIO::ustring(path), 0, spec) && !spec.format.is_floating_point();
}

// What kept a file from being read, by its path; the first reason stays. Any thread.
class TextureFaults {
 public:
  void note(const std::string& path, std::string reason) {
    const std::lock_guard lock(mutex_);
    reasons_.emplace(path, std::move(reason));
  }
  std::vector<std::string> list() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> messages;
    for (const auto& [path, reason] : reasons_)
      messages.push_back(fmt::format("texture {} cannot be read in full, and is black there: {}", path, reason));
    return messages;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::string> reasons_;
};

TextureFaults& noted_faults() {
  static auto* const faults = new TextureFaults;  // never destroyed, as the texture system
  return *faults;
}

// Longer footprints are looked up as if they were wider: the error of a plane to the horizon is that of 16.
constexpr int most_aspect = 8;

class OiioTexture final : public Texture {
 public:
  OiioTexture(const std::string& path, const TextureOptions& options) : path_(path), wrap_(wrap_of(options.wrap)) {
    OIIO::TextureSystem& system = texture_system();
    const OIIO::ustring name = is_encoded(path, options.encoding) ? decoded_name(path) : OIIO::ustring(path);
    handle_ = system.get_texture_handle(name);
    OIIO::ImageSpec spec;
    if (!handle_ || !system.good(handle_) || !system.get_imagespec(name, 0, spec))
      throw FileError(fmt::format("cannot read {}: {}", path, system.geterror()));
    channels_ = std::min(spec.nchannels, 3);
  }

  Vec3f mean(Vec2f uv, const TextureFootprint& f) const override {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return {};
    const bool is_finite = std::isfinite(f.side_a.x + f.side_a.y + f.side_b.x + f.side_b.y);
    const bool is_point = !is_finite || (f.side_a == Vec2f{} && f.side_b == Vec2f{});
    const Vec2f a = is_point ? Vec2f{} : f.side_a, b = is_point ? Vec2f{} : f.side_b;
    OIIO::TextureOpt options;
    options.swrap = options.twrap = wrap_;
    options.interpmode = OIIO::TextureOpt::InterpBilinear;
    options.mipmode = is_point ? OIIO::TextureOpt::MipModeNoMIP : OIIO::TextureOpt::MipModeAniso;
    options.anisotropic = most_aspect;
    std::array<float, 3> c{};
    OIIO::TextureSystem& system = texture_system();
    const bool good = system.texture(handle_, system.get_perthread_info(), options, uv.x, 1 - uv.y, a.x, -a.y, b.x,
                                     -b.y, channels_, c.data());
    if (!good) {
      const std::string reasons = system.geterror();  // asked for every time, or they pile up
      if (!is_faulty_.exchange(true, std::memory_order_relaxed))
        noted_faults().note(path_, reasons.substr(0, reasons.find('\n')));
      return {};
    }
    if (channels_ < 3) c[1] = c[2] = c[0];
    return {c[0], c[1], c[2]};
  }

 private:
  const std::string path_;
  OIIO::TextureSystem::TextureHandle* handle_;
  OIIO::TextureOpt::Wrap wrap_;
  int channels_ = 3;
  mutable std::atomic<bool> is_faulty_{false};
};

}  // namespace

std::unique_ptr<const Texture> make_oiio_texture(const std::string& path, const TextureOptions& options) {
  return std::make_unique<OiioTexture>(path, options);
}

std::vector<std::string> oiio_texture_faults() { return noted_faults().list(); }

}  // namespace meristem
