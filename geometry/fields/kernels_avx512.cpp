#define MERISTEM_LANES 16
#include "geometry/fields/kernel_bodies.h"

namespace meristem {

const KernelTable& avx512_kernels() { return table; }

}  // namespace meristem
