// A mesh file alone, OBJ or PLY, as a scene: one object, which has the colours of its vertices.
#pragma once

#include "renderer/interchange/foreign_scene.h"

namespace meristem {

// Vertices of PLY files that lie at one place become one, since such files stand them twice where their attributes
// differ; what is no manifold is cut. SceneErrors if the file is broken.
ForeignScene read_mesh_scene(const std::string& path, Diagnostics& diagnostics);

}  // namespace meristem
