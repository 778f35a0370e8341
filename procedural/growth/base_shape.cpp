#include "procedural/growth/base_shape.h"

#include "geometry/mesh/refine.h"

#include <algorithm>
#include <map>

namespace meristem {

namespace {

constexpr Key vertex_salt = hash_text("base vertex");
constexpr Key face_salt = hash_text("base face");

void copy_faces(const NamedFaces& faces, const BaseContext& context, Mesh& mesh) {
  for (std::uint32_t v = 0; v < faces.vertices.size(); ++v)
    mesh.add_vertex(faces.vertices[v], hash_keys(vertex_salt, v));
  for (std::uint32_t f = 0; f < faces.face_count(); ++f) {
    const Key key = hash_keys(face_salt, f);
    mesh.origins.push_back({key, context.material, -1, context.production, {}});
    mesh.add_face(faces.face(f), key, f);
  }
  mesh.corner_uv = faces.corner_uv;
  const auto& sharpness = faces.corner_sharpness;
  if (std::any_of(sharpness.begin(), sharpness.end(), [](float s) { return s > 0; })) mesh.corner_sharpness = sharpness;
}

}  // namespace

BaseShape::FaceSymbol BaseShape::read_symbol(Params& params, const char* name, const char* doc) {
  FaceSymbol symbol{params.text(name, "", doc), {}};
  if (!params.describing()) symbol.location = params.location_of(name);
  return symbol;
}

Mesh BaseShape::build(BaseContext& context) const {
  const NamedFaces faces = outline(context);
  Mesh mesh;
  copy_faces(faces, context, mesh);
  if (keeps_seams() && corners_differ(mesh)) meristem::keep_seams(mesh);

  const Symbols no_variables;
  std::map<int, Successor> successors;
  for (std::uint32_t f = 0; f < faces.face_count(); ++f) {
    const int name = faces.names[f];
    const FaceSymbol* symbol = symbol_of(name);
    if (!symbol || symbol->text.empty()) continue;
    if (!successors.count(name))
      successors[name] = Successor(symbol->text, symbol->location, no_variables, context.symbols, context.diagnostics);
    successors[name].evaluate({}, mesh.face_keys[f], context.seed, mesh.origins[f]);
  }
  return mesh;
}

void snap_to_grid(Mesh& mesh, const Quantum& quantum) {
  for (Vec3d& p : mesh.positions) p = quantum.round(p);
}

NamedFaces make_prism(std::span<const Vec3d> ring, std::span<const double> u, double height, PrismNames names,
                      double crease) {
  const auto n = std::uint32_t(ring.size());
  NamedFaces faces;
  for (Vec3d p : ring) faces.add_vertex(p);
  for (Vec3d p : ring) faces.add_vertex(p + Vec3d{0, height, 0});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    faces.add_face(names.side, {i, j, n + j, n + i}, {{u[i], 0}, {u[j], 0}, {u[j], height}, {u[i], height}});
  }
  for (std::uint32_t i = 0; i < n; ++i) faces.add_corner(n + i, {u[i], height});
  faces.end_face(names.cap);
  for (std::uint32_t i = n; i-- > 0;) faces.add_corner(i, {u[i], 0});
  faces.end_face(names.bottom);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    faces.crease_edge(i, j, float(crease));
    faces.crease_edge(n + i, n + j, float(crease));
  }
  return faces;
}

}  // namespace meristem
