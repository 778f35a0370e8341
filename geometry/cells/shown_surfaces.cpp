#include "geometry/cells/shown_surfaces.h"

#include "geometry/cells/placed_footprint.h"

#include <fmt/format.h>

#include <map>
#include <tuple>

namespace meristem {

namespace {

// Calls visit(expansion, done) for every final cell below one; `from` and `to` are the shares of the whole before and
// behind it.
template <class Visit>
void visit_cells(const Model& model, CellMesh cell, int level, double from, double to, const Visit& visit) {
  Expansion expansion = expand(model, std::move(cell), level);
  if (expansion.leaf) return visit(expansion, to);
  const InnerCell& inner = *expansion.inner;
  const double share = (to - from) / double(inner.child_count());
  for (std::size_t i = 0; i < inner.child_count(); ++i)
    visit_cells(model, child_cell(model, inner, i), inner.level, from + share * double(i),
                i + 1 == inner.child_count() ? to : from + share * double(i + 1), visit);
}

// Parts as a graph without cycles: what is shared is one node. Then all ways through it.
class Layout {
 public:
  Layout(std::size_t most_places) : most_places_(most_places) {}

  std::vector<ShownSurface> surfaces_of(const std::vector<Placement>& objects,
                                        const std::shared_ptr<const Footprint>& footprint) {
    for (const Child& child : place(objects, footprint, 0)) add_places(child.node, child.to_parent);
    std::vector<ShownSurface> surfaces;
    for (const int node : order_) surfaces.push_back(std::move(nodes_[std::size_t(node)].surface));
    return surfaces;
  }

 private:
  struct Child {
    int node;
    Affine3d to_parent;
  };
  struct Node {
    ShownSurface surface;  // or
    std::vector<Child> children;
  };

  std::vector<Child> place(const std::vector<Placement>& placements, const std::shared_ptr<const Footprint>& footprint,
                           Key individual) {
    std::vector<Child> children;
    for (const Placement& placed : placements) {
      const auto [p, seen_as] = shown_placement(placed, footprint);
      const Key own = placed_individual(individual, p);
      if (!can_share(p, seen_as.get())) {
        children.push_back({make(*p.part, seen_as, own), p.to_parent});
        continue;
      }
      const auto key = std::tuple(p.part.get(), own, constant_size(seen_as.get()));
      auto known = shared_.find(key);
      if (known == shared_.end()) known = shared_.emplace(key, make(*p.part, seen_as, own)).first;
      children.push_back({known->second, p.to_parent});
    }
    return children;
  }

  int make(const Part& part, const std::shared_ptr<const Footprint>& footprint, Key individual) {
    Node node;
    if (part.model && !part.placer)
      node.surface = {part.model, footprint, individual, {}};
    else
      node.children = place(part.model ? standing_on(part, individual) : part.members, footprint, individual);
    nodes_.push_back(std::move(node));
    return int(nodes_.size()) - 1;
  }

  // What stands on a ground does not depend on the view, so the ground is expanded in full.
  static std::vector<Placement> standing_on(const Part& part, Key individual) {
    std::vector<Placement> placements;
    visit_cells(*part.model, root_cell(*part.model, nullptr, individual), 0, 0, 1,
                [&](const Expansion& ground, double) {
                  const auto furnishing = part.placer->furnish(ground.mesh, individual);
                  furnishing->place(0, furnishing->face_count(), placements);
                });
    return placements;
  }

  void add_places(int index, const Affine3d& to_world) {
    Node& node = nodes_[std::size_t(index)];
    for (const Child& child : node.children) add_places(child.node, to_world * child.to_parent);
    if (!node.surface.model) return;
    if (places_ == most_places_) throw TooMany(fmt::format("surfaces stand in more than {} places", most_places_));
    ++places_;
    if (node.surface.places.empty()) order_.push_back(index);
    node.surface.places.push_back(to_world);
  }

  const std::size_t most_places_;
  std::size_t places_ = 0;
  std::vector<Node> nodes_;
  std::map<std::tuple<const Part*, Key, double>, int> shared_;
  std::vector<int> order_;  // of the surfaces
};

}  // namespace

std::vector<ShownSurface> shown_surfaces(const std::vector<Placement>& objects,
                                         const std::shared_ptr<const Footprint>& footprint, std::size_t most_places) {
  return Layout(most_places).surfaces_of(objects, footprint);
}

void for_each_tessellation(const ShownSurface& surface,
                           const std::function<void(const Tessellation& cell, double done)>& visit) {
  visit_cells(*surface.model, root_cell(*surface.model, surface.footprint.get(), surface.individual), 0, 0, 1,
              [&](const Expansion& expansion, double done) { visit(*expansion.leaf, done); });
}

}  // namespace meristem
