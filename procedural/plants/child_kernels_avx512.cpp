#define MERISTEM_LANES 16
#include "procedural/plants/child_kernel_bodies.h"

namespace meristem {

const ChildKernels& avx512_child_kernels() { return table; }

}  // namespace meristem
