// The geometry of a scene as a mesh file, as the scene's camera would show it: expanded, in its level of detail. Other
// renderers then trace the same triangles. Cells are expanded one after another and written at once, so memory stays
// small. One thread.
#pragma once

#include "renderer/interchange/mesh_writer.h"
#include "renderer/loading/load_scene.h"

#include <functional>
#include <string>
#include <vector>

namespace meristem {

struct ExportFigures {
  std::size_t surfaces = 0, places = 0;       // of these surfaces
  std::uint64_t vertices = 0, triangles = 0;  // of the surfaces, each once
  std::uint64_t shown_triangles = 0;          // in all places
  std::vector<MaterialLook> materials;        // those that are used
};

// `scene` was loaded with keep_objects. `progress` is told the share that is done and the triangles so far.
ExportFigures export_scene(const LoadedScene& scene, MeshWriter& writer,
                           const std::function<void(double done, std::uint64_t triangles)>& progress);

// The camera of a scene as other programs know one: without a lens.
MeshCamera mesh_camera(const Scene& scene);

}  // namespace meristem
