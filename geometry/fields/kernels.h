// Kernels: one function an operation, over many lanes, in three builds: for the baseline of the project (SSE4.2), for
// AVX2 with FMA and for AVX-512. All give the same bits. Pure functions; any thread.
#pragma once

#include "geometry/base/key.h"
#include "geometry/fields/operations.h"

#include <array>
#include <cstddef>
#include <span>

namespace meristem {

constexpr int lane_group = 16;  // the most lanes that a kernel works on at once

// Where an operand's lanes are: step_mask -1: one float a lane; 0: lane_group equal floats that stand for all lanes.
struct Operand {
  const float* data = nullptr;
  std::ptrdiff_t step_mask = 0;
};

// A piece of a curve: value = c0 + t (c1 + t (c2 + t c3)) with t = x - start, from x >= start on.
struct CurvePiece {
  float start, c0, c1, c2, c3;
};

struct KernelCall {
  std::array<float*, 3> out{};
  const Operand* operands = nullptr;
  int operand_count = 0;
  int parameter = 0;                   // octaves, type of voronoi
  const CurvePiece* pieces = nullptr;  // of a curve; `parameter` of them
};

using Kernel = void (*)(const KernelCall& call, int lanes);

struct KernelTable {
  const char* name;
  int lanes;                                   // kernels work on a multiple of so many
  std::array<Kernel, kernel_count> functions;  // by Op; null for Rand, which needs keys, and for grids
};

const KernelTable& baseline_kernels();
const KernelTable& avx2_kernels();
const KernelTable& avx512_kernels();
std::span<const KernelTable* const> usable_kernels();  // those that this machine can run, the best one last
const KernelTable& best_kernels();

}  // namespace meristem
