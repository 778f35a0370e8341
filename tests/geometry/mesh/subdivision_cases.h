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
                                                                const RefineOptions& options,
                                                                Sdc::Options::VtxBoundaryInterpolation boundary) {
  Sdc::Options sdc;
  sdc.SetVtxBoundaryInterpolation(boundary);
  sdc.SetCreasingMethod(options.creasing == Creasing::Chaikin ? Sdc::Options::CREASE_CHAIKIN
                                                              : Sdc::Options::CREASE_UNIFORM);
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
inline std::unique_ptr<Far::TopologyRefiner> opensubdiv_refiner(const Mesh& mesh, int level,
                                                                const RefineOptions& options) {
  return opensubdiv_refiner(mesh, level, options,
                            options.boundary == BoundaryRule::EdgeOnly ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                                                       : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
}

// Whether Far leaves the hull of the vertices somewhere: where Chaikin's rule ends a crease sharper than 1 at once, it
// gives the midpoint a weight above 1. Ours stops at 1, as is said in Sdc; there the two differ.
inline bool opensubdiv_extrapolates(const Far::TopologyRefiner& refiner) {
  for (int l = 0; l < refiner.GetMaxLevel(); ++l) {
    const Far::TopologyLevel level = refiner.GetLevel(l), next = refiner.GetLevel(l + 1);
    for (int e = 0; e < level.GetNumEdges(); ++e)
      if (level.GetEdgeSharpness(e) > 1 && next.GetVertexRule(level.GetEdgeChildVertex(e)) != Sdc::Crease::RULE_CREASE)
        return true;
  }
  return false;
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

inline void add_creased(float sharpness, Creasing creasing, std::vector<Case>& all) {
  const RefineOptions catmull_clark{Scheme::CatmullClark, BoundaryRule::EdgeAndCorner, creasing},
      loop{Scheme::Loop, BoundaryRule::EdgeAndCorner, creasing};
  Mesh ring = shapes::cube();
  for (auto [a, b] : {std::pair{0, 1}, {1, 3}, {3, 2}, {2, 0}})
    shapes::crease(ring, std::uint32_t(a), std::uint32_t(b), sharpness);
  all.push_back({"cube with a creased face", ring, catmull_clark});
  Mesh uneven = shapes::cube();  // by Chaikin's rule 0.9 between edges of 3 stays sharp for a level
  shapes::crease(uneven, 0, 1, sharpness);
  shapes::crease(uneven, 1, 3, 0.9f);
  shapes::crease(uneven, 3, 2, 3);
  shapes::crease(uneven, 2, 0, 0.8f * sharpness);
  all.push_back({"cube with an uneven crease", uneven, catmull_clark});
  Mesh dart = shapes::cube();
  shapes::crease(dart, 0, 1, sharpness);
  all.push_back({"cube with one creased edge", dart, catmull_clark});
  Mesh mixed = shapes::prism(5);
  shapes::crease(mixed, 5, 6, sharpness);
  shapes::crease(mixed, 6, 7, sharpness / 2);
  shapes::crease(mixed, 1, 6, 1.2f);
  all.push_back({"prism with mixed creases", mixed, catmull_clark});
  Mesh triangles = shapes::icosahedron();
  shapes::crease(triangles, 0, 11, sharpness);
  shapes::crease(triangles, 11, 10, sharpness);
  all.push_back({"creased Loop icosahedron", triangles, loop});
  Mesh irregular = shapes::icosahedron();  // a crease through five faces, two on one side, three on the other
  shapes::crease(irregular, 0, 11, sharpness);
  shapes::crease(irregular, 11, 4, sharpness);
  all.push_back({"creased icosahedron", irregular, catmull_clark});
}

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
  for (float sharpness : {0.3f, 1.0f, 1.7f, 2.5f, 10.0f})
    for (Creasing creasing : {Creasing::Uniform, Creasing::Chaikin}) add_creased(sharpness, creasing, all);
  return all;
}

}  // namespace meristem::subdivision
