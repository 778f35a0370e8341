#include "geometry/tree/ray_stream.h"

#include "geometry/tree/tree_kernels.h"

namespace meristem {

void RayStream::run() { best_tree_kernels().run_stream(*this); }

}  // namespace meristem
