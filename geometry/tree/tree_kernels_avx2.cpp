#define MERISTEM_TREE_AVX2 1
#include "geometry/tree/tree_kernel_bodies.h"

namespace meristem {

const TreeKernels& avx2_tree_kernels() { return table; }

}  // namespace meristem
