#define MERISTEM_TREE_AVX2 1
#include "geometry/tree/ray_packet_bodies.h"
#include "geometry/tree/ray_stream_bodies.h"

namespace meristem {

const TreeKernels& avx2_tree_kernels() {
  static constexpr TreeKernels table{intersect, occluded, intersect_braid, occlude_braid, run_stream, run_packet};
  return table;
}

}  // namespace meristem
