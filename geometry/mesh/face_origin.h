// FaceOrigin: what a face brings along from growth. Plain data.
#pragma once

#include "geometry/base/key.h"

#include <array>
#include <cstdint>

namespace meristem {

constexpr int max_growth_parameters = 8;
constexpr std::uint16_t no_production = 0xffff;

// What a face brings along from growth: set by the production that made it (or the base mesh), inherited by all faces
// refined from it.
struct FaceOrigin {
  Key key = 0;                               // of the grown face: the same for everything refined from it
  std::int32_t material = -1;                // index into the model's materials; -1: the default
  std::int16_t symbol = -1;                  // index into the model's symbols; -1: none
  std::uint16_t production = no_production;  // what made it: a number of the scene's, which has the names
  std::array<float, max_growth_parameters> parameters{};
  bool operator==(const FaceOrigin&) const = default;
};
static_assert(sizeof(FaceOrigin) == 48, "every hit carries one, and every leaf of a plant");

}  // namespace meristem
