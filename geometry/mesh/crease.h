// CreaseSharpness: edge and vertex sharpness of a mesh with its boundary rule, and the smoothing rule of every vertex.
// The one file that asks OpenSubdiv's crease rules (Sdc::Crease). What it says of a vertex needs all faces around that;
// of an edge, by Chaikin's rule, all around its ends. It does not depend on the order of the mesh: sharpness is summed
// by size.
#pragma once

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/refine_plan.h"

#include <vector>

namespace meristem {

// The rule of a vertex at this level, blended with that of the next where sharpness is fractional.
struct VertexCrease {
  RefinePlan::Rule rule = RefinePlan::Rule::Smooth, next_rule = RefinePlan::Rule::Smooth;
  float weight = 1;  // of `rule`
  std::uint32_t edges[2] = {RefinePlan::none, RefinePlan::none},
                next_edges[2] = {RefinePlan::none, RefinePlan::none};  // of a crease
};

class CreaseSharpness {
 public:
  CreaseSharpness(const Mesh& mesh, const Adjacency& adjacency, const RefineOptions& options);

  // Whether the mesh carries sharpness of its own (boundaries aside): if not, refined meshes need none either.
  bool any_user_sharpness() const { return any_user_sharpness_; }
  // Of the sharp rule at the edge's point, 0 to 1; the rest goes to the smooth one.
  float edge_weight(std::uint32_t e) const;
  // Of the half of the edge that ends at v; without the boundary's own.
  float refined_edge(std::uint32_t e, std::uint32_t v) const;
  float refined_vertex(std::uint32_t v) const;
  VertexCrease vertex_rule(std::uint32_t v) const;

 private:
  float refined(float sharpness, std::uint32_t v) const;

  const Adjacency& adjacency_;
  const Creasing creasing_;
  bool any_user_sharpness_ = false;
  std::vector<float> edge_, vertex_;  // boundaries included
  std::vector<float> user_vertex_;
};

}  // namespace meristem
