// Cages with every kind of vertex, and OpenSubdiv's own refinement of them: the truth that ours must agree with.
#pragma once

#include "geometry/mesh/refine.h"
#include "tests/support/shapes.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <memory>
#include <vector>

namespace meristem::subdivision {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

struct Point {
  Vec3d p;
  void Clear(void* = nullptr) { p = {}; }
  void AddWithWeight(const Point& b, double w) { p += b.p * w; }
};

// OpenSubdiv's own refinement of the cage to a level.
inline std::unique_ptr<Far::TopologyRefiner> opensubdiv_refiner(const Mesh& mesh, int level,
                                                                const RefineOptions& options) {
  Sdc::Options sdc;
  sdc.SetVtxBoundaryInterpolation(options.boundary == BoundaryRule::EdgeOnly
                                      ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                      : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  std::vector<int> counts, indices, crease_pairs;
  std::vector<float> crease_weights;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto c = mesh.corners(f);
    counts.push_back(int(c.size()));
    indices.insert(indices.end(), c.begin(), c.end());
    for (std::uint32_t k = 0; k < c.size() && !mesh.corner_sharpness.empty(); ++k)
      if (const float s = mesh.corner_sharpness[mesh.face_starts[f] + k]; s > 0) {
        crease_pairs.push_back(int(c[k]));
        crease_pairs.push_back(int(c[(k + 1) % c.size()]));
        crease_weights.push_back(s);
      }
  }
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = int(mesh.vertex_count());
  descriptor.numFaces = int(mesh.face_count());
  descriptor.numVertsPerFace = counts.data();
  descriptor.vertIndicesPerFace = indices.data();
  descriptor.numCreases = int(crease_weights.size());
  descriptor.creaseVertexIndexPairs = crease_pairs.data();
  descriptor.creaseWeights = crease_weights.data();
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  const auto type = options.scheme == Scheme::Loop ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK;
  std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(descriptor, Factory::Options(type, sdc)));
  Far::TopologyRefiner::UniformOptions uniform(level);
  uniform.fullTopologyInLastLevel = true;
  refiner->RefineUniform(uniform);
  return refiner;
}

// All vertices of its last level.
inline std::vector<Point> opensubdiv_points(const Mesh& mesh, const Far::TopologyRefiner& refiner) {
  std::vector<Point> points(mesh.vertex_count());
  for (std::size_t i = 0; i < points.size(); ++i) points[i].p = mesh.positions[i];
  for (int l = 1; l <= refiner.GetMaxLevel(); ++l) {
    std::vector<Point> next(std::size_t(refiner.GetLevel(l).GetNumVertices()));
    Far::PrimvarRefinerReal<double>(refiner).Interpolate(l, points, next);
    points = std::move(next);
  }
  return points;
}

inline Key refined_step_key(int level) { return hash_keys(9, Key(level)); }

// Our refinement of the cage to a level.
inline Mesh refined(Mesh mesh, int level, const RefineOptions& options) {
  const Quantum quantum = Quantum::for_reach(16);
  for (Vec3d& p : mesh.positions) p = quantum.round(p);
  for (int l = 0; l < level; ++l) {
    const auto plan = make_refine_plan(mesh, mesh.face_count(), 0, options);
    mesh = refine(mesh, *plan, quantum, refined_step_key(l)).mesh;
  }
  return mesh;
}

struct Case {
  const char* name;
  Mesh mesh;
  RefineOptions options;
};

inline std::vector<Case> cases() {
  const RefineOptions loop{Scheme::Loop, BoundaryRule::EdgeAndCorner},
      edge_only{Scheme::CatmullClark, BoundaryRule::EdgeOnly};
  std::vector<Case> all{{"cube", shapes::cube(), {}},
                        {"tetrahedron", shapes::tetrahedron(), {}},
                        {"octagonal prism", shapes::prism(8), {}},
                        {"triangular prism", shapes::prism(3), {}},
                        {"open grid", shapes::bumpy_grid(4), {}},
                        {"open grid, corners rounded", shapes::bumpy_grid(4), edge_only},
                        {"Loop icosahedron", shapes::icosahedron(), loop},
                        {"Loop tetrahedron", shapes::tetrahedron(), loop}};
  for (float sharpness : {0.3f, 1.0f, 1.7f, 2.5f, 10.0f}) {
    Mesh ring = shapes::cube();
    for (auto [a, b] : {std::pair{0, 1}, {1, 3}, {3, 2}, {2, 0}})
      shapes::crease(ring, std::uint32_t(a), std::uint32_t(b), sharpness);
    all.push_back({"cube with a creased face", ring, {}});
    Mesh dart = shapes::cube();
    shapes::crease(dart, 0, 1, sharpness);
    all.push_back({"cube with one creased edge", dart, {}});
    Mesh mixed = shapes::prism(5);
    shapes::crease(mixed, 5, 6, sharpness);
    shapes::crease(mixed, 6, 7, sharpness / 2);
    shapes::crease(mixed, 1, 6, 1.2f);
    all.push_back({"prism with mixed creases", mixed, {}});
    Mesh triangles = shapes::icosahedron();
    shapes::crease(triangles, 0, 11, sharpness);
    shapes::crease(triangles, 11, 10, sharpness);
    all.push_back({"creased Loop icosahedron", triangles, loop});
    Mesh irregular = shapes::icosahedron();  // a crease through five faces, two on one side, three on the other
    shapes::crease(irregular, 0, 11, sharpness);
    shapes::crease(irregular, 11, 4, sharpness);
    all.push_back({"creased icosahedron", irregular, {}});
  }
  return all;
}

}  // namespace meristem::subdivision
