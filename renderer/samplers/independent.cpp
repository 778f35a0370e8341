// independent: plain random numbers, each on its own. Noisier than sobol; the yardstick for it.
#include "renderer/scene/interfaces.h"

namespace meristem {
namespace {

class Independent : public Sampler {
 public:
  explicit Independent(Params&) {}

  std::unique_ptr<Sampler> clone() const override { return std::make_unique<Independent>(*this); }

  void start(int pixel_x, int pixel_y, int sample_index, std::uint64_t seed) override {
    key_ = hash_keys(seed, Key(pixel_x), Key(pixel_y), Key(sample_index));
    dimension_ = 0;
  }
  float next_1d() override { return uniform_float(hash_keys(key_, dimension_++)); }
  Vec2f next_2d() override {
    const float x = next_1d();
    return {x, next_1d()};
  }

  std::uint32_t dimension() const override { return std::uint32_t(dimension_); }
  void go_to(std::uint32_t dimension) override { dimension_ = dimension; }

 private:
  Key key_ = 0;
  Key dimension_ = 0;
};

}  // namespace

void register_independent(SamplerRegistry& r) { r.add<Independent>("independent", "Independent random numbers"); }

}  // namespace meristem
