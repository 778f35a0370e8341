// sobol: well spread samples: Owen-scrambled Sobol points, shuffled anew for each pixel and each pair of dimensions.
//
// Burley 2020, "Practical Hash-based Owen Scrambling", sections 3 and 4: dimensions are padded, that is, every 1D or 2D
// request takes the first one or two dimensions of the Sobol sequence with its own scrambling and its own nested
// shuffle of the sample index. So the first 2^k samples of every request are a (0, k, 2)-net: each elementary interval
// of area 2^-k holds one of them. Best with a power of two as number of samples.
#include "renderer/scene/interfaces.h"

#include <tmmintrin.h>

namespace meristem {
namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x & 0xf0f0f0f0u) >> 4) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x & 0xccccccccu) >> 2) | ((x & 0x33333333u) << 2);
  return ((x & 0xaaaaaaaau) >> 1) | ((x & 0x55555555u) << 1);
}

// A permutation in which a bit is flipped depending on lower bits alone: Owen scrambling of the reversed number.
// Laine and Karras 2011, section 3.1, with the constants of Burley 2020, section 2.3.
std::uint32_t scramble_upwards(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  return x ^ (x * 0x8d22f6e6u);
}

// The second Sobol dimension before bit reversal. Its matrix is Pascal's triangle modulo 2, by Lucas' theorem the
// fifth tensor power of [1 1; 0 1], which five shifts apply.
std::uint32_t pascal(std::uint32_t x) {
  x ^= (x >> 1) & 0x55555555u;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 4) & 0x0f0f0f0fu;
  x ^= (x >> 8) & 0x00ff00ffu;
  return x ^ ((x >> 16) & 0x0000ffffu);
}

// hash_keys(a, b) in two halves: the first depends on the pixel alone, and is a third of what a number costs.
constexpr Key begin_hash(Key a) { return scramble(a + 0x9e3779b97f4a7c15ull); }
constexpr Key end_hash(Key begun, Key b) { return scramble(begun ^ (b * 0xd1342543de82ef95ull + 1)); }
static_assert(end_hash(begin_hash(3), 5) == hash_keys(3, 5));

// Two numbers in [0, 1) whose digits are the bits of a and b, reversed: four bits at a time by a table, then the bytes.
Vec2f reversed_units(std::uint32_t a, std::uint32_t b) {
  const __m128i lower = _mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15);
  const __m128i upper = _mm_slli_epi16(lower, 4), four_bits = _mm_set1_epi8(0xf);
  const __m128i bytes_backwards = _mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12);
  const __m128i bits = _mm_unpacklo_epi32(_mm_cvtsi32_si128(int(a)), _mm_cvtsi32_si128(int(b)));
  const __m128i bytes = _mm_or_si128(_mm_shuffle_epi8(upper, _mm_and_si128(bits, four_bits)),
                                     _mm_shuffle_epi8(lower, _mm_and_si128(_mm_srli_epi16(bits, 4), four_bits)));
  const __m128i digits = _mm_srli_epi32(_mm_shuffle_epi8(bytes, bytes_backwards), 8);
  const __m128 units = _mm_mul_ps(_mm_cvtepi32_ps(digits), _mm_set1_ps(0x1p-24f));
  return {_mm_cvtss_f32(units), _mm_cvtss_f32(_mm_shuffle_ps(units, units, 1))};
}

class Sobol : public Sampler {
 public:
  explicit Sobol(Params&) {}

  std::unique_ptr<Sampler> clone() const override { return std::make_unique<Sobol>(*this); }

  void start(int pixel_x, int pixel_y, int sample_index, std::uint64_t seed) override {
    if (pixel_x != pixel_x_ || pixel_y != pixel_y_ || seed != seed_) {
      pixel_hash_ = begin_hash(hash_keys(seed, Key(pixel_x), Key(pixel_y)));
      pixel_x_ = pixel_x, pixel_y_ = pixel_y, seed_ = seed;
    }
    reversed_index_ = reverse_bits(std::uint32_t(sample_index));
    dimension_ = 0;
  }

  float next_1d() override {
    const Key key = next_key();
    return reversed_units(scramble_upwards(shuffled_index(key), std::uint32_t(key >> 32)), 0).x;
  }

  Vec2f next_2d() override {
    const Key key = next_key(), other = scramble(key);
    const std::uint32_t i = shuffled_index(key);
    return reversed_units(scramble_upwards(i, std::uint32_t(key >> 32)),
                          scramble_upwards(pascal(i), std::uint32_t(other)));
  }

  void skip_2d() override { ++dimension_; }

  std::uint32_t dimension() const override { return dimension_; }
  void go_to(std::uint32_t dimension) override { dimension_ = dimension; }

 private:
  Key next_key() { return end_hash(pixel_hash_, Key(dimension_++)); }
  std::uint32_t shuffled_index(Key key) const {
    return reverse_bits(scramble_upwards(reversed_index_, std::uint32_t(key)));
  }

  int pixel_x_ = 0, pixel_y_ = 0;
  std::uint64_t seed_ = 0;
  Key pixel_hash_ = begin_hash(hash_keys(0, 0, 0));  // of these; a dimension ends it
  std::uint32_t reversed_index_ = 0;
  std::uint32_t dimension_ = 0;
};

}  // namespace

void register_sobol(SamplerRegistry& r) {
  r.add<Sobol>("sobol", "Owen-scrambled Sobol points, shuffled for each pixel");
}

}  // namespace meristem
