// How much of a tree is drawn, by the size of a pixel there: the degradation by range of Weber and Penn (section 5 of
// the paper) in fractions, what this tree model makes of them, and how it goes on beyond them.
//
// The paper measures distance in an effective range r: metres for an image of 1000 lines under 60 degrees. With it each
// kind of part is drawn as triangles, then as lines or points, of which ever fewer remain. Here a line is a ribbon, one
// face a stem, a point a leaf of one face. Those that remain stand for the others: they are wider, or larger, so that
// what the tree covers and its colour stay, and never much smaller than a pixel, so that a tree of a few pixels is some
// tens of faces. Which ones remain follows from an order among the children of each stem. Pure functions.
#pragma once

#include "procedural/plants/stem_mesh.h"

#include <array>

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
  double stem_share = 1;   // of the stems of this level that are there, those that are drawn
  double child_share = 1;  // of the children of each, stems or leaves, those that are there
  // Of leaves:
  double leaf_length = 0, leaf_width = 0;  // of those that remain
  double leaf_faces = 1;                   // of these, the share that is drawn in full, not as one face
  bool are_cards = false;                  // whether each stands for several: one face, not refined any further
};

// Of the parts of a level (`p.levels`: of the leaves) the share that is there at all.
double kept_share(const WeberPennParameters& p, int level, double footprint);

// The same of all levels, for one footprint; what is asked of many stems.
class KeptShares {
 public:
  KeptShares(const WeberPennParameters& p, double footprint);
  double footprint() const { return footprint_; }
  double of(int level) const { return shares_[std::size_t(level)]; }

 private:
  double footprint_;
  std::array<double, most_stem_levels + 1> shares_;
};

// Of a stem of that level and base radius, with segments of that length, where a pixel is `footprint` metres wide; 0:
// everything in full.
PlantDetail plant_detail(const WeberPennParameters& p, int level, double radius, double segment, double footprint,
                         bool is_smoothed);
// At the footprint of these.
PlantDetail plant_detail(const WeberPennParameters& p, int level, double radius, double segment,
                         const KeptShares& shares, bool is_smoothed);

// The longest that a leaf becomes, and the furthest that one which is drawn so reaches from its foot.
double longest_leaf(const WeberPennParameters& p);
double leaf_reach(const WeberPennParameters& p, double length, double width);

}  // namespace meristem
