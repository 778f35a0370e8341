// Overrides of single values of a scene (`--set /lights/0/elevation=40`): applied to the scene as read, before anything
// is made of it, so that they are checked like what the file says, and their mistakes are shown with their place.
//
//   /camera/fov=35                      a path as in RFC 6901 (~1 stands for /, ~0 for ~), and a value
//   /materials/bark/base_color=[.3,.2,.1]
//   /models/branch/steps/1/place=0.3*scale*N
//   /camera/from==[4*sin(frame/10), 1, 4*cos(frame/10)]
//
// The value is JSON if it is a number, true, false, null, or begins with [, { or "; after a second = it is an
// expression of the number of the frame, a number or a vector; anything else is a text. Objects on the way are made if
// they are not there; entries of lists must be.
#pragma once

#include "geometry/base/value.h"

#include <string>

namespace meristem {

void apply_override(Value& scene, const std::string& text, int frame, Diagnostics& diagnostics);

}  // namespace meristem
