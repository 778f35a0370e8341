// Keys: 64-bit names that depend only on how a thing was derived, and the random numbers hashed from them.
// No generator in the project has a state: every random number is uniform(hash(key, what for)), so the same branch
// grows whichever ray, thread or rebuild asks. Pure functions; any thread; a few nanoseconds.
#pragma once

#include <cstdint>
#include <string_view>

namespace meristem {

using Key = std::uint64_t;

// The finaliser of SplitMix64 (Steele, Lea, Flood 2014; variant 13 of Stafford): a bijection in which each input
// bit flips each output bit with probability close to one half.
constexpr Key scramble(Key x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ull;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

// hash_keys(a, b) for one a and many b: what is asked of a alone is done once.
class KeysFrom {
 public:
  constexpr explicit KeysFrom(Key a) : mixed_(scramble(a + 0x9e3779b97f4a7c15ull)) {}
  constexpr Key operator()(Key b) const { return scramble(mixed_ ^ (b * 0xd1342543de82ef95ull + 1)); }

 private:
  Key mixed_;
};

// An ordered hash: hash_keys(a, b) != hash_keys(b, a). More arguments fold from the left.
constexpr Key hash_keys(Key a, Key b) { return KeysFrom(a)(b); }
template <class... Rest>
constexpr Key hash_keys(Key a, Key b, Rest... rest) {
  return hash_keys(hash_keys(a, b), Key(rest)...);
}

// The same for both orders of a and b, for things two ends share (an edge).
constexpr Key hash_unordered(Key a, Key b) { return a < b ? hash_keys(a, b) : hash_keys(b, a); }

constexpr Key hash_text(std::string_view text) {
  Key h = 0xcbf29ce484222325ull;  // FNV-1a, then scrambled
  for (char c : text) h = (h ^ std::uint8_t(c)) * 0x100000001b3ull;
  return scramble(h);
}

// Uniform in [0, 1): the top 24 (float) or 53 (double) bits, so every value is exact.
constexpr float uniform_float(Key k) { return float(k >> 40) * 0x1p-24f; }
constexpr double uniform_double(Key k) { return double(k >> 11) * 0x1p-53; }

}  // namespace meristem
