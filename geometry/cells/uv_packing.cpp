#include "geometry/cells/uv_packing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>

namespace meristem {

namespace {

constexpr std::uint64_t most_steps = 65535;

std::array<double, 2> lanes(__m128d v) {
  std::array<double, 2> result;
  _mm_storeu_pd(result.data(), v);
  return result;
}

}  // namespace

bool UvRange::fits() const {
  const auto low = lanes(low_), high = lanes(high_), digits = lanes(digits_);
  for (std::size_t i = 0; i < 2; ++i) {
    if (!(low[i] > 0x1p16 && high[i] < 0x1p17)) return low[i] > high[i];  // too large; or there are none
    const auto range = std::bit_cast<std::uint64_t>(high[i]) - std::bit_cast<std::uint64_t>(low[i]);
    if (range >> std::countr_zero(std::bit_cast<std::uint64_t>(digits[i])) > most_steps) return false;
  }
  return true;
}

UvFrame UvRange::frame() const {
  const auto low = lanes(low_), high = lanes(high_), digits = lanes(digits_);
  if (low[0] > high[0]) return {};
  const auto value = [](double fixed) { return float(fixed - offset); };
  const Vec2f lower{value(low[0]), value(low[1])};
  if (!fits()) return UvFrame::over(lower, {value(high[0]), value(high[1])});
  const auto step = [](double used) {
    return float(std::ldexp(0x1p-36, std::countr_zero(std::bit_cast<std::uint64_t>(used))));
  };
  return {lower, {step(digits[0]), step(digits[1])}};
}

namespace {

// As UvFrame::pack() does where nothing is lost.
void pack_exactly(const std::vector<Vec2f>& vertex_uv, const UvFrame& frame, std::vector<PackedAttributes>& out) {
  const __m128 lower = _mm_setr_ps(frame.lower.x, frame.lower.y, 0, 0);
  const __m128 steps = _mm_setr_ps(1 / frame.step.x, 1 / frame.step.y, 0, 0);
  for (std::size_t v = 0; v < vertex_uv.size(); ++v) {
    const __m128i number = _mm_cvtps_epi32(_mm_mul_ps(_mm_sub_ps(load_uv(vertex_uv[v]), lower), steps));
    const auto both = std::uint64_t(_mm_cvtsi128_si64(number));
    out[v].uv = {std::uint16_t(both), std::uint16_t(both >> 32)};
  }
}

// Grids and triangles by the frames that hold them.
class FrameGroups {
 public:
  FrameGroups(std::vector<Vec2f>& vertex_uv, std::span<const UvRange> of_grids, Tessellation& out)
      : vertex_uv_(vertex_uv), out_(out), group_of_vertex_(vertex_uv.size(), none) {
    for (std::size_t g = 0; g < of_grids.size(); ++g) add_grid(out.grids[g], of_grids[g]);
    for (std::size_t t = 0; t < out.triangles.size(); ++t) add_triangle(out.triangles[t], out.triangle_sources[t]);
    std::vector<UvFrame> frames;
    for (const UvRange& group : groups_) frames.push_back(group.frame());
    std::vector<Tessellation::Leaf> leaves;
    for (const auto& [leaf, group] : leaves_) leaves.push_back({frames[group], out.leaves[leaf].level});
    out.leaves = std::move(leaves);
    for (std::size_t v = 0; v < vertex_uv.size(); ++v)
      if (group_of_vertex_[v] != none) out.attributes[v].uv = frames[group_of_vertex_[v]].pack(vertex_uv[v]);
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  void add_grid(Tessellation::Grid& grid, const UvRange& range) {
    const std::uint32_t group = group_for(range);
    std::fill_n(&group_of_vertex_[grid.first_vertex], std::size_t(grid.width) * grid.height, group);
    grid.leaf = leaf_for(grid.leaf, group);
  }

  void add_triangle(std::array<std::uint32_t, 3>& corners, Tessellation::TriangleSource& source) {
    UvRange range;
    for (const std::uint32_t v : corners) range.add(vertex_uv_[v]);
    const std::uint32_t group = group_for(range);
    for (std::uint32_t& v : corners) v = vertex_in(v, group);
    source.leaf = leaf_for(source.leaf, group);
  }

  // One of the last that holds it as well; what fits into none has a frame of its own.
  std::uint32_t group_for(const UvRange& range) {
    constexpr std::size_t most_tried = 8;
    for (std::size_t i = groups_.size(); i-- > 0 && i + most_tried >= groups_.size();) {
      UvRange both = groups_[i];
      both.add(range);
      if (!both.fits()) continue;
      groups_[i] = both;
      return std::uint32_t(i);
    }
    groups_.push_back(range);
    return std::uint32_t(groups_.size()) - 1;
  }

  std::uint32_t vertex_in(std::uint32_t v, std::uint32_t group) {
    if (group_of_vertex_[v] == none) group_of_vertex_[v] = group;
    if (group_of_vertex_[v] == group) return v;
    const auto [at, is_new] = doubled_.try_emplace({v, group}, std::uint32_t(vertex_uv_.size()));
    if (is_new) {
      out_.positions.push_back(out_.positions[v]);
      out_.attributes.push_back(out_.attributes[v]);
      vertex_uv_.push_back(vertex_uv_[v]);
      group_of_vertex_.push_back(group);
    }
    return at->second;
  }

  std::uint32_t leaf_for(std::uint32_t leaf, std::uint32_t group) {
    const std::pair wanted(leaf, group);
    const auto at = std::find(leaves_.rbegin(), leaves_.rend(), wanted);
    if (at != leaves_.rend()) return std::uint32_t(leaves_.rend() - at) - 1;
    leaves_.push_back(wanted);
    return std::uint32_t(leaves_.size()) - 1;
  }

  std::vector<Vec2f>& vertex_uv_;
  Tessellation& out_;
  std::vector<UvRange> groups_;
  std::vector<std::uint32_t> group_of_vertex_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> doubled_;  // by vertex and group
  std::vector<std::pair<std::uint32_t, std::uint32_t>> leaves_;               // those before, and groups
};

}  // namespace

void pack_uv(std::vector<Vec2f>& vertex_uv, std::span<const UvRange> of_grids, Tessellation& out) {
  UvRange all;
  for (const UvRange& grid : of_grids) all.add(grid);
  const std::size_t first_of_triangles = out.triangles.empty() ? vertex_uv.size() : 0;
  for (std::size_t v = first_of_triangles; v < vertex_uv.size(); ++v) all.add(vertex_uv[v]);
  if (!all.fits()) {
    FrameGroups(vertex_uv, of_grids, out);
    return;
  }
  const UvFrame frame = all.frame();
  for (Tessellation::Leaf& leaf : out.leaves) leaf.uv_frame = frame;
  pack_exactly(vertex_uv, frame, out.attributes);
}

std::vector<Vec2f> vertex_uv(const Tessellation& t) {
  std::vector<Vec2f> result(t.positions.size());
  const auto unpack = [&](std::uint32_t v, std::uint32_t leaf) {
    result[v] = t.leaves[leaf].uv_frame.unpack(t.attributes[v].uv);
  };
  for (const Tessellation::Grid& grid : t.grids)
    for (std::uint32_t i = 0; i < std::uint32_t(grid.width) * grid.height; ++i)
      unpack(grid.first_vertex + i, grid.leaf);
  for (std::size_t i = 0; i < t.triangles.size(); ++i)
    for (const std::uint32_t v : t.triangles[i]) unpack(v, t.triangle_sources[i].leaf);
  return result;
}

}  // namespace meristem
