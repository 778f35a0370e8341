#define MERISTEM_LANES 4
#include "procedural/plants/child_kernel_bodies.h"

namespace meristem {

const ChildKernels& baseline_child_kernels() { return table; }

}  // namespace meristem
