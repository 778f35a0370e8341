// How much of a tree is drawn, by the size of a pixel there: the degradation by range of Weber and Penn (section 5 of
// the paper) in fractions, and what this tree model makes of them.
//
// The paper measures distance in an effective range r: metres for an image of 1000 lines under 60 degrees. With it each
// kind of part is drawn as triangles, then as lines or points, of which ever fewer remain. Here a line is a stem with
// the fewest faces, a point a leaf of one face; which stems and leaves remain is drawn by their keys, and the remaining
// leaves grow so that the crown covers as much as before. Pure functions.
#pragma once

#include "procedural/plants/stem_mesh.h"

namespace meristem {

// The paper's fractions. `s` is half the quality in leaf, the whole in winter; `d` is 200, in spring 100.
namespace degradation {
double effective_range(double footprint);
double trunk_faces(double r);
double branch_faces(double r, double s);
double branch_lines(double r, double s);
double twig_faces(double r, double s);
double twig_lines(double r, double s);
double leaf_faces(double r, double d);
double leaf_points(double r, double d);
}  // namespace degradation

struct PlantDetail {
  StemDetail stem;
  double stem_share = 1;   // of the stems of this level that are drawn
  double leaf_share = 1;   // of the leaves
  double leaf_growth = 1;  // factor on the size of those that remain
  double leaf_faces = 1;   // of these, the share that is drawn in full, not as one face
};

constexpr double most_leaf_growth = 3;

// Of a stem of that level and base radius, with segments of that length, where a pixel is `footprint` metres wide; 0:
// everything in full.
PlantDetail plant_detail(const WeberPennParameters& p, int level, double radius, double segment, double footprint,
                         bool is_smoothed);

}  // namespace meristem
