// sky: the sun and a clear sky over flat ground, from a physical model of the atmosphere (atmosphere.h).
//
// `elevation` is the sun's height above the horizon, down to -12 degrees for twilight; `azimuth` turns it around the
// vertical, 0 towards +z and 90 towards +x. `turbidity` is the haze: 1 pure air, 2 to 3 a clear day, 6 and more milky.
// `sun_size` is the sun's angular diameter; a larger sun gives softer shadows and stays as strong as a whole.
// Below the horizon lies ground of colour `ground_albedo`, lit by sun and sky.
//
// Scaled so that exposure 0 suits a sunny scene: the sun above the atmosphere has irradiance 4, so white paper that
// faces a high sun has radiance about 1, and blue sky about 0.2.
//
// The air is integrated before rendering into a table over half the upper hemisphere, the other half being its mirror
// image. Its rows stand at the squares of even steps in elevation, to keep the bright band at the horizon fine.
// sample() picks sun, sky or ground by the light they give, and inside: the sun's cone uniformly, the sky by the table,
// the ground uniformly.
#include "geometry/base/parallel.h"
#include "renderer/lights/atmosphere.h"
#include "renderer/lights/distribution_2d.h"
#include "renderer/scene/interfaces.h"
#include "renderer/scene/warps.h"

namespace meristem {
namespace {

constexpr double solar_irradiance = 4;
// The darkening of the sun's limb: radiance falls as cos^alpha. Hestroffer and Magnan 1998, at 680, 550 and 440 nm.
const Vec3f limb_exponent{0.397f, 0.503f, 0.652f};

class Sky : public Light {
 public:
  explicit Sky(Params& params) {
    const double elevation = params.real("elevation", 40, {-12, 90, "deg"}, "height of the sun above the horizon");
    const double azimuth = params.real("azimuth", 60, {-360, 360, "deg"}, "direction of the sun: 0 is +z, 90 is +x");
    turbidity_ = params.real("turbidity", 2, {1, 10, ""}, "haze: 1 is pure air");
    intensity_ = params.real("intensity", 1, not_negative, "scales sun, sky and ground");
    sun_intensity_ = params.real("sun_intensity", 1, not_negative, "scales the sun alone");
    const double sun_size = params.real("sun_size", 0.533, {0.01, 60, "deg"}, "angular diameter of the sun");
    ground_albedo_ =
        min(params.color("ground_albedo", {0.25, 0.24, 0.22}, "colour of the ground below the horizon"), Vec3d(1.0));
    visible_ = params.boolean("visible", true, "whether the camera sees it, else nothing; mirrors do anyway");
    const double e = elevation * pi / 180, a = azimuth * pi / 180, radius = sun_size * pi / 360;
    to_sun_ = Vec3d{std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)};
    sun_azimuth_ = float(std::atan2(to_sun_.x, to_sun_.z));
    sun_frame_ = Frame(Vec3f(to_sun_));
    sun_width_ = float(2 * std::pow(std::sin(radius / 2), 2.0));
  }

  void prepare() override {
    const Atmosphere atmosphere(turbidity_, ground_albedo_, to_sun_);
    tabulate_sky(atmosphere);
    tabulate_sun(atmosphere);
    finish();
  }

  LightSample sample(Vec3f, Vec2f random) const override {
    if (random.x < sun_share_)
      return sample_of(normalize(sun_frame_.to_world(uniform_cone(sun_width_, {random.x / sun_share_, random.y}))));
    random.x -= sun_share_;
    if (random.x < ground_share_) {
      const Vec3f d = uniform_cone(1, {random.x / ground_share_, random.y});
      return sample_of({d.x, -std::max(d.z, 1e-6f), d.y});
    }
    random.x = std::clamp((random.x - ground_share_) / sky_share_, 0.f, 0x1.fffffep-1f);
    const Vec2f p = distribution_.sample(random);
    const Vec3f d = from_table(p.x, p.y);
    return sample_of(d, above_horizon(d, p));
  }

  EscapedLight escaped(Vec3f d) const override {
    if (d.y >= 0) return above_horizon(d, to_table(d));
    return {ground_, (in_sun(d) ? sun_pdf() : 0) + ground_share_ / (2 * pi_f)};
  }

  float environment_power() const override { return flux_; }
  bool seen_by_camera() const override { return visible_; }

 private:
  static constexpr int columns = 256, rows = 64;  // columns around the whole horizon
  static constexpr int columns_a_node = 8;

  // The cosine of a direction's elevation, with all digits at the zenith.
  static float across(Vec3f d) { return std::sqrt(d.x * d.x + d.z * d.z); }
  // Table coordinates of a direction above the horizon: x around from the sun, y the root of the elevation.
  Vec2f to_table(Vec3f d) const {
    const float x = (std::atan2(d.x, d.z) - sun_azimuth_) / (2 * pi_f);
    const float elevation = std::atan2(d.y, across(d));
    return {x - std::floor(x), std::sqrt(std::max(0.f, elevation * (2 / pi_f)))};
  }
  template <class T>
  Vec3<T> from_table(T x, T y) const {
    const T turn = T(2 * pi) * x + T(sun_azimuth_), elevation = T(pi / 2) * y * y;
    const T side = std::cos(elevation);
    return {side * std::sin(turn), std::sin(elevation), side * std::cos(turn)};
  }
  // Steradians in a unit of table area: cos(elevation) d(turn) d(elevation) = cos(elevation) (2 pi dx) (pi y dy).
  static float solid_angle_density(float y, float cosine) { return 2 * pi_f * pi_f * y * cosine; }

  // Values stand at column centres and at row edges, so that the horizon and the zenith have their own. Only the phase
  // functions are sharp: where no shadow of the Earth is in sight, the air is integrated at every eighth column's edge.
  void tabulate_sky(const Atmosphere& atmosphere) {
    table_.resize(std::size_t(columns) * (rows + 1));
    parallel_for(rows + 1, [&](std::size_t y) {
      const auto line_of_sight = atmosphere.line_of_sight(from_table(0., double(y) / rows).y);
      const auto between = [&](double x) { return dot(from_table(x / columns, double(y) / rows), to_sun_); };
      std::vector<Atmosphere::Scattered> nodes;
      if (atmosphere.is_all_lit())
        for (int node = -1; node <= columns / 2 / columns_a_node + 1; ++node)
          nodes.push_back(atmosphere.scattered(line_of_sight, between(node * columns_a_node)));
      for (std::size_t x = 0; x < columns / 2; ++x) {
        const double cosine = between(double(x) + 0.5);
        const auto scattered = nodes.empty() ? atmosphere.scattered(line_of_sight, cosine) : between_nodes(nodes, x);
        const Spectrum value(Atmosphere::sky_radiance(scattered, cosine) * (solar_irradiance * intensity_));
        table_[y * columns + x] = table_[y * columns + columns - 1 - x] = value;
      }
    });
  }

  // At the centre of a column, by the cubic through the two nodes on each side; node 1 stands at 0.
  static Atmosphere::Scattered between_nodes(const std::vector<Atmosphere::Scattered>& nodes, std::size_t column) {
    const Atmosphere::Scattered* n = nodes.data() + column / columns_a_node;
    const double t = (double(column % columns_a_node) + 0.5) / columns_a_node;
    const double weights[] = {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
                              (t + 1) * t * (t - 1) / 6};
    Atmosphere::Scattered sum;
    for (int i = 0; i < 4; ++i) {
      sum.rayleigh += n[i].rayleigh * weights[i];
      sum.mie += n[i].mie * weights[i];
      sum.multiple += n[i].multiple * weights[i];
    }
    return sum;
  }

  // The sun's light without limb darkening along the vertical line through its disk: air reddens its lower limb.
  void tabulate_sun(const Atmosphere& atmosphere) {
    const double scale = solar_irradiance * intensity_ * sun_intensity_ / (2 * pi * double(sun_width_));
    const double elevation = std::asin(to_sun_.y), radius = std::acos(1 - double(sun_width_));
    sun_bottom_ = elevation - radius;
    sun_top_ = elevation + radius;
    for (int i = 0; i < sun_rows; ++i) {
      const double angle = sun_bottom_ + (sun_top_ - sun_bottom_) * i / (sun_rows - 1);
      sun_[i] = Spectrum(atmosphere.transmittance({std::cos(angle), std::sin(angle), 0}) * scale);
    }
  }

  // The ground's radiance and what sample() needs, from the integrals of the tables.
  void finish() {
    std::vector<float> weights;
    Spectrum sky_flux, irradiance;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        const Vec3f d(from_table((x + 0.5) / columns, (y + 0.5) / rows));
        const float solid_angle = solid_angle_density((float(y) + 0.5f) / rows, across(d)) / (columns * rows);
        const Spectrum value = sky_at(to_table(d));
        weights.push_back(luminance(value) * solid_angle);
        sky_flux += value * solid_angle;
        irradiance += value * (solid_angle * d.y);
      }
    distribution_ = Distribution2D(std::move(weights), columns, rows);
    const Spectrum sun_flux = sun_mean() * (2 * pi_f * sun_width_);
    irradiance += sun_flux * std::max(0.f, float(to_sun_.y));
    ground_ = Spectrum(ground_albedo_) * irradiance / pi_f;

    const float sun = luminance(sun_flux), sky = luminance(sky_flux), ground = luminance(ground_) * 2 * pi_f;
    flux_ = sun + sky + ground;
    sun_share_ = flux_ > 0 ? sun / flux_ : 0;
    ground_share_ = flux_ > 0 ? ground / flux_ : 0;
    sky_share_ = 1 - sun_share_ - ground_share_;
  }

  // The mean radiance of the disk, rows weighted by their chords; limb darkening keeps the mean.
  Spectrum sun_mean() const {
    Spectrum sum;
    float total = 0;
    for (int i = 0; i < sun_rows; ++i) {
      const float h = 2 * float(i) / (sun_rows - 1) - 1, chord = std::sqrt(std::max(0.f, 1 - h * h));
      sum += sun_[i] * chord;
      total += chord;
    }
    return sum / total;
  }

  static LightSample sample_of(Vec3f direction, const EscapedLight& light) {
    return {direction, std::numeric_limits<float>::infinity(), light.radiance, light.pdf};
  }
  LightSample sample_of(Vec3f direction) const { return sample_of(direction, escaped(direction)); }

  // Of a direction that has this place in the table.
  EscapedLight above_horizon(Vec3f d, Vec2f p) const {
    const float stretch = solid_angle_density(p.y, across(d));
    EscapedLight light{sky_at(p), stretch > 0 ? sky_share_ * distribution_.pdf(p) / stretch : 0};
    if (in_sun(d)) {
      light.radiance += sun_at(d);
      light.pdf += sun_pdf();
    }
    return light;
  }

  Spectrum sky_at(Vec2f p) const {
    const float fx = p.x * columns - 0.5f + columns, fy = std::min(p.y, 1.f) * rows;
    const int ix = int(fx), iy = std::min(int(fy), rows - 1);
    const int left = ix % columns, right = (ix + 1) % columns;
    const Spectrum* row = table_.data() + std::ptrdiff_t(iy) * columns;
    const float tx = fx - float(ix), ty = fy - float(iy);
    return lerp(lerp(row[left], row[right], tx), lerp(row[columns + left], row[columns + right], tx), ty);
  }

  bool in_sun(Vec3f d) const { return one_minus_cosine(d, sun_frame_.n) <= sun_width_; }

  float sun_pdf() const { return sun_share_ * uniform_cone_pdf(sun_width_); }

  Spectrum sun_at(Vec3f d) const {
    const float r2 = std::min(1.f, one_minus_cosine(d, sun_frame_.n) / sun_width_);
    const float cosine = std::sqrt(1 - r2);
    const double along = (std::asin(std::clamp(double(d.y), -1.0, 1.0)) - sun_bottom_) / (sun_top_ - sun_bottom_);
    const double f = std::clamp(along, 0.0, 1.0) * (sun_rows - 1);
    const int i = std::min(int(f), sun_rows - 2);
    Spectrum value = lerp(sun_[i], sun_[i + 1], float(f - i));
    // The mean of cos^alpha over a disk is 2 / (2 + alpha)
    for (int k = 0; k < 3; ++k) value[k] *= std::pow(cosine, limb_exponent[k]) * (1 + limb_exponent[k] / 2);
    return value;
  }

  static constexpr int sun_rows = 16;

  double turbidity_ = 2, intensity_ = 1, sun_intensity_ = 1;
  bool visible_ = true;
  Vec3d ground_albedo_;
  Vec3d to_sun_;
  float sun_azimuth_ = 0;  // radians from +z towards +x
  Frame sun_frame_;
  float sun_width_ = 0;                  // 1 - cos of its angular radius
  double sun_bottom_ = 0, sun_top_ = 0;  // elevations
  Spectrum sun_[sun_rows];
  std::vector<Spectrum> table_;  // rows + 1 rows of the sky
  Spectrum ground_;
  Distribution2D distribution_;
  float sun_share_ = 0, sky_share_ = 0, ground_share_ = 0;
  float flux_ = 0;  // luminance integrated over all directions
};

}  // namespace

void register_sky(LightRegistry& r) { r.add<Sky>("sky", "The sun and a clear sky over flat ground"); }

}  // namespace meristem
