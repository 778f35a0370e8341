#include "geometry/accel/surface_patch.h"

#include <algorithm>
#include <smmintrin.h>

namespace meristem {

namespace {

void store(__m128 v, Vec3f& to) {
  _mm_storel_pi(reinterpret_cast<__m64*>(&to.x), v);
  _mm_store_ss(&to.z, _mm_movehl_ps(v, v));
}
template <int lane>
__m128 all(__m128 v) {
  return _mm_shuffle_ps(v, v, _MM_SHUFFLE(lane, lane, lane, lane));
}
__m128 absolute(__m128 v) { return _mm_andnot_ps(_mm_set1_ps(-0.f), v); }

// In the order of vec.h, hence with its bits; in all lanes.
__m128 dot(__m128 a, __m128 b) {
  const __m128 products = _mm_mul_ps(a, b);
  return _mm_add_ps(_mm_add_ps(all<0>(products), all<1>(products)), all<2>(products));
}
__m128 normalize(__m128 v) {
  const __m128 length = _mm_sqrt_ps(dot(v, v));
  return _mm_and_ps(_mm_div_ps(v, length), _mm_cmpgt_ps(length, _mm_setzero_ps()));
}
__m128 cross(__m128 a, __m128 b) {
  auto forward = [](__m128 v) { return _mm_shuffle_ps(v, v, _MM_SHUFFLE(3, 0, 2, 1)); };
  auto back = [](__m128 v) { return _mm_shuffle_ps(v, v, _MM_SHUFFLE(3, 1, 0, 2)); };
  return _mm_sub_ps(_mm_mul_ps(forward(a), back(b)), _mm_mul_ps(back(a), forward(b)));
}
bool is_zero(__m128 v) { return (_mm_movemask_ps(_mm_cmpneq_ps(v, _mm_setzero_ps())) & 7) == 0; }

// The weights of a triangle's corners, each in all lanes.
struct Weights {
  __m128 first, second, third;

  Weights(float u, float v) : first(_mm_set1_ps(1 - u - v)), second(_mm_set1_ps(u)), third(_mm_set1_ps(v)) {}
  __m128 blend(__m128 a, __m128 b, __m128 c) const {
    return _mm_add_ps(_mm_add_ps(_mm_mul_ps(a, first), _mm_mul_ps(b, second)), _mm_mul_ps(c, third));
  }
};

// What PackedNormal::unpack() and UvFrame::unpack() make of the attributes of three vertices.
struct UnpackedAttributes {
  __m128 normals[3];
  __m128 uvs[3];  // the first two lanes

  // Without u, v they are all zero.
  UnpackedAttributes(const SurfaceVertices& vertices, const std::array<std::uint32_t, 3>& corners,
                     const UvFrame& frame) {
    const auto words = [&](int k) { return vertices.attributes(corners[std::size_t(k)]); };
    if (vertices.has_uv()) {
      const auto both = [&](int k) { return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(words(k))); };
      const __m128i first = both(0), second = both(1), third = both(2);
      unpack_uvs(first, second, third, frame);
      unpack_normals(first, second, third);
    } else {
      const auto normal = [&](int k) { return _mm_cvtsi32_si128(int(*words(k))); };
      uvs[0] = uvs[1] = uvs[2] = _mm_setzero_ps();
      unpack_normals(normal(0), normal(1), normal(2));
    }
  }

 private:
  void unpack_uvs(__m128i a, __m128i b, __m128i c, const UvFrame& frame) {
    const __m128 lower = _mm_setr_ps(frame.lower.x, frame.lower.y, 0, 0);
    const __m128 step = _mm_setr_ps(frame.step.x, frame.step.y, 0, 0);
    auto unpack = [&](__m128i p) {
      const __m128 steps = _mm_cvtepi32_ps(_mm_cvtepu16_epi32(_mm_srli_epi64(p, 32)));
      return _mm_add_ps(lower, _mm_mul_ps(step, steps));
    };
    uvs[0] = unpack(a), uvs[1] = unpack(b), uvs[2] = unpack(c);
  }

  // One vertex a lane.
  void unpack_normals(__m128i a, __m128i b, __m128i c) {
    const __m128i pairs = _mm_unpacklo_epi64(_mm_unpacklo_epi32(a, b), c);  // of numbers; the last is not used
    const __m128 largest = _mm_set1_ps(PackedNormal::largest), one = _mm_set1_ps(1), sign = _mm_set1_ps(-0.f);
    const __m128 u = _mm_div_ps(_mm_cvtepi32_ps(_mm_srai_epi32(_mm_slli_epi32(pairs, 16), 16)), largest);
    const __m128 v = _mm_div_ps(_mm_cvtepi32_ps(_mm_srai_epi32(pairs, 16)), largest);
    const __m128 upper_u = _mm_sub_ps(one, absolute(u)), upper_v = _mm_sub_ps(one, absolute(v));
    __m128 z = _mm_sub_ps(upper_u, absolute(v));
    const __m128 is_folded = _mm_cmplt_ps(z, _mm_setzero_ps());
    __m128 x = _mm_blendv_ps(u, _mm_xor_ps(upper_v, _mm_and_ps(u, sign)), is_folded);
    __m128 y = _mm_blendv_ps(v, _mm_xor_ps(upper_u, _mm_and_ps(v, sign)), is_folded);
    const __m128 length = _mm_sqrt_ps(_mm_add_ps(_mm_add_ps(_mm_mul_ps(x, x), _mm_mul_ps(y, y)), _mm_mul_ps(z, z)));
    x = _mm_div_ps(x, length), y = _mm_div_ps(y, length), z = _mm_div_ps(z, length);  // the length is never zero
    __m128 unused = _mm_setzero_ps();
    _MM_TRANSPOSE4_PS(x, y, z, unused);
    normals[0] = x, normals[1] = y, normals[2] = z;
  }
};

// The gradients of P along u and v over the triangle (in its plane): zero if u, v do not vary.
void set_tangents(__m128 e1, __m128 e2, __m128 uv1, __m128 uv2, SurfaceHit& hit) {
  const __m128 u1 = all<0>(uv1), v1 = all<1>(uv1), u2 = all<0>(uv2), v2 = all<1>(uv2);
  auto gradient = [&](__m128 a1, __m128 b1, __m128 a2, __m128 b2) {
    const __m128 determinant = _mm_sub_ps(_mm_mul_ps(a1, b2), _mm_mul_ps(b1, a2));
    const __m128 along = _mm_sub_ps(_mm_mul_ps(e1, b2), _mm_mul_ps(e2, b1));
    return _mm_and_ps(_mm_div_ps(along, determinant), _mm_cmpneq_ps(determinant, _mm_setzero_ps()));
  };
  store(gradient(u1, v1, u2, v2), hit.dpdu);
  store(gradient(v1, u1, v2, u2), hit.dpdv);
}

// A shading normal is kept at least this far (as a cosine) on the side of the geometric one.
constexpr float least_normal_cosine = 0.01f;

__m128 on_side_of(__m128 shading, __m128 geometric) {
  const __m128 cosine = dot(shading, geometric), least = _mm_set1_ps(least_normal_cosine);
  if (_mm_cvtss_f32(cosine) >= least_normal_cosine) return normalize(shading);
  const __m128 raised = normalize(_mm_add_ps(shading, _mm_mul_ps(geometric, _mm_sub_ps(least, cosine))));
  return is_zero(raised) ? geometric : raised;
}

// What the tree is built from reads 16 bytes of the last position.
Tessellation& with_room_behind(Tessellation& t) {
  t.positions.reserve(t.positions.size() + 1);
  return t;
}

}  // namespace

SurfacePatch::SurfacePatch(Tessellation t, bool parallel)
    : tree_(with_room_behind(t), parallel),
      faces_(std::move(static_cast<SurfaceFaces&>(t))),
      vertices_(std::move(t.positions), t.attributes, t.has_uv) {}

SurfacePatch::SurfacePatch(SurfaceFaces faces, SurfaceVertices vertices, std::vector<SurfaceTree::Node> nodes)
    : tree_(faces, std::move(nodes)), faces_(std::move(faces)), vertices_(std::move(vertices)) {}

namespace {

TriangleSource source_of(const SurfaceFaces& t, const SurfaceTree::Triangle& triangle) {
  if (triangle.index != SurfaceTree::none) {
    const SurfaceFaces::TriangleSource& source = t.triangle_sources[triangle.index];
    return {source.origin, source.leaf, 0};
  }
  const auto& grids = t.grids;  // by their vertices
  const SurfaceFaces::Grid& grid =
      triangle.grid != SurfaceTree::none
          ? grids[triangle.grid]
          : *(std::ranges::upper_bound(grids, triangle.corners[0], {}, &SurfaceFaces::Grid::first_vertex) - 1);
  return {grid.origin, grid.leaf, grid.coarser};
}

}  // namespace

void SurfacePatch::prefetch(const TreeHit& hit) const {
  const SurfaceTree::Triangle triangle = tree_.triangle(hit.triangle);
  for (const std::uint32_t corner : triangle.corners) __builtin_prefetch(vertices_.attributes(corner));
  if (triangle.index != SurfaceTree::none)
    __builtin_prefetch(&faces_.triangle_sources[triangle.index]);
  else if (triangle.grid != SurfaceTree::none)
    __builtin_prefetch(&faces_.grids[triangle.grid]);
}

void SurfacePatch::surface_at(const TreeHit& met, SurfaceHit& hit) const {
  const SurfaceTree::Triangle triangle = tree_.triangle(met.triangle);
  for (const std::uint32_t corner : triangle.corners) __builtin_prefetch(vertices_.attributes(corner));
  meristem::surface_at(faces_, vertices_, triangle.corners, met.u, met.v, source_of(faces_, triangle), hit);
}

void surface_at(const SurfaceFaces& faces, const SurfaceVertices& vertices, const std::array<std::uint32_t, 3>& c,
                float u, float v, const TriangleSource& source, SurfaceHit& hit) {
  const SurfaceFaces::Leaf& leaf = faces.leaves[source.leaf];
  hit.level = leaf.level - source.coarser;
  hit.origin = faces.origins[source.origin];  // first: it may have to come from memory
  const Weights weights(u, v);

  const PositionView positions = vertices.positions();
  const __m128 p0 = positions.lanes(c[0]), p1 = positions.lanes(c[1]), p2 = positions.lanes(c[2]);
  const __m128 e1 = _mm_sub_ps(p1, p0), e2 = _mm_sub_ps(p2, p0);
  store(weights.blend(p0, p1, p2), hit.position);
  // Three products and two sums: gamma(5) of the sum of magnitudes (Pharr et al. 2023, sec. 6.8.4). The last term keeps
  // a floor under it where a coordinate is exactly zero.
  const __m128 magnitude = _mm_add_ps(_mm_add_ps(absolute(p0), absolute(e1)), absolute(e2));
  const __m128 largest = _mm_max_ps(all<0>(magnitude), _mm_max_ps(all<1>(magnitude), all<2>(magnitude)));
  store(_mm_add_ps(_mm_mul_ps(magnitude, _mm_set1_ps(5 * 0x1p-24f)), _mm_mul_ps(largest, _mm_set1_ps(0x1p-24f))),
        hit.position_error);

  const UnpackedAttributes attributes(vertices, c, leaf.uv_frame);
  const __m128 shading = weights.blend(attributes.normals[0], attributes.normals[1], attributes.normals[2]);
  __m128 geometric = normalize(cross(e1, e2));
  if (is_zero(geometric)) geometric = normalize(shading);  // a degenerate triangle
  store(geometric, hit.geometric_normal);
  store(on_side_of(shading, geometric), hit.shading_normal);

  if (!vertices.has_uv()) {
    hit.u = hit.v = 0;
    hit.dpdu = hit.dpdv = {};
    return;
  }
  const __m128* const uvs = attributes.uvs;
  const __m128 uv = weights.blend(uvs[0], uvs[1], uvs[2]);
  hit.u = _mm_cvtss_f32(uv);
  hit.v = _mm_cvtss_f32(all<1>(uv));
  set_tangents(e1, e2, _mm_sub_ps(uvs[1], uvs[0]), _mm_sub_ps(uvs[2], uvs[0]), hit);
}

}  // namespace meristem
