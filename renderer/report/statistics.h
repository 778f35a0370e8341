// RenderStatistics: the figures of one render, as JSON (`--stats FILE.json`), as a few lines of text, and as metadata
// of its images. A plain record; times in seconds, sizes in bytes.
#pragma once

#include "geometry/base/statistics.h"
#include "renderer/image/image.h"
#include "renderer/report/recording.h"
#include "renderer/scene/interfaces.h"
#include "renderer/session/queued_paths.h"

#include <cstdint>
#include <optional>
#include <string>

namespace meristem {

struct ImageStatistics {
  int width = 0, height = 0;
  std::uint64_t nonfinite = 0;  // samples dropped because they were not finite
  std::string sha256;           // image_sha256()
};

struct RenderStatistics {
  std::string scene;  // as the user named it
  std::string scene_sha256;
  std::string command;  // the command line
  std::string expand;   // "lazy", "eager" or "flat"
  double wall_s = 0;    // from the start of the process until the images were written
  double load_s = 0;    // to read and build the scene; with eager and flat, to expand it
  double render_s = 0;
  std::optional<double> first_pixel_s;  // from the start of the process until a pixel had its first sample; if one had
  std::uint64_t peak_rss_bytes = 0;
  int threads = 0;
  RayCounts rays;
  std::optional<QueueStatistics> queues;  // if rays were queued
  int samples = 0;                        // asked for, a pixel
  std::uint64_t samples_taken = 0;
  bool interrupted = false;
  ImageStatistics image;
  ExpansionStatistics expansion;
  std::optional<Recording> recording;  // if it was asked for

  std::uint64_t total_rays() const { return rays.camera + rays.bounce + rays.shadow; }
  double rays_per_s() const { return render_s > 0 ? double(total_rays()) / render_s : 0; }
};

// Of the bytes of the pixels, row by row, as 32-bit little-endian floats: equal images have equal digests.
std::string image_sha256(const Image& image);

// With what was recorded, and with hints, if there is a recording.
Value statistics_value(const RenderStatistics& s);
std::string statistics_json(const RenderStatistics& s);
// Of the recording, which there must be.
PhaseTimes statistics_phases(const RenderStatistics& s);

// One line for every render: size, times, rays, memory, expansion.
std::string summary(const RenderStatistics& s);
// Several lines, for --verbose: rays by kind, the cache, expansion by step.
std::string details(const RenderStatistics& s);

// Scene digest, command, version, samples, seconds, memory: for write_image().
Metadata image_metadata(const RenderStatistics& s);

// "1.5 MiB", "17.3 GiB"; "1,234,567"; both for people.
std::string format_bytes(std::uint64_t bytes);
std::string format_count(std::uint64_t n);

}  // namespace meristem
