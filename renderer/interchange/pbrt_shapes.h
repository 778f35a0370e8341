// The shapes of a pbrt scene as base meshes.
#pragma once

#include "renderer/interchange/foreign_mesh.h"
#include "renderer/interchange/foreign_scene.h"
#include "renderer/interchange/pbrt_parameters.h"

#include <optional>
#include <string>

namespace meristem {

// Without a name and a material; its transform apart: what stands before the object's. Nothing, with a message, if the
// shape is not known or broken.
struct PbrtShape {
  ForeignModel model;
  Affine3d to_object;
};
std::optional<PbrtShape> read_pbrt_shape(const std::string& type, PbrtParameters& params, const std::string& folder,
                                         bool is_reversed, const Location& where, Diagnostics& diagnostics);

}  // namespace meristem
