#include "renderer/cli/merge_command.h"

#include "renderer/cli/console.h"
#include "renderer/cli/exit_code.h"
#include "renderer/cli/film_identity.h"
#include "renderer/cli/render_metadata.h"

#include <fmt/format.h>

#include <algorithm>

namespace meristem {

namespace {

constexpr std::uint64_t most_samples = std::uint64_t(1) << 20;  // that a film's sums hold

bool overlap(const SampleRange& a, const SampleRange& b) { return a.first < b.last && b.first < a.last; }

// Throws if `file` cannot be added to `sum`.
void check_mergeable(const FilmFile& sum, const FilmFile& file, const std::string& path,
                     const std::string& first_path) {
  const std::string difference = identity_difference(sum.info.identity, file.info.identity);
  if (!difference.empty())
    throw UsageError(fmt::format("{} and {} are not of the same image: {}", first_path, path, difference));
  if (sum.film.window() != file.film.window() || sum.film.aovs() != file.film.aovs())
    throw UsageError(fmt::format("{} and {} have other pixels or AOVs", first_path, path));
  std::uint64_t samples = 0;
  for (const SampleRange& a : sum.info.ranges) samples += a.last - a.first;
  for (const SampleRange& b : file.info.ranges) {
    samples += b.last - b.first;
    for (const SampleRange& a : sum.info.ranges)
      if (overlap(a, b))
        throw UsageError(
            fmt::format("{} has samples {}:{}, which another film of the list has, too", path, b.first, b.last));
  }
  if (samples > most_samples) throw UsageError(fmt::format("together more than {} samples a pixel", most_samples));
}

// "0:64" and "64:128" become "0:128".
void join_neighbours(std::vector<SampleRange>& ranges) {
  std::ranges::sort(ranges, {}, &SampleRange::first);
  std::vector<SampleRange> joined;
  for (const SampleRange& r : ranges)
    if (!joined.empty() && joined.back().last == r.first)
      joined.back().last = r.last;
    else
      joined.push_back(r);
  ranges = std::move(joined);
}

void warn_of_gaps(const FilmFile& file) {
  for (std::size_t i = 1; i < file.info.ranges.size(); ++i)
    print_error(fmt::format("warning: samples {}:{} are in none of the films", file.info.ranges[i - 1].last,
                            file.info.ranges[i].first));
  std::uint64_t all = 0;
  for (const SampleRange& r : file.info.ranges) all += r.last - r.first;
  const PixelWindow& w = file.film.window();
  all *= std::uint64_t(w.width()) * std::uint64_t(w.height());
  if (file.film.total_samples() < all)
    print_error(fmt::format("warning: {} samples of the ranges are missing: a film was not complete",
                            all - file.film.total_samples()));
}

}  // namespace

int merge_command(const MergeOptions& options) {
  check_targets("", options.outputs.files);  // a film may take the place of one that went into it
  const Outputs outputs(options.outputs);
  FilmFile sum = read_film_file(options.films[0]);
  for (std::size_t i = 1; i < options.films.size(); ++i) {
    FilmFile file = read_film_file(options.films[i]);
    check_mergeable(sum, file, options.films[i], options.films[0]);
    sum.film.merge(file.film);
    sum.info.ranges.insert(sum.info.ranges.end(), file.info.ranges.begin(), file.info.ranges.end());
    sum.info.history.insert(sum.info.history.end(), file.info.history.begin(), file.info.history.end());
  }
  join_neighbours(sum.info.ranges);
  sum.info.metadata = merged_metadata(sum.info, options.command_line);
  if (!options.quiet && options.films.size() > 1) warn_of_gaps(sum);
  outputs.write(sum.film, sum.info, sum.adaptive);
  if (!options.quiet)
    for (const std::string& path : outputs.files()) print_error(fmt::format("wrote {}", path));
  return int(ExitCode::Done);
}

}  // namespace meristem
