#include "procedural/plants/child_kernels.h"

#include "geometry/fields/kernels.h"

namespace meristem {

const ChildKernels& best_child_kernels() {
  static const ChildKernels& best = &best_kernels() == &avx512_kernels() ? avx512_child_kernels()
                                    : &best_kernels() == &avx2_kernels() ? avx2_child_kernels()
                                                                         : baseline_child_kernels();
  return best;
}

}  // namespace meristem
