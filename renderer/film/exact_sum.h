// ExactSum: a sum of numbers that does not depend on their order nor on how they were grouped, because no addition
// rounds: a fixed-point number of 128 bits. So the film of a render in parts, merged in any order, has the bits of the
// film of one unbroken render.
//
// A term counts in units of 2^-64: terms from 2^-40 (1e-12) on keep all 24 bits of a float, smaller ones lose their
// last. Terms are below limit; 2^20 of them fit. 16 bytes.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace meristem {

class ExactSum {
 public:
  static constexpr double limit = 0x1p42;

  // |x| < limit.
  void add(double x) {
    // The digits of a double stand for themselves times 2^(exponent - 1075); what lies below 2^-64 is cut off
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const int exponent = int(bits >> 52) & 0x7ff;
    const std::uint64_t digits = (bits & 0xfffffffffffffull) | 0x10000000000000ull;
    const Unsigned term = (Unsigned(digits) << 64) >> std::min(1075 - exponent, 127);
    bits_ += std::signbit(x) ? -term : term;
  }
  void add(const ExactSum& o) { bits_ += o.bits_; }

  // Rounded once.
  double value() const { return double(Signed(bits_)) * 0x1p-64; }

  bool operator==(const ExactSum&) const = default;

 private:
  __extension__ typedef unsigned __int128 Unsigned;
  __extension__ typedef __int128 Signed;
  Unsigned bits_ = 0;
};

}  // namespace meristem
