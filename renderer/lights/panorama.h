// Panorama: a lat-long image that is looked up by direction, at a point or as the mean over a cone.
//
// Places in it lie in [0, 1]^2, x around the vertical, y from the top down. Means come from a pyramid of coarser
// images, each texel of which is the mean over its solid angle, as in Williams 1983, "Pyramidal Parametrics"; towards
// the poles, where a cone covers more texels across than down, it is several lookups side by side. The pyramid takes a
// third of the image's memory. Immutable; any thread.
#pragma once

#include "renderer/scene/interfaces.h"

#include <vector>

namespace meristem {

class Panorama {
 public:
  Panorama() : Panorama({Spectrum{}}, 1, 1) {}
  // Texels row by row from the top; at least one.
  Panorama(std::vector<Spectrum> texels, int width, int height);

  int width() const { return levels_[0].width; }
  int height() const { return levels_[0].height; }
  // x goes around, y is clamped.
  Spectrum texel(int x, int y) const { return levels_[0].texel(x, y); }
  // Bilinear between the middles of texels.
  Spectrum at(Vec2f place) const { return levels_[0].at(place); }
  // Over a cone as wide as `angle`, in radians; at() where that is narrower than a lookup of texels.
  Spectrum mean(Vec2f place, float angle) const;

 private:
  struct Level {
    int width, height;
    std::vector<Spectrum> texels;
    Spectrum texel(int x, int y) const;
    Spectrum at(Vec2f place) const;
    Level halved() const;
  };
  static Spectrum mean_across(const Level& level, Vec2f place, float angle);

  std::vector<Level> levels_;  // each half as wide and high as the one before, down to a single texel
};

}  // namespace meristem
