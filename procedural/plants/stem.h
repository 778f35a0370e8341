// Stem: the skeleton of one stem of a tree of Weber and Penn (section 4 of the paper): its axis with all clones, and
// where its children sit. A pure function of what its bud carries, so any stem grows alone: random numbers are hashes
// of the bud's key, and what the paper diffuses as an error over all stems of a level (splits, children) is diffused
// inside one stem from a random start, which has the same statistics.
//
// Where stems split, the axes are moved apart by about a radius over the next segment, so that the welded mesh
// (stem_mesh.h) has room for its fork even where the paper lets clones run inside each other.
#pragma once

#include "procedural/plants/child_rows.h"
#include "procedural/plants/plant_frame.h"
#include "procedural/plants/weber_penn_parameters.h"

#include <vector>

namespace meristem {

// A stem that has not grown yet.
struct StemBud {
  int level = 0;
  Key key = 0;
  Affine3d frame;  // origin on the parent's axis
  double length = 0;
  double radius = 0;
  double children = 0;  // number of stems or leaves on it, on average
  double inset = 0;     // the length that is hidden inside the parent
  double scale = 0;     // of the tree
};

// The bud of a whole tree, from its key alone.
StemBud trunk_bud(const WeberPennParameters& p, const Affine3d& frame, Key key);

// A joint between segments.
struct StemNode {
  Affine3d frame;  // z along the segment that follows
  Vec3d tangent;   // unit
};

// A run of segments from the base or a fork to a fork or a tip.
struct StemPiece {
  int first_segment = 0;
  std::vector<StemNode> nodes;  // one more than segments
  std::vector<int> next;        // the pieces after the fork at its end; none: it ends in a tip
  double share = 1;             // of the children that the stem has along its length
  Key key = 0;
};

struct StemChild {
  StemBud bud;       // of a leaf: frame, key and length
  double place = 0;  // 0 at the first child a stem may have, 1 at its tip
};

class Stem {
 public:
  // `p` must outlive it.
  Stem(const WeberPennParameters& p, const StemBud& bud);

  const StemBud& bud() const { return bud_; }
  const PlantLevel& level() const { return level_; }
  const std::vector<StemPiece>& pieces() const { return pieces_; }
  bool bears_leaves() const { return bud_.level + 1 >= p_.levels; }
  double segment_length() const { return segment_; }

  // On segment i of a piece, t in 0 ... 1.
  Vec3d position(const StemPiece& piece, std::size_t i, double t) const;
  Vec3d tangent(const StemPiece& piece, std::size_t i, double t) const;
  // z in metres along the stem; the second with the flare of a trunk.
  double radius_at(double z) const;
  double flared_radius_at(double z) const;

  // About such a share of the children, spread evenly, in order along each piece; replaces what is in `out`.
  void find_children(ChildRows& out, double share = 1) const;
  // The same with all that stems need to grow.
  void find_children(std::vector<StemChild>& out, double share = 1) const;

 private:
  struct Path;
  bool is_helix() const { return level_.curve_v < 0; }
  void grow_all();
  int grow(Path path);
  void advance(Path& path, int segment) const;
  int clones_after(Path& path, int segment);
  std::vector<Path> split(const Path& path, int segment, int clones) const;
  void move_apart(std::vector<Path>& paths, int segment) const;
  void find_tangents(int piece, Vec3d before);
  void fit_to_envelope();
  bool fits() const;

  double down_angle(Key child, double place) const;
  // 0 where the first child may be, 1 at the tip.
  double place_at(double z) const { return std::clamp((z - bare_) / (bud_.length - bare_), 0.0, 1.0); }
  void add_child(Key key, double z, double place, double around, double away, ChildRows& out) const;
  void add_row(const StemPiece& piece, double share, ChildRows& out) const;
  void add_fan(const StemPiece& piece, double share, ChildRows& out) const;
  void put_on_axis(const StemPiece& piece, std::size_t first, ChildRows& out) const;
  StemChild described(const ChildRows& children, std::size_t i) const;

  const WeberPennParameters& p_;
  StemBud bud_;
  const PlantLevel& level_;
  const PlantLevel& child_level_;
  Draws draws_;
  int segments_;
  double segment_ = 0;           // length of one
  double bare_ = 0;              // the length without children
  double child_length_max_ = 0;  // of this stem's children, in its lengths
  Vec3d helix_axis_;
  int clones_ = 0;  // so far
  std::vector<StemPiece> pieces_;
};

// Bounds on what a stem with such a length and base radius may become, for Step::bound(); over all its levels of
// detail.
struct StemReach {
  double axis = 0;          // of any point of the axis from the root
  double radius = 0;        // of any cross-section
  double child_length = 0;  // of a child
  double child_count = 0;
};
StemReach stem_reach(const WeberPennParameters& p, int level, double length, double radius);
double longest_trunk(const WeberPennParameters& p);
double thickest_trunk(const WeberPennParameters& p);
// About how many segments and children a stem of the level has, clones and all.
double expected_segments(const WeberPennParameters& p, int level);
double expected_children(const WeberPennParameters& p, int level);

}  // namespace meristem
