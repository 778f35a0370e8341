#include "geometry/mesh/crease.h"

#include <opensubdiv/sdc/crease.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace meristem {

namespace {

using OpenSubdiv::Sdc::Crease;

RefinePlan::Rule rule_of(Crease::Rule rule) {
  switch (rule) {
    case Crease::RULE_CREASE: return RefinePlan::Rule::Crease;
    case Crease::RULE_CORNER: return RefinePlan::Rule::Corner;
    default: return RefinePlan::Rule::Smooth;  // smooth and dart
  }
}

Crease rules_of(Creasing creasing) {
  using OpenSubdiv::Sdc::Options;
  Options options;
  options.SetCreasingMethod(creasing == Creasing::Chaikin ? Options::CREASE_CHAIKIN : Options::CREASE_UNIFORM);
  return Crease(options);
}

// The two edges of a crease through a vertex.
void find_pair(std::span<const std::uint32_t> edges, const std::vector<float>& sharpness, std::uint32_t pair[2]) {
  int found = 0;
  for (std::size_t i = 0; i < edges.size() && found < 2; ++i)
    if (Crease::IsSharp(sharpness[i])) pair[found++] = edges[i];
  if (found == 2 && pair[0] > pair[1]) std::swap(pair[0], pair[1]);
}

// Sorts the edges by their sharpness now, then by the next.
void sort_pairs(std::vector<float>& sharpness, std::vector<float>& next) {
  thread_local std::vector<std::pair<float, float>> pairs;
  pairs.clear();
  for (std::size_t i = 0; i < next.size(); ++i) pairs.emplace_back(sharpness[i], next[i]);
  std::sort(pairs.begin(), pairs.end());
  for (std::size_t i = 0; i < next.size(); ++i) std::tie(sharpness[i], next[i]) = pairs[i];
}

}  // namespace

CreaseSharpness::CreaseSharpness(const Mesh& mesh, const Adjacency& adjacency, const RefineOptions& options)
    : adjacency_(adjacency),
      creasing_(options.creasing),
      edge_(adjacency.edge_count()),
      vertex_(mesh.vertex_count(), 0.0f),
      user_vertex_(mesh.vertex_sharpness) {
  auto positive = [](float s) { return s > 0; };
  any_user_sharpness_ = std::any_of(mesh.corner_sharpness.begin(), mesh.corner_sharpness.end(), positive) ||
                        std::any_of(user_vertex_.begin(), user_vertex_.end(), positive);
  if (!user_vertex_.empty()) vertex_ = user_vertex_;
  for (std::uint32_t e = 0; e < adjacency.edge_count(); ++e) {
    const Adjacency::Edge& edge = adjacency.edge(e);
    const bool is_boundary = edge.faces[1] == Adjacency::none;
    edge_[e] = is_boundary ? Crease::SHARPNESS_INFINITE : edge.sharpness;
    if (!is_boundary || options.boundary != BoundaryRule::EdgeAndCorner) continue;
    for (std::uint32_t v : edge.vertices)
      if (adjacency.faces_of_vertex(v).size() == 1) vertex_[v] = Crease::SHARPNESS_INFINITE;
  }
}

// Of the half at v of an edge there.
float CreaseSharpness::refined(float sharpness, std::uint32_t v) const {
  if (creasing_ == Creasing::Uniform || !Crease::IsSemiSharp(sharpness))
    return Crease().SubdivideUniformSharpness(sharpness);
  thread_local std::vector<float> around;
  around.clear();
  for (std::uint32_t e : adjacency_.edges_of_vertex(v)) around.push_back(edge_[e]);
  std::sort(around.begin(), around.end());
  return rules_of(creasing_).SubdivideEdgeSharpnessAtVertex(sharpness, int(around.size()), around.data());
}

float CreaseSharpness::refined_edge(std::uint32_t e, std::uint32_t v) const {
  const Adjacency::Edge& edge = adjacency_.edge(e);
  return edge.faces[1] == Adjacency::none ? Crease().SubdivideUniformSharpness(edge.sharpness)
                                          : refined(edge.sharpness, v);
}

// A crease that stays one on both sides of its point is sharp there, else in proportion to its sharpness, up to 1. (Far
// does not stop there where Chaikin's rule ends a crease of 1 to 4/3, and leaves the hull of the vertices.)
float CreaseSharpness::edge_weight(std::uint32_t e) const {
  const Adjacency::Edge& edge = adjacency_.edge(e);
  const float sharpness = edge_[e];
  if (sharpness <= 0 || sharpness >= 1) return std::clamp(sharpness, 0.0f, 1.0f);
  const bool stays =
      Crease::IsSharp(refined(sharpness, edge.vertices[0])) && Crease::IsSharp(refined(sharpness, edge.vertices[1]));
  return stays ? 1 : sharpness;
}

float CreaseSharpness::refined_vertex(std::uint32_t v) const {
  return user_vertex_.empty() ? 0 : Crease().SubdivideVertexSharpness(user_vertex_[v]);
}

VertexCrease CreaseSharpness::vertex_rule(std::uint32_t v) const {
  const auto edges = adjacency_.edges_of_vertex(v);
  VertexCrease result;
  thread_local std::vector<float> sharpness, next;
  sharpness.clear();
  for (std::uint32_t e : edges) sharpness.push_back(edge_[e]);
  if (!Crease::IsSharp(vertex_[v]) && std::none_of(sharpness.begin(), sharpness.end(), Crease::IsSharp)) return result;

  const Crease crease = rules_of(creasing_);
  next.clear();
  for (float s : sharpness) next.push_back(refined(s, v));
  const float next_vertex = crease.SubdivideVertexSharpness(vertex_[v]);
  const int count = int(edges.size());
  const Crease::Rule rule = crease.DetermineVertexVertexRule(vertex_[v], count, sharpness.data());
  const Crease::Rule next_rule = crease.DetermineVertexVertexRule(next_vertex, count, next.data());
  result.rule = rule_of(rule);
  result.next_rule = rule_of(next_rule);
  if (result.rule == RefinePlan::Rule::Crease) find_pair(edges, sharpness, result.edges);
  if (result.next_rule == RefinePlan::Rule::Crease) find_pair(edges, next, result.next_edges);
  if (rule != next_rule && result.rule != RefinePlan::Rule::Smooth) {
    sort_pairs(sharpness, next);
    result.weight =
        crease.ComputeFractionalWeightAtVertex(vertex_[v], next_vertex, count, sharpness.data(), next.data());
  }
  return result;
}

}  // namespace meristem
