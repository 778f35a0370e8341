// CreaseSharpness: edge and vertex sharpness of a mesh with its boundary rule, and the smoothing rule of every vertex.
// The one file that asks OpenSubdiv's crease rules (Sdc::Crease, uniform method).
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
  CreaseSharpness(const Mesh& mesh, const Adjacency& adjacency, BoundaryRule boundary);

  // Whether the mesh carries sharpness of its own (boundaries aside): if not, refined meshes need none either.
  bool any_user_sharpness() const { return any_user_sharpness_; }
  float edge(std::uint32_t e) const { return edge_[e]; }
  float vertex(std::uint32_t v) const { return vertex_[v]; }
  float refined_edge(std::uint32_t e) const;  // of both halves; without the boundary's own
  float refined_vertex(std::uint32_t v) const;
  VertexCrease vertex_rule(std::uint32_t v) const;

 private:
  const Adjacency& adjacency_;
  bool any_user_sharpness_ = false;
  std::vector<float> edge_, vertex_;  // boundaries included
  std::vector<float> user_vertex_;
};

}  // namespace meristem
