#include "geometry/fields/kernels.h"

namespace meristem {

bool avx2_supported() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }

const KernelTable& best_kernels() {
  static const KernelTable& best = avx2_supported() ? avx2_kernels() : baseline_kernels();
  return best;
}

}  // namespace meristem
