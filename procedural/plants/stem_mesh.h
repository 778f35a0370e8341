// The surface of a stem: rings of vertices along its axis, welded where it forks, closed at root and tip.
//
// At a fork the ring becomes an outline around both axes; a chain of new vertices across it is the saddle of the
// crotch, and half of the outline with the chain is the ring on which each branch goes on (the fork of
// procedural/growth/templates/fork.cpp, for axes that are given). Several clones fork two by two.
//
// u runs around the stem in two mirrored cycles, and along a branch continues that of the stem; where both branches
// disagree on the chain it is the mean (Tobler, Maierhofer and Wilkie, section 5). v is the length in metres from the
// root.
//
// The root lies on the parent's axis, no thicker than the parent there, so that it is hidden inside.
#pragma once

#include "procedural/plants/plant_mesh.h"
#include "procedural/plants/stem.h"

namespace meristem {

// How finely a stem is drawn.
struct StemDetail {
  std::uint32_t sides = 8;   // corners of a cross-section; a multiple of 4
  int most_rings = 4;        // in a segment, for the sake of faces that are not too long
  double bend = 25;          // most degrees from ring to ring
  double aspect = 4;         // length over width of faces, as far as most_rings goes
  bool is_smoothed = false;  // whether subdivision follows: then the rings are the control points of that surface
  bool has_flare = true;     // whether a trunk has rings of its own where it widens at the ground
  double widening = 1;       // factor on the radius, of stems that stand for others
  bool is_final = false;     // whether no subdivision will make it finer; then it is not smoothed either
  bool is_ribbon = false;    // one face from each fork to the next or to a tip, for stems that are thinner than a pixel
};

// What the faces of stems carry; parameters are level, radius of the stem here, length of the stem.
struct StemFaces {
  std::int32_t material = -1;
  std::int16_t symbol = -1;
  std::uint16_t production = no_production;
};

void mesh_stem(const Stem& stem, const WeberPennParameters& p, const StemDetail& detail, const StemFaces& faces,
               PlantMesh& out);

// Half the width of a ribbon, in radii: turned at random, it covers as much as the stem.
constexpr double ribbon_width = pi / 2;
// It is no wider than twice this part of the stem's length.
constexpr double widest_ribbon = 0.12;
// Of a ring of control points, so that the smooth surface has radius 1.
double cage_radius(std::uint32_t sides);
// How far the surface of a stem that is no thicker than `radius` may lie from its axis.
double most_section(const Stem& stem, const WeberPennParameters& p, const StemDetail& detail, double radius);
// About how many faces a segment has.
double faces_of_segment(const StemDetail& detail);

}  // namespace meristem
