// Atmosphere: the light of a clear sky, by integrating scattering in a spherical atmosphere.
//
// Rayleigh and aerosol (Mie) scattering and ozone absorption at three wavelengths (680, 550, 440 nm) that stand for
// Rec.709 red, green and blue, with the densities and coefficients of Bruneton and Neyret 2008, "Precomputed
// Atmospheric Scattering", and Bruneton 2017. First-order scattering is integrated along the view ray; all higher
// orders together by the isotropic approximation of Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere
// Rendering Technique", section 5.5. Aerosols follow turbidity after Preetham, Shirley, Smits 1999, appendix A.1
// (Angstrom's law).
//
// The observer stands on the ground; directions have y up; lengths inside are kilometres. The sun's irradiance above
// the atmosphere is 1 in each channel. The constructor makes its tables on all threads; then immutable: any thread.
#pragma once

#include "geometry/base/vec.h"

#include <vector>

namespace meristem {

class Atmosphere {
 public:
  // turbidity from 1 (pure air) to 10 (thick haze); ground_albedo lights the air from below; to_sun: a unit vector.
  Atmosphere(double turbidity, Vec3d ground_albedo, Vec3d to_sun);

  // The part of a ray's light from beyond the atmosphere that reaches the ground; zero from below the horizon.
  Vec3d transmittance(Vec3d direction) const;

  // A piece of a ray through the air, so short that the air is the same all along it. Wherever the ray turns around the
  // vertical, and wherever the sun stands, it is the same.
  struct Piece {
    double distance, radius;  // of its middle: from the ray's origin, from the Earth's centre
    Vec3d rayleigh, mie;      // scattering per kilometre
    Vec3d seen_length;        // the integral of what passes from its points to its near end
    Vec3d through;            // what passes from there to the ray's origin
  };
  // What a direction whose sine of the elevation is `sine`, at least 0, looks through.
  std::vector<Piece> line_of_sight(double sine) const;
  // What the air along a line of sight scatters towards the observer, before the phase functions. While the sun's light
  // reaches all of it, it varies slowly with `between`, the cosine between it and the sun.
  struct Scattered {
    Vec3d rayleigh, mie, multiple;
  };
  Scattered scattered(const std::vector<Piece>& line_of_sight, double between) const;
  // The radiance of that air, the sun itself left out.
  static Vec3d sky_radiance(const Scattered& scattered, double between);
  // Whether the sun lights all that can be seen from the ground: the horizon at the top of the air dips by 10.2
  // degrees.
  bool is_all_lit() const { return to_sun_.y > 0.2; }

 private:
  struct Table {
    int width = 0, height = 0;
    std::vector<Vec3d> values;
    Vec3d at(double x, double y) const;  // bilinear; x, y in [0, 1]
  };

  struct Medium {  // at one height, per kilometre
    Vec3d rayleigh, mie, extinction;
  };
  Medium medium(double radius) const;
  // Of a ray from one radius at a cosine against the vertical; `through`: what passes all of them.
  std::vector<Piece> pieces(double radius, double cosine, double end, int count, Vec3d& through) const;
  Vec3d optical_depth(double radius, double cosine) const;
  // The part of the sun's light that reaches a point; its disk sets over its own width.
  Vec3d sunlight(double radius, double cosine) const;
  Vec3d multiple_scattering(double radius, double sun_cosine) const;
  void fill_transmittance();
  void fill_multiple_scattering();
  struct Ring;
  Ring ring(double radius, double cosine) const;
  Vec3d gathered(const std::vector<Ring>& rings, double radius, double sun_cosine) const;

  const Vec3d to_sun_, ground_albedo_;
  Vec3d mie_scattering_;
  Table transmittance_;        // optical depth to the top, by distance to the top and height
  Table multiple_scattering_;  // by sun cosine and height; only the columns that can be asked for
};

}  // namespace meristem
