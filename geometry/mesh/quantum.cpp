#include "geometry/mesh/quantum.h"

#include "geometry/base/check.h"

namespace meristem {

Quantum Quantum::for_reach(double reach) {
  CHECK(reach > 0 && std::isfinite(reach), "reach {}", reach);
  return Quantum(std::ldexp(1.0, std::ilogb(reach) + 1 - 40));
}

}  // namespace meristem
