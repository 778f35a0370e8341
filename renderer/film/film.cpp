#include "renderer/film/film.h"

#include "geometry/base/check.h"
#include "renderer/film/cryptomatte.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace meristem {

namespace {

constexpr double surface_unit = 0x1p-40;
constexpr double surface_limit = 4;
constexpr float nothing_there = 1e10f;  // the depth of a pixel that shows no surface
// Squares range over twice the exponents of what is squared: their unit is 2^-80, and a luminance above 8191 counts as
// that in variances.
constexpr double square_scale = 0x1p16;
constexpr double largest_square = 8191.0 * 8191.0;

std::int64_t surface_term(float value, int weight) {
  const double size = std::clamp(double(value), -surface_limit, surface_limit);
  return std::int64_t(size / surface_unit) * weight;
}

bool is_countable(Spectrum s) {
  return is_finite(s) && std::abs(s.x) < float(ExactSum::limit) && std::abs(s.y) < float(ExactSum::limit) &&
         std::abs(s.z) < float(ExactSum::limit);
}

// In double, so that equal samples have no variance.
double exact_luminance(double r, double g, double b) {
  return double(0.2126f) * r + double(0.7152f) * g + double(0.0722f) * b;
}

constexpr std::initializer_list<Aov> of_nearest{Aov::Z,        Aov::P,          Aov::Uv,   Aov::Motion,
                                                Aov::ObjectId, Aov::MaterialId, Aov::Level};
constexpr std::initializer_list<Aov> of_costs{Aov::CostTime, Aov::CostExpand, Aov::CostReexpand};
constexpr std::array matte_aovs{Aov::CryptoObject, Aov::CryptoMaterial, Aov::CryptoProduction};

}  // namespace

Film::Film(PixelWindow window, float mean_weight, std::vector<Aov> aovs)
    : window_(window), mean_weight_(mean_weight), aovs_(std::move(aovs)) {
  CHECK(!window.empty(), "a film from ({}, {}) to ({}, {})", window.x0, window.y0, window.x1, window.y1);
  const std::size_t count = std::size_t(window.width()) * std::size_t(window.height());
  const auto any_of = [&](std::initializer_list<Aov> list) {
    return std::ranges::any_of(list, [this](Aov aov) { return has(aov); });
  };
  pixels_.resize(count);
  if (has(Aov::Variance)) squares_.resize(count);
  if (has(Aov::SecondHalf)) second_halves_.resize(count);
  if (has(Aov::Albedo) || has(Aov::Normal)) surfaces_.resize(count);
  if (any_of(of_nearest)) nearest_.resize(count, {nothing_there, {0, 0, 0}, 0, 0, {0, 0}, -1, -1, 0, ~0u});
  if (any_of(of_costs)) costs_.resize(count);
  for (std::size_t m = 0; m < matte_count; ++m)
    if (has(matte_aovs[m])) mattes_[m] = Matte(count);
}

bool Film::has(Aov aov) const { return std::ranges::find(aovs_, aov) != aovs_.end(); }

bool Film::wants_mattes() const {
  return std::ranges::any_of(mattes_, [](const Matte& m) { return !m.empty(); });
}

void Film::add(int x, int y, const FilmSample& sample) {
  const std::size_t i = index(x, y);
  Pixel& p = pixels_[i];
  ++p.samples;
  if (!costs_.empty()) {
    costs_[i].nanoseconds += sample.nanoseconds;
    costs_[i].expanded += std::uint32_t(sample.expansions.expanded);
    costs_[i].reexpanded += std::uint32_t(sample.expansions.reexpanded);
  }
  const Spectrum& light = sample.radiance;
  if (!is_countable(light)) {
    ++p.nonfinite;
    return;
  }
  for (int c = 0; c < 3; ++c) p.sum[c].add(sample.weight * double(light[c]));
  p.weight += sample.weight;
  if (sample.covered) p.covered += sample.weight;
  if (!second_halves_.empty() && (sample.number & 4)) {
    Half half{{}, sample.weight, 1};
    for (int c = 0; c < 3; ++c) half.sum[c].add(sample.weight * double(light[c]));
    second_halves_[i].add(half);
  }
  if (!squares_.empty()) {
    const double l = exact_luminance(double(light.x), double(light.y), double(light.z));
    squares_[i].add(std::min(l * l, largest_square) * square_scale);
  }
  if (sample.first && sample.first->hit.valid()) add_first_surface(i, sample);
}

void Film::Half::add(const Half& o) {
  for (int c = 0; c < 3; ++c) sum[c].add(o.sum[c]);
  weight += o.weight, samples += o.samples;
}

void Film::add_first_surface(std::size_t i, const FilmSample& sample) {
  const FirstSurface& first = *sample.first;
  const SurfaceHit& hit = first.hit;
  if (!surfaces_.empty())
    for (int c = 0; c < 3; ++c) {
      surfaces_[i].albedo[c] += surface_term(first.albedo[c], sample.weight);
      surfaces_[i].normal[c] += surface_term(hit.shading_normal[c], sample.weight);
    }
  if (!nearest_.empty()) {
    Nearest& n = nearest_[i];
    if (std::tie(sample.depth, sample.number) < std::tie(n.depth, n.sample))
      n = {sample.depth,
           {hit.position.x, hit.position.y, hit.position.z},
           hit.u,
           hit.v,
           {sample.motion.x, sample.motion.y},
           hit.object,
           first.material,
           hit.level,
           sample.number};
  }
  add_to_mattes(i, sample);
}

void Film::add_to_mattes(std::size_t i, const FilmSample& sample) {
  const std::array things{sample.first->hit.object, sample.first->material, sample.first->production};
  for (std::size_t m = 0; m < matte_count; ++m)
    if (!mattes_[m].empty() && things[m] >= 0) mattes_[m].add(i, {things[m], sample.weight});
}

void Film::merge(const Film& other) {
  CHECK(window_ == other.window_ && aovs_ == other.aovs_, "films of different windows or AOVs are merged");
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    Pixel& p = pixels_[i];
    const Pixel& o = other.pixels_[i];
    for (int c = 0; c < 3; ++c) p.sum[c].add(o.sum[c]);
    p.weight += o.weight, p.covered += o.covered, p.samples += o.samples, p.nonfinite += o.nonfinite;
  }
  for (std::size_t i = 0; i < squares_.size(); ++i) squares_[i].add(other.squares_[i]);
  for (std::size_t i = 0; i < second_halves_.size(); ++i) second_halves_[i].add(other.second_halves_[i]);
  for (std::size_t i = 0; i < surfaces_.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      surfaces_[i].albedo[c] += other.surfaces_[i].albedo[c];
      surfaces_[i].normal[c] += other.surfaces_[i].normal[c];
    }
  for (std::size_t i = 0; i < nearest_.size(); ++i)
    if (const Nearest& n = other.nearest_[i];
        std::tie(n.depth, n.sample) < std::tie(nearest_[i].depth, nearest_[i].sample))
      nearest_[i] = n;
  for (std::size_t i = 0; i < costs_.size(); ++i) {
    costs_[i].nanoseconds += other.costs_[i].nanoseconds;
    costs_[i].expanded += other.costs_[i].expanded;
    costs_[i].reexpanded += other.costs_[i].reexpanded;
  }
  for (std::size_t m = 0; m < matte_count; ++m) mattes_[m].merge(other.mattes_[m]);
}

std::uint64_t Film::total_samples() const {
  std::uint64_t total = 0;
  for (const Pixel& p : pixels_) total += p.samples;
  return total;
}

std::uint64_t Film::nonfinite_samples() const {
  std::uint64_t total = 0;
  for (const Pixel& p : pixels_) total += p.nonfinite;
  return total;
}

std::uint64_t Film::pixels_without_samples() const {
  return std::uint64_t(std::ranges::count_if(pixels_, [](const Pixel& p) { return p.samples == 0; }));
}

// Dividing by the sum of the weights makes a constant image exact. With negative lobes a few samples may nearly cancel;
// half of the expected sum then bounds the pixel, and stops mattering as samples come in.
double Film::divisor(const Pixel& p) const { return divisor(p.weight, p.samples - p.nonfinite); }

double Film::divisor(std::int32_t weight, std::uint32_t finite_samples) const {
  return std::max(double(weight), 0.5 * double(mean_weight_) * double(finite_samples));
}

Film::Statistics Film::statistics(int x, int y) const {
  const std::size_t i = index(x, y);
  const Pixel& p = pixels_[i];
  const double n = double(p.samples - p.nonfinite);
  if (n == 0) return {};
  const double total = exact_luminance(p.sum[0].value(), p.sum[1].value(), p.sum[2].value());
  const double mean = total / divisor(p);
  if (n < 2 || squares_.empty()) return {n, mean, 0};
  const double squares = squares_[i].value() / square_scale;
  const double centred = squares - total * total / n;
  // What rounding leaves of equal samples is no variance
  return {n, mean, centred > squares * 1e-12 ? centred / (n - 1) : 0};
}

std::array<Spectrum, 2> Film::halves(int x, int y) const {
  CHECK(!second_halves_.empty(), "the film does not have {}", info_of(Aov::SecondHalf).name);
  const Pixel& p = pixel(x, y);
  const Half& second = second_halves_[index(x, y)];
  const std::uint32_t finite = p.samples - p.nonfinite;
  if (finite == 0) return {};
  const double all = divisor(p);
  std::array<Spectrum, 2> result;
  for (int c = 0; c < 3; ++c) {
    const double sum = p.sum[c].value(), of_second = second.sum[c].value();
    result[0][c] = result[1][c] = float(sum / all);
    if (second.samples == 0 || second.samples == finite) continue;
    result[0][c] = float((sum - of_second) / divisor(p.weight - second.weight, finite - second.samples));
    result[1][c] = float(of_second / divisor(second.weight, second.samples));
  }
  return result;
}

Image Film::develop() const {
  Image image{window_.width(), window_.height(), 4, std::vector<float>(pixels_.size() * 4)};
  develop(0, window_.height(), image.pixels.data());
  return image;
}

void Film::develop(int begin, int end, float* values) const {
  for (const Pixel& p : rows(begin, end)) {
    const double d = divisor(p);
    for (const ExactSum& sum : p.sum) *values++ = d > 0 ? float(sum.value() / d) : 0.0f;
    *values++ = d > 0 ? float(std::clamp(p.covered / d, 0.0, 1.0)) : 0.0f;
  }
}

Image Film::develop(Aov aov) const {
  const std::size_t channels = info_of(aov).channels.size();
  Image image{window_.width(), window_.height(), int(channels), std::vector<float>(pixels_.size() * channels)};
  develop(aov, 0, window_.height(), image.pixels.data());
  return image;
}

void Film::develop(Aov aov, int begin, int end, float* values) const {
  CHECK(has(aov), "the film does not have {}", info_of(aov).name);
  const std::size_t channels = info_of(aov).channels.size();
  CHECK(channels > 0, "{} is a matte", info_of(aov).name);
  std::size_t i = index(window_.x0, window_.y0 + begin);
  for (const Pixel& p : rows(begin, end)) {
    if (p.samples > 0)
      develop_pixel(aov, i, values);
    else
      std::fill_n(values, channels, 0.0f);
    ++i;
    values += channels;
  }
}

void Film::develop_pixel(Aov aov, std::size_t i, float* out) const {
  const Pixel& p = pixels_[i];
  const double d = divisor(p);
  const auto mean = [&](const std::int64_t(&sums)[3]) {
    for (int c = 0; c < 3; ++c) out[c] = d > 0 ? float(double(sums[c]) * surface_unit / d) : 0.0f;
  };
  switch (aov) {
    case Aov::Albedo: return mean(surfaces_[i].albedo);
    case Aov::Normal: return mean(surfaces_[i].normal);
    case Aov::Z: out[0] = nearest_[i].depth; return;
    case Aov::P: std::ranges::copy(nearest_[i].position, out); return;
    case Aov::Uv: out[0] = nearest_[i].u, out[1] = nearest_[i].v; return;
    case Aov::Motion: std::ranges::copy(nearest_[i].motion, out); return;
    case Aov::ObjectId: out[0] = float(nearest_[i].object + 1); return;
    case Aov::MaterialId: out[0] = float(nearest_[i].material + 1); return;
    case Aov::Level: out[0] = float(nearest_[i].level); return;
    case Aov::Samples: out[0] = float(p.samples); return;
    case Aov::Variance: {
      const int width = window_.width();
      const Statistics s = statistics(window_.x0 + int(i) % width, window_.y0 + int(i) / width);
      out[0] = s.samples > 0 ? float(s.variance / s.samples) : 0.0f;
      return;
    }
    case Aov::SecondHalf: {
      const int width = window_.width();
      const Spectrum half = halves(window_.x0 + int(i) % width, window_.y0 + int(i) / width)[1];
      for (int c = 0; c < 3; ++c) out[c] = half[c];
      return;
    }
    case Aov::CostTime: out[0] = float(double(costs_[i].nanoseconds) * 1e-9); return;
    case Aov::CostExpand: out[0] = float(costs_[i].expanded); return;
    case Aov::CostReexpand: out[0] = float(costs_[i].reexpanded); return;
    case Aov::CryptoObject:
    case Aov::CryptoMaterial:
    case Aov::CryptoProduction: return;
  }
}

Image Film::develop_matte(Aov aov, const std::vector<std::uint32_t>& hashes, int layers) const {
  const std::size_t channels = std::size_t(layers) * 4;
  Image image{window_.width(), window_.height(), int(channels), std::vector<float>(pixels_.size() * channels)};
  develop_matte(aov, hashes, layers, 0, window_.height(), image.pixels.data());
  return image;
}

void Film::develop_matte(Aov aov, const std::vector<std::uint32_t>& hashes, int layers, int begin, int end,
                         float* values) const {
  const auto found = std::ranges::find(matte_aovs, aov);
  CHECK(found != matte_aovs.end() && has(aov), "the film has no matte {}", info_of(aov).name);
  const Matte& matte = mattes_[std::size_t(found - matte_aovs.begin())];
  std::size_t i = index(window_.x0, window_.y0 + begin);
  for (const Pixel& p : rows(begin, end)) {
    cryptomatte::write_ranks(matte.entries(i++), hashes, divisor(p), layers, values);
    values += 4 * layers;
  }
}

}  // namespace meristem
