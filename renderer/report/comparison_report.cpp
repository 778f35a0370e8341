// What a comparison shows: as a table, as JSON, in words and for the page.
#include "renderer/language/json_value.h"
#include "renderer/language/json_writer.h"
#include "renderer/report/comparison.h"
#include "renderer/report/page.h"
#include "renderer/report/statistics.h"

#include <fmt/format.h>

#include <algorithm>

namespace meristem {

namespace {

std::string difference_columns(const Variant& v) {
  if (!v.difference) return fmt::format("{:>12} {:>12} {:>12}", "-", "-", "-");
  return fmt::format("{:>12.3g} {:>12.3g} {:>12}", v.difference->max, v.difference->rms,
                     format_count(v.difference->differing));
}

std::string table_row(const Variant& v) {
  if (v.runs.empty())
    return v.exit_code ? fmt::format("{:<22} failed with exit code {}\n", v.name, v.exit_code)
                       : fmt::format("{:<22} not run\n", v.name);
  return fmt::format("{:<22} {:>10.2f} s {:>8.2f} s {:>12} {:>16} {}\n", v.name, v.median(&RunFigures::first_pixel_s),
                     v.median(&RunFigures::wall_s), format_bytes(v.median(&RunFigures::peak_rss_bytes)),
                     format_count(v.median(&RunFigures::faces)), difference_columns(v));
}

Value difference_value(const Variant& v) {
  if (!v.difference) return {};
  return json::object({{"max", json::number(v.difference->max)},
                       {"rms", json::number(v.difference->rms)},
                       {"flip_mean", json::number(v.flip_mean)},
                       {"differing_pixels", json::count(v.difference->differing)},
                       {"nonfinite_values", json::count(v.difference->nonfinite)}});
}

Value run_value(const RunFigures& r) {
  return json::object({{"first_pixel_s", json::number(r.first_pixel_s)},
                       {"wall_s", json::number(r.wall_s)},
                       {"load_s", json::number(r.load_s)},
                       {"render_s", json::number(r.render_s)},
                       {"peak_rss_bytes", json::count(r.peak_rss_bytes)},
                       {"resident_bytes_peak", json::count(r.resident_bytes_peak)},
                       {"faces", json::count(r.faces)},
                       {"cells", json::count(r.cells)},
                       {"image_sha256", json::text(r.image_sha256)}});
}

Value variant_value(const Variant& v) {
  std::vector<Value> runs;
  for (const RunFigures& r : v.runs) runs.push_back(run_value(r));
  return json::object({{"name", json::text(v.name)},
                       {"mode", json::text(v.mode)},
                       {"budget_bytes", v.budget.bytes ? json::count(v.budget.bytes) : Value{}},
                       {"exit_code", json::number(v.exit_code)},
                       {"faults", json::boolean(v.faults)},
                       {"reproducible", json::boolean(v.reproducible())},
                       {"runs", json::array(std::move(runs))},
                       {"difference", difference_value(v)},
                       {"stats", v.statistics.value_or(Value{})}});
}

Value comparison_value(const Comparison& comparison) {
  std::vector<Value> list;
  for (const Variant& v : comparison.variants) list.push_back(variant_value(v));
  return json::object({{"kind", json::text("comparison")},
                       {"scene", json::text(comparison.scene)},
                       {"pixels", json::count(comparison.pixels)},
                       {"variants", json::array(std::move(list))}});
}

// "12 times", "1.4 times".
std::string times(double ratio) { return fmt::format("{:.{}f} times", ratio, ratio < 9.95 ? 1 : 0); }

// How `lazy` stands to `other`, which expands everything beforehand.
std::string against(const Variant& lazy, const Variant& other) {
  const double first = other.median(&RunFigures::first_pixel_s) / lazy.median(&RunFigures::first_pixel_s);
  const double wall = other.median(&RunFigures::wall_s) / lazy.median(&RunFigures::wall_s);
  const double memory =
      double(other.median(&RunFigures::peak_rss_bytes)) / double(lazy.median(&RunFigures::peak_rss_bytes));
  return fmt::format(
      "Against {}, lazy shows its first pixel {} (after {:.2f} s, not {:.2f} s), is done {}, and holds {} memory.",
      other.name, first >= 1 ? times(first) + " sooner" : times(1 / first) + " later",
      lazy.median(&RunFigures::first_pixel_s), other.median(&RunFigures::first_pixel_s),
      wall >= 1 ? times(wall) + " sooner" : times(1 / wall) + " later",
      memory >= 1 ? fmt::format("{:.0f} % less", 100 * (1 - 1 / memory))
                  : fmt::format("{:.0f} % more", 100 * (1 / memory - 1)));
}

std::string with_less_memory(const Variant& lazy, const Variant& small) {
  return fmt::format(
      "With {} for geometry instead of {} the render takes {} as long and expands {} as many cells.",
      format_bytes(small.budget.bytes), format_bytes(lazy.median(&RunFigures::resident_bytes_peak)),
      times(small.median(&RunFigures::wall_s) / lazy.median(&RunFigures::wall_s)),
      times(double(small.median(&RunFigures::cells)) / std::max(1.0, double(lazy.median(&RunFigures::cells)))));
}

std::string images_in_words(const Comparison& comparison) {
  std::string different;
  for (const Variant& v : comparison.variants)
    if (v.difference && !v.difference->identical())
      different += fmt::format(" {} differs from {} in {} of {} pixels (RMSE {:.2g}, FLIP {:.2g}).", v.name,
                               comparison.variants[0].name, format_count(v.difference->differing),
                               format_count(comparison.pixels), v.difference->rms, v.flip_mean);
  return different.empty() ? "All images are the same, bit for bit." : "Not all images are the same:" + different;
}

// The first, and those that differ with where they do.
std::vector<Value> page_images(const Comparison& comparison) {
  std::vector<Value> list;
  std::string same;
  for (const Variant& v : comparison.variants)
    if (v.difference && v.difference->identical()) same += (same.empty() ? "" : ", ") + v.name;
  for (const Variant& v : comparison.variants) {
    if (!v.shown || (v.difference && v.difference->identical())) continue;
    const bool is_first = !v.difference;
    list.push_back(
        report_image_value({v.name, is_first && !same.empty() ? "and, bit for bit: " + same : "", *v.shown, "", ""}));
    if (v.flip)
      list.push_back(report_image_value({v.name + ": difference", fmt::format("FLIP, {:.3g} on average", v.flip_mean),
                                         heat_map(*v.flip, 1), "0", "1"}));
  }
  return list;
}

Value words_value(const Comparison& comparison) {
  std::vector<Value> list;
  for (const std::string& text : comparison_words(comparison))
    list.push_back(json::object({{"text", json::text(text)}, {"advice", json::boolean(false)}}));
  return json::array(std::move(list));
}

}  // namespace

std::string comparison_table(const Comparison& comparison) {
  std::string table = fmt::format("{:<22} {:>12} {:>10} {:>12} {:>16} {:>12} {:>12} {:>12}\n", "mode", "first pixel",
                                  "wall", "peak memory", "faces expanded", "max diff", "RMS diff", "pixels diff");
  for (const Variant& v : comparison.variants) table += table_row(v);
  for (const Variant& v : comparison.variants) {
    if (v.difference && v.difference->nonfinite > 0)
      table +=
          fmt::format("{}: {} values are not finite in it or in lazy\n", v.name, format_count(v.difference->nonfinite));
    if (v.faults) table += fmt::format("{}: rendered with faults\n", v.name);
    if (!v.reproducible()) table += fmt::format("{}: the runs did not give the same bits\n", v.name);
  }
  return table;
}

std::string comparison_json(const Comparison& comparison) { return to_json(comparison_value(comparison)) + "\n"; }

std::vector<std::string> comparison_words(const Comparison& comparison) {
  std::vector<std::string> words;
  const std::vector<Variant>& all = comparison.variants;
  if (all.empty() || all[0].runs.empty()) return words;
  for (const Variant& v : all)
    if (v.mode != "lazy" && !v.runs.empty()) words.push_back(against(all[0], v));
  for (const Variant& v : all)
    if (&v != &all[0] && v.mode == "lazy" && !v.runs.empty()) words.push_back(with_less_memory(all[0], v));
  words.push_back(images_in_words(comparison));
  return words;
}

Value comparison_page_data(const Comparison& comparison, const std::string& command) {
  Value data = comparison_value(comparison);
  const std::size_t runs = comparison.variants.empty() ? 0 : comparison.variants[0].runs.size();
  data.members.push_back({"command", {}, json::text(command)});
  data.members.push_back({"facts",
                          {},
                          json::text(fmt::format("{} pixels; {} of each rendering", format_count(comparison.pixels),
                                                 runs == 1 ? "one run" : fmt::format("{} runs", runs)))});
  data.members.push_back({"hints", {}, words_value(comparison)});
  data.members.push_back({"images", {}, json::array(page_images(comparison))});
  return data;
}

}  // namespace meristem
