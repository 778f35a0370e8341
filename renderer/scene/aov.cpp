#include "renderer/scene/aov.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace meristem {

namespace {

const std::array infos{
    AovInfo{Aov::Albedo, "albedo", {"albedo.R", "albedo.G", "albedo.B"}, "mean albedo of the first surface"},
    AovInfo{Aov::Normal, "normal", {"normal.X", "normal.Y", "normal.Z"}, "mean shading normal, world space, not unit"},
    AovInfo{Aov::Z, "Z", {"Z"}, "depth along the view axis, metres, of the nearest sample; 1e10: nothing there"},
    AovInfo{Aov::P, "P", {"P.X", "P.Y", "P.Z"}, "position in world space of the nearest sample"},
    AovInfo{Aov::Uv, "uv", {"uv.U", "uv.V"}, "texture coordinates of the nearest sample"},
    AovInfo{Aov::Motion,
            "motion",
            {"motion.X", "motion.Y"},
            "way on the film in a frame of what the nearest sample shows, pixels to the right and down"},
    AovInfo{Aov::ObjectId, "id.object", {"id.object"}, "object of the nearest sample, from 1; 0: nothing there"},
    AovInfo{
        Aov::MaterialId, "id.material", {"id.material"}, "material of the nearest sample, from 1; 0: nothing there"},
    AovInfo{Aov::Level, "level", {"level"}, "level of refinement of the nearest sample"},
    AovInfo{Aov::Samples, "samples", {"samples"}, "camera paths taken"},
    AovInfo{Aov::Variance, "variance", {"variance"}, "variance of the pixel's mean luminance"},
    AovInfo{Aov::SecondHalf,
            "second_half",
            {"second_half.R", "second_half.G", "second_half.B"},
            "the picture by the second four of every eight samples: a half buffer, for denoisers"},
    AovInfo{Aov::CostTime, "cost.time", {"cost.time"}, "seconds that its samples took"},
    AovInfo{Aov::CostExpand, "cost.expand", {"cost.expand"}, "cells that its samples expanded"},
    AovInfo{Aov::CostReexpand, "cost.reexpand", {"cost.reexpand"}, "of these, cells that had been evicted"},
    AovInfo{Aov::CryptoObject, "crypto_object", {}, "Cryptomatte of objects"},
    AovInfo{Aov::CryptoMaterial, "crypto_material", {}, "Cryptomatte of materials"},
    AovInfo{Aov::CryptoProduction, "crypto_production", {}, "Cryptomatte of the rules that grew the surface"}};

}  // namespace

std::span<const AovInfo> aov_infos() { return infos; }

const AovInfo& info_of(Aov aov) { return infos[std::size_t(aov)]; }

std::optional<Aov> aov_named(std::string_view name) {
  for (const AovInfo& info : infos)
    if (name == info.name) return info.aov;
  return {};
}

std::vector<Aov> parse_aovs(std::string_view text) {
  std::vector<Aov> result;
  std::vector<std::string_view> names;
  for (const AovInfo& info : infos) names.push_back(info.name);
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string_view name = text.substr(at, end - at);
    at = end + 1;
    if (name == "all") {
      for (const AovInfo& info : infos) result.push_back(info.aov);
    } else if (const auto aov = aov_named(name)) {
      result.push_back(*aov);
    } else {
      throw std::invalid_argument(fmt::format("no AOV named \"{}\"; known: all, {}", name, fmt::join(names, ", ")));
    }
  }
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

}  // namespace meristem
