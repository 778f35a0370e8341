#include "geometry/fields/kernels.h"

#include <vector>

namespace meristem {

std::span<const KernelTable* const> usable_kernels() {
  static const std::vector<const KernelTable*> usable = [] {
    std::vector<const KernelTable*> tables{&baseline_kernels()};
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (avx2) tables.push_back(&avx2_kernels());
    if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
      tables.push_back(&avx512_kernels());
    return tables;
  }();
  return usable;
}

const KernelTable& best_kernels() {
  static const KernelTable& best = *usable_kernels().back();
  return best;
}

}  // namespace meristem
