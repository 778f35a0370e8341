// The section "render" of a scene file.
#pragma once

#include "geometry/base/params.h"
#include "renderer/scene/scene.h"

#include <optional>
#include <string>

namespace meristem {

// The types that stand when a scene file names none.
constexpr const char* default_camera = "pinhole";
constexpr const char* default_material = "openpbr";
constexpr const char* default_integrator = "path";
constexpr const char* default_sampler = "sobol";
constexpr const char* default_filter = "blackman_harris";

struct RenderSection {
  RenderSettings settings;
  const Value* integrator = nullptr;  // null: the default
  const Value* sampler = nullptr;
  const Value* filter = nullptr;
};

RenderSection read_render(Params& params);

// "512M", "1.5G", "2GiB", "1000000": bytes; K, M, G, T are powers of 1024. Nothing if the text is no such number.
std::optional<std::uint64_t> parse_bytes(const std::string& text);

}  // namespace meristem
