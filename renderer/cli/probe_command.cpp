#include "renderer/cli/probe_command.h"

#include "renderer/cli/console.h"
#include "renderer/cli/exit_code.h"
#include "renderer/session/probe.h"

#include <fmt/format.h>

namespace meristem {

namespace {

std::string vector_text(Vec3f v) { return fmt::format("[{:.4g}, {:.4g}, {:.4g}]", v.x, v.y, v.z); }

std::string name_of(const std::vector<std::string>& names, int index) {
  return index >= 0 && std::size_t(index) < names.size() ? names[std::size_t(index)] : "?";
}

std::string surface_name(const Scene& scene, const SurfaceHit& hit) {
  return fmt::format("{}, {}, level {}", name_of(scene.names.objects, hit.object),
                     name_of(scene.names.materials, int(scene.material_index(hit))), hit.level);
}

std::string first_surface_text(const Scene& scene, const ProbedSample& sample) {
  const SurfaceHit& hit = sample.first.hit;
  if (!hit.valid()) return "  no surface\n";
  const RenderSettings& s = scene.settings;
  const float pixel = scene.camera->footprint_at(hit.position, sample.first.time, s.width, s.height);
  std::string text = fmt::format("  surface  {}", surface_name(scene, hit));
  if (sample.first.production >= 0)
    text += fmt::format(", made by {}", name_of(scene.names.productions, sample.first.production));
  text += fmt::format("\n  place    {}, depth {:.4g} m; a pixel is {:.3g} m wide there\n", vector_text(hit.position),
                      sample.depth, pixel);
  text += fmt::format("  normal   {}, of shading {}; u {:.5g}, v {:.5g}\n", vector_text(hit.geometric_normal),
                      vector_text(hit.shading_normal), hit.u, hit.v);
  return text + fmt::format("  albedo   {}\n", vector_text(sample.first.albedo));
}

const char* kind_of(const ProbedRay& ray, bool is_first) {
  if (is_first) return "camera";
  if (ray.is_light) return "light";
  return ray.ray.ray_class == RayClass::Diffuse ? "diffuse" : "onward";  // mirrored, refracted, passed through
}

std::string what_it_meets(const Scene& scene, const ProbedRay& ray) {
  if (!ray.met) return "nothing";
  return ray.any ? "something" : surface_name(scene, ray.hit);
}

std::string table(const Scene& scene, const ProbedSample& sample) {
  std::string text =
      fmt::format("  {:8} {:38} {:>10} {:>9} {:>6} {:>10}\n", "ray", "meets", "after", "expanded", "again", "time");
  for (std::size_t i = 0; i < sample.rays.size(); ++i) {
    const ProbedRay& ray = sample.rays[i];
    const std::string after = ray.met && !ray.any ? fmt::format("{:.4g} m", ray.hit.t) : "";
    text += fmt::format("  {:8} {:38} {:>10} {:9} {:6} {:7.3f} ms\n", kind_of(ray, i == 0), what_it_meets(scene, ray),
                        after, ray.expansions.expanded, ray.expansions.reexpanded, 1e3 * ray.seconds);
  }
  return text;
}

std::string sum_text(const std::vector<ProbedSample>& samples) {
  std::size_t rays = 0;
  ThreadExpansions expansions;
  double seconds = 0;
  for (const ProbedSample& sample : samples) {
    rays += sample.rays.size();
    for (const ProbedRay& ray : sample.rays) expansions += ray.expansions, seconds += ray.seconds;
  }
  return fmt::format("{} rays in {:.3f} ms, of which {:.3f} ms expanded {} cells\n", rays, 1e3 * seconds,
                     1e-6 * double(expansions.nanoseconds), expansions.expanded);
}

}  // namespace

int probe_command(const ProbeOptions& options, const SceneLoader& load) {
  LoadOptions load_options = options.load;
  load_options.keeps_uv = true;
  const LoadedScene loaded = load(options.scene, load_options);
  print_diagnostics(loaded.warnings);
  const Scene& scene = *loaded.scene;
  const RenderSettings& s = scene.settings;
  if (options.x < 0 || options.y < 0 || options.x >= s.width || options.y >= s.height)
    throw UsageError(
        fmt::format("pixel {},{} lies outside the image of {} x {} pixels", options.x, options.y, s.width, s.height));
  const std::vector<ProbedSample> samples = probe_pixel(scene, options.x, options.y, options.samples);
  std::string text = fmt::format("pixel {},{} of {} x {}\n", options.x, options.y, s.width, s.height);
  text += first_surface_text(scene, samples[0]);
  for (std::size_t i = 0; i < samples.size(); ++i)
    text += fmt::format("sample {}: radiance {}\n{}", i, vector_text(samples[i].radiance), table(scene, samples[i]));
  print_result(text + sum_text(samples));
  return int(ExitCode::Done);
}

}  // namespace meristem
