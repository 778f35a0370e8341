// The 16 bits of a half (IEC 60559 binary16).
#pragma once

#include <bit>
#include <cstdint>

namespace meristem {

// Of the half nearest to a float, ties to even; beyond 65519 infinity. Without Imath's tables and whatever the
// processor's mode for denormal numbers.
constexpr std::uint16_t half_bits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const auto sign = std::uint16_t(bits >> 16 & 0x8000u);
  const std::uint32_t magnitude = bits & 0x7fffffffu;
  constexpr std::uint32_t infinity = 0x7f800000u, overflow = 0x477ff000u, least_normal = 0x38800000u;
  if (magnitude > infinity) return std::uint16_t(sign | 0x7e00u);
  if (magnitude >= overflow) return std::uint16_t(sign | 0x7c00u);
  const auto rounded = [](std::uint32_t mantissa, std::uint32_t shift) {
    const std::uint32_t result = mantissa >> shift, rest = mantissa & ((1u << shift) - 1), tie = 1u << (shift - 1);
    return result + (rest > tie || (rest == tie && (result & 1)));
  };
  if (magnitude >= least_normal) return std::uint16_t(sign | rounded(magnitude - (112u << 23), 13));
  const std::uint32_t exponent = magnitude >> 23;
  if (exponent < 102) return sign;  // less than half of the least one
  return std::uint16_t(sign | rounded((magnitude & 0x7fffffu) | 0x800000u, 126 - exponent));
}

}  // namespace meristem
