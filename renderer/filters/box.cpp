// box: the plain mean of a square. Sharp but aliased; radius 0.5 gives each pixel its own samples alone.
#include "renderer/scene/interfaces.h"

namespace meristem {
namespace {

class Box : public Filter {
 public:
  explicit Box(Params& params) { radius_ = float(params.real("radius", 0.5, {0.01, 32, "px"}, "half the width")); }

  float radius() const override { return radius_; }
  float value(float x) const override { return std::abs(x) <= radius_ ? 0.5f / radius_ : 0; }

 private:
  float radius_;
};

}  // namespace

void register_box(FilterRegistry& r) { r.add<Box>("box", "The plain mean of a square"); }

}  // namespace meristem
