// AOVs, "arbitrary output variables": what else than its colour is known of a pixel. Their names are those that other
// renderers and compositing programs use.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meristem {

enum class Aov : std::uint8_t {
  Albedo,
  Normal,
  Z,
  P,
  Uv,
  Motion,
  ObjectId,
  MaterialId,
  Level,
  Samples,
  Variance,
  SecondHalf,
  CostTime,
  CostExpand,
  CostReexpand,
  CryptoObject,
  CryptoMaterial,
  CryptoProduction
};

struct AovInfo {
  Aov aov;
  const char* name;                   // of the option, of the part of the file
  std::vector<const char*> channels;  // of the part; empty: those of Cryptomatte
  const char* doc;
};

// All of them, in the order of the enumeration.
std::span<const AovInfo> aov_infos();
const AovInfo& info_of(Aov aov);

// By name; nothing if there is none.
std::optional<Aov> aov_named(std::string_view name);

// "albedo,normal,Z", or "all": sorted, each once. Throws std::invalid_argument that says which name is unknown, and
// what is known.
std::vector<Aov> parse_aovs(std::string_view text);

}  // namespace meristem
