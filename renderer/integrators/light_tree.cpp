#include "renderer/integrators/light_tree.h"

#include "renderer/scene/warps.h"

#include <algorithm>

namespace meristem {
namespace {

// Boxes grow by this part of their coordinates: a light is a little wider for a rounded ray than for its bounds.
constexpr float slack = 1e-6f;

// Steradians that the emission covers, weighted by its cosine: Conty Estevez and Kulla 2018, equation 1.
float orientation_measure(const LightBounds& b) {
  const float spread = std::acos(std::clamp(b.cos_normals, -1.f, 1.f));
  const float reach = std::min(spread + std::acos(std::clamp(b.cos_leaving, -1.f, 1.f)), pi_f);
  const float sine = std::sin(spread);
  const float measure =
      2 * pi_f * (1 - std::cos(spread)) +
      pi_f / 2 * (2 * reach * sine - std::cos(spread - 2 * reach) - 2 * spread * sine + std::cos(spread));
  return b.two_sided ? 2 * measure : measure;
}

// What a node costs, up to a factor: its power, by how little is known of where and whither it shines.
float cost_of(const LightBounds& b, float longest_side) {
  // the square of the longest side keeps lights on a line or in one point comparable
  return b.power * orientation_measure(b) * (b.box.surface_area() + 1e-3f * longest_side * longest_side);
}

}  // namespace

LightTree::LightTree(const std::vector<LightBounds>& lights) : leaves_(lights.size(), -1) {
  std::vector<Item> items;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (!(lights[i].power > 0) || !std::isfinite(lights[i].power) || lights[i].box.empty()) continue;
    Item item{lights[i], std::int32_t(i)};
    const Vec3f size = max(abs(item.bounds.box.lower), abs(item.bounds.box.upper));
    item.bounds.box = item.bounds.box.inflated(size * slack);
    items.push_back(item);
  }
  if (items.empty()) return;
  nodes_.reserve(2 * items.size());
  nodes_.emplace_back();
  build(0, items.data(), items.data() + items.size(), 0);
}

void LightTree::build(std::uint32_t node, Item* begin, Item* end, std::size_t depth) {
  LightBounds all;
  for (const Item* i = begin; i != end; ++i) all = united(all, i->bounds);
  nodes_[node].bounds = all;
  if (end - begin == 1) {
    nodes_[node].light = begin->light;
    leaves_[std::size_t(begin->light)] = std::int32_t(node);
    return;
  }
  Item* const middle = split(begin, end, depth);
  const auto child = std::uint32_t(nodes_.size());
  nodes_[node].child = child;
  nodes_.resize(nodes_.size() + 2);
  nodes_[child].parent = nodes_[child + 1].parent = node;
  build(child, begin, middle, depth + 1);
  build(child + 1, middle, end, depth + 1);
}

// Sorts the items into two halves where their costs, in bins along the axes, are least; neither is empty.
LightTree::Item* LightTree::split(Item* begin, Item* end, std::size_t depth) {
  constexpr int bins = 12;
  Bounds3f centers;
  for (const Item* i = begin; i != end; ++i) centers.extend(i->bounds.box.center());
  const Vec3f size = centers.size();
  auto bin_of = [&](const Item& item, int axis) {
    const float x = (item.bounds.box.center()[axis] - centers.lower[axis]) / size[axis];
    return std::min(int(x * bins), bins - 1);
  };
  float best = std::numeric_limits<float>::infinity();
  int best_axis = -1, best_bin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(size[axis] > 0)) continue;
    std::array<LightBounds, bins> filled, above;
    for (const Item* i = begin; i != end; ++i) {
      LightBounds& b = filled[std::size_t(bin_of(*i, axis))];
      b = united(b, i->bounds);
    }
    for (std::size_t b = bins - 1; b > 0; --b)
      above[b - 1] = united(b + 1 < bins ? above[b] : LightBounds{}, filled[b]);
    LightBounds below;
    const float longest = max_component(size);
    for (std::size_t b = 0; b + 1 < bins; ++b) {
      below = united(below, filled[b]);
      if (!(below.power > 0) || !(above[b].power > 0)) continue;
      // thin slices are discouraged: the longest side over this one
      const float cost = (cost_of(below, longest) + cost_of(above[b], longest)) * (longest / size[axis]);
      if (cost < best) best = cost, best_axis = axis, best_bin = int(b);
    }
  }
  const bool deep = depth + 24 > max_depth;
  if (best_axis < 0 || deep) return begin + (end - begin) / 2;
  return std::partition(begin, end, [&](const Item& i) { return bin_of(i, best_axis) <= best_bin; });
}

float LightTree::share_of_first(const Node& node, const Receiver& receiver) const {
  const float first = nodes_[node.child].bounds.importance(receiver);
  const float second = nodes_[node.child + 1].bounds.importance(receiver);
  const float sum = first + second;
  return sum > 0 ? (std::isfinite(sum) ? first / sum : 0.5f) : -1;
}

LightTree::Pick LightTree::pick(const Receiver& receiver, float random) const {
  if (!(importance(receiver) > 0)) return {};
  float probability = 1;
  const Node* node = &nodes_[0];
  while (node->light < 0) {
    const float share = share_of_first(*node, receiver);
    if (share < 0) return {};
    const bool first = random < share;
    const float taken = first ? share : 1 - share;
    random = std::min((first ? random : random - share) / taken, 0x1.fffffep-1f);
    probability *= taken;
    node = &nodes_[node->child + (first ? 0 : 1)];
  }
  return {node->light, probability};
}

float LightTree::probability(const Receiver& receiver, std::size_t light) const {
  if (leaves_[light] < 0 || !(importance(receiver) > 0)) return 0;
  float probability = 1;
  for (auto at = std::uint32_t(leaves_[light]); at != 0; at = nodes_[at].parent) {
    const Node& parent = nodes_[nodes_[at].parent];
    const float share = share_of_first(parent, receiver);
    if (share < 0) return 0;
    probability *= at == parent.child ? share : 1 - share;
  }
  return probability;
}

bool LightTree::crosses(const Ray& ray, float end, const Bounds3f& box) {
  float near = ray.t_min, far = end;
  for (int axis = 0; axis < 3; ++axis) {
    const float d = ray.direction[axis], o = ray.origin[axis];
    if (d == 0) {
      if (o < box.lower[axis] || o > box.upper[axis]) return false;
      continue;
    }
    const float a = (box.lower[axis] - o) / d, b = (box.upper[axis] - o) / d;
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b) * (1 + 4 * std::numeric_limits<float>::epsilon()));
  }
  return near <= far;
}

}  // namespace meristem
