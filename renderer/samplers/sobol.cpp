// sobol: well spread samples: Owen-scrambled Sobol points, shuffled anew for each pixel and each pair of dimensions.
//
// Burley 2020, "Practical Hash-based Owen Scrambling", sections 3 and 4: dimensions are padded, that is, every 1D or 2D
// request takes the first one or two dimensions of the Sobol sequence with its own scrambling and its own nested
// shuffle of the sample index. So the first 2^k samples of every request are a (0, k, 2)-net: each elementary interval
// of area 2^-k holds one of them. Best with a power of two as number of samples.
#include "renderer/scene/interfaces.h"

namespace meristem {
namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0xff00ff00u) >> 8) | ((x & 0x00ff00ffu) << 8);
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

float to_unit(std::uint32_t x) { return float(x >> 8) * 0x1p-24f; }

class Sobol : public Sampler {
 public:
  explicit Sobol(Params&) {}

  std::unique_ptr<Sampler> clone() const override { return std::make_unique<Sobol>(*this); }

  void start(int pixel_x, int pixel_y, int sample_index, std::uint64_t seed) override {
    pixel_key_ = hash_keys(seed, Key(pixel_x), Key(pixel_y));
    reversed_index_ = reverse_bits(std::uint32_t(sample_index));
    dimension_ = 0;
  }

  float next_1d() override {
    const Key key = next_key();
    return to_unit(scrambled(shuffled_index(key), key >> 32));
  }

  Vec2f next_2d() override {
    const Key key = next_key(), other = scramble(key);
    const std::uint32_t i = shuffled_index(key);
    return {to_unit(scrambled(i, key >> 32)), to_unit(scrambled(pascal(i), other))};
  }

  std::uint32_t dimension() const override { return dimension_; }
  void go_to(std::uint32_t dimension) override { dimension_ = dimension; }

 private:
  Key next_key() { return hash_keys(pixel_key_, Key(dimension_++)); }
  std::uint32_t shuffled_index(Key key) const {
    return reverse_bits(scramble_upwards(reversed_index_, std::uint32_t(key)));
  }
  static std::uint32_t scrambled(std::uint32_t x, Key seed) {
    return reverse_bits(scramble_upwards(x, std::uint32_t(seed)));
  }

  Key pixel_key_ = 0;
  std::uint32_t reversed_index_ = 0;
  std::uint32_t dimension_ = 0;
};

}  // namespace

void register_sobol(SamplerRegistry& r) {
  r.add<Sobol>("sobol", "Owen-scrambled Sobol points, shuffled for each pixel");
}

}  // namespace meristem
