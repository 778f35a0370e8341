#define MERISTEM_LANES 8
#include "geometry/fields/kernel_bodies.h"

namespace meristem {

const KernelTable& avx2_kernels() { return table; }

}  // namespace meristem
