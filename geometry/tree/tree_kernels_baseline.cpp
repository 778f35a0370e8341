#define MERISTEM_TREE_AVX2 0
#include "geometry/tree/tree_kernel_bodies.h"

namespace meristem {

const TreeKernels& baseline_tree_kernels() { return table; }

}  // namespace meristem
