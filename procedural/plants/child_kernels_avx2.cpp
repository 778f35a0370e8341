#define MERISTEM_LANES 8
#include "procedural/plants/child_kernel_bodies.h"

namespace meristem {

const ChildKernels& avx2_child_kernels() { return table; }

}  // namespace meristem
