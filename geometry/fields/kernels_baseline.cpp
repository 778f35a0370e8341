#define MERISTEM_LANES 4
#include "geometry/fields/kernel_bodies.h"

namespace meristem {

const KernelTable& baseline_kernels() { return table; }

}  // namespace meristem
