// SHA-256 (FIPS 180-4): the fingerprint of scene texts and of images. About 200 MB/s; not meant against attackers with
// a stopwatch. A Sha256 belongs to one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace meristem {

class Sha256 {
 public:
  void update(const void* data, std::size_t bytes);
  // The digest as 64 hexadecimal digits. Ends the computation: no update afterwards.
  std::string finish();

 private:
  void compress(const std::uint8_t* block);

  // Fractional parts of the square roots of the first eight primes (FIPS 180-4, section 5.3.3).
  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, 64> pending_{};
  std::size_t pending_bytes_ = 0;
  std::uint64_t total_bytes_ = 0;
};

std::string sha256(std::string_view text);

}  // namespace meristem
