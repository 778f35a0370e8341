// The shapes of a pbrt scene as base meshes.
#pragma once

#include "renderer/interchange/foreign_mesh.h"
#include "renderer/interchange/foreign_scene.h"
#include "renderer/interchange/pbrt_parameters.h"

#include <optional>
#include <string>

namespace meristem {

// What the state says of the surface: turned inside out, and with textures, whose seams stay.
struct PbrtSurface {
  bool is_reversed = false, keeps_seams = false;
};

// Without a name and a material; its transform apart: what stands before the object's. Nothing, with a message, if the
// shape is not known or broken.
struct PbrtShape {
  ForeignModel model;
  Affine3d to_object;
};
std::optional<PbrtShape> read_pbrt_shape(const std::string& type, PbrtParameters& params, const std::string& folder,
                                         PbrtSurface surface, const Location& where, Diagnostics& diagnostics);

}  // namespace meristem
