// ExactSum: a sum of numbers that does not depend on their order nor on how they were grouped, because no addition
// rounds: a fixed-point number of 128 bits. So the film of a render in parts, merged in any order, has the bits of the
// film of one unbroken render.
//
// A term counts in units of 2^-64: terms from 2^-40 (1e-12) on keep all 24 bits of a float, smaller ones lose their
// last. Terms are below limit; 2^20 of them fit. 16 bytes.
#pragma once

#include <cmath>
#include <cstdint>

namespace meristem {

class ExactSum {
 public:
  static constexpr double limit = 0x1p42;

  // |x| < limit.
  void add(double x) {
    const double size = std::abs(x);
    const auto whole = std::uint64_t(size);
    const auto fraction = std::uint64_t((size - double(whole)) * 0x1p64);  // below 1: exact, then cut off
    const Unsigned term = (Unsigned(whole) << 64) | fraction;
    bits_ += x < 0 ? -term : term;
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
