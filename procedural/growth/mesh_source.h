// MeshSource: a polygon mesh with named faces that the user writes down, inline or as an OBJ or PLY file beside the
// scene; for the template "mesh" and the base "mesh".
//
//   "vertices": [[0,0,0], ...], "polygons": [[0,1,2,3], ...], "names": ["socket", "tip", ...], "uv": [[0,0], ...]
//   "file": "leaf.obj"
//
// names: one a polygon, may be shorter; uv: one a vertex, may be missing. Faces run counter-clockwise seen from
// outside.
#pragma once

#include "geometry/base/params.h"
#include "geometry/io/polygon_mesh.h"
#include "procedural/growth/named_faces.h"

#include <string>
#include <vector>

namespace meristem {

struct NamedMesh {
  NamedFaces faces;  // without border; names index `names`
  std::vector<std::string> names;
  bool has_uv = false;
};

class MeshSource {
 public:
  // Reads the parameters above; inline data at once, files by load().
  explicit MeshSource(Params& params);
  const Location& location() const { return location_; }
  // The mesh; files are looked for in `folder` and may not leave it. Empty, and an error, if it is not a manifold.
  NamedMesh load(const std::string& folder, Diagnostics& diagnostics) const;

 private:
  void read_vertices(const Value& list, Diagnostics& diagnostics);
  void read_uv(const Value& list, Diagnostics& diagnostics);
  void read_polygons(const Value& list, const Value* names, Diagnostics& diagnostics);
  void report_conflict(const PolygonMesh& mesh, Diagnostics& diagnostics) const;
  NamedMesh load_file(const std::string& folder, Diagnostics& diagnostics) const;

  Location location_;
  std::string file_;
  std::vector<Vec2d> uv_;
  NamedMesh inline_;
};

// The index of the name in the list, appended if it is new.
int index_of_name(std::vector<std::string>& names, const std::string& name);

}  // namespace meristem
