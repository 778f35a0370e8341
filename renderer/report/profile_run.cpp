#include "renderer/report/profile_run.h"

#include "renderer/color/color.h"
#include "renderer/language/json_value.h"
#include "renderer/report/child_process.h"
#include "renderer/report/comparison.h"
#include "renderer/report/page.h"
#include "renderer/report/temporary_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace meristem {

namespace {

struct Map {
  const char *aov, *title, *note, *unit;
};
constexpr Map maps[] = {{"cost.time", "Time", "that the samples of a pixel took, expansion included", " s"},
                        {"cost.expand", "Cells expanded", "by the samples of a pixel", " cells"},
                        {"cost.reexpand", "Expanded again", "of these, cells that had been evicted", " cells"},
                        {"level", "Level", "of refinement at the nearest surface", ""}};
constexpr const char* map_aovs = "cost.time,cost.expand,cost.reexpand,level";

// The brightest colour stands for what 99.5 % of the pixels stay below, unless the others are far above.
ReportImage heat_map_of(const Image& values, const Map& map) {
  const float most = quantile(values, 1), white = std::max(quantile(values, 0.995), most / 16);
  return {map.title, map.note, heat_map(values, white), "0",
          fmt::format("{:.3g}{}{}", white, map.unit, white < most ? " and more" : "")};
}

Value shown_images(const std::string& path) {
  Image image = read_image(path);
  DisplayTransform("").apply(image.pixels.data(), image.width, image.height, image.channels);
  std::vector<Value> list{report_image_value({"Image", "as displayed", std::move(image), "", ""})};
  for (const Map& map : maps)
    if (const Image values = read_image(path, map.aov); quantile(values, 1) > 0)
      list.push_back(report_image_value(heat_map_of(values, map)));
  return json::array(std::move(list));
}

}  // namespace

ProfileRun run_profile(const ProfileRunOptions& options) {
  const TemporaryFolder folder;
  const std::string image = folder.file("image.exr"), stats = folder.file("stats.json");
  std::vector<std::string> arguments{options.program, "render",  options.scene, "-o",      image,   "--float",
                                     "--profile",     "--stats", stats,         "--quiet", "--aov", map_aovs};
  if (!options.trace.empty()) arguments.insert(arguments.end(), {"--trace", options.trace});
  arguments.insert(arguments.end(), options.render_options.begin(), options.render_options.end());
  ProfileRun run;
  run.exit_code = run_child(arguments);
  if (!std::filesystem::exists(stats)) return run;
  run.statistics = read_statistics(stats);
  for (Member& m : run.statistics.members)
    if (m.key == "command") m.value.text = options.command;
  run.page_data =
      json::object({{"kind", json::text("profile")}, {"stats", run.statistics}, {"images", shown_images(image)}});
  return run;
}

}  // namespace meristem
