// Sums over the faces that meet in a vertex, for many quads at once: what local normals and local scales are made of.
// Runs in SIMD lanes (AVX2 where the machine has it), with the bits that one face at a time gives.
#pragma once

#include "geometry/mesh/quantum.h"

#include <cstdint>
#include <span>

namespace meristem {

struct FaceSum {
  Vec3d normal;         // of the unit normals, on the grid of unit vectors
  double diagonal = 0;  // of the mean diagonals, on the grid of positions
};

// Adds every quad (four corners each) to the sums of its corners. On one thread for the same sums.
void add_quads(std::span<const Vec3d> positions, std::span<const std::uint32_t> corners, const Quantum& quantum,
               std::span<FaceSum> sums);

// The unit vector along each sum's normal; zero where they cancel.
void unit_normals(std::span<const FaceSum> sums, Vec3d* normals);

}  // namespace meristem
