#include "geometry/cache/expansion_recorder.h"

#include <algorithm>

namespace meristem {

ExpansionRecorder::ExpansionRecorder(std::uint64_t budget_bytes, std::function<std::size_t()> plan_bytes)
    : budget_bytes_(budget_bytes), plan_bytes_(std::move(plan_bytes)) {
  class_of({"placed instances", 0, "", false});
}

ExpansionRecorder::ThreadLog& ExpansionRecorder::log() {
  std::unique_ptr<ThreadLog>& mine = logs_[std::size_t(GeometryCache::thread_index())];
  if (!mine) mine = std::make_unique<ThreadLog>();
  return *mine;
}

void ExpansionRecorder::ThreadLog::add(const ActivitySpan& span) {
  std::vector<ActivitySpan>& spans = figures.spans;
  kept_last_span = seen_spans++ % figures.span_stride == 0;
  if (!kept_last_span) return;
  if (spans.size() == max_spans) {
    for (std::size_t i = 0; i < max_spans / 2; ++i) spans[i] = spans[2 * i];
    spans.resize(max_spans / 2);
    figures.span_stride *= 2;
  }
  spans.push_back(span);
}

std::uint32_t ExpansionRecorder::class_of(const CellClass& cells) {
  const std::lock_guard lock(mutex_);
  const auto at = std::ranges::find(classes_, cells, &CellClassFigures::cells);
  if (at != classes_.end()) return std::uint32_t(at - classes_.begin());
  if (classes_.size() == max_classes) return max_classes - 1;
  classes_.push_back({.cells = cells});
  return std::uint32_t(classes_.size() - 1);
}

void ExpansionRecorder::add_expansion(const RecordedExpansion& e) {
  const double build_s = e.end_s - e.built_from_s;
  const double expand_s = e.built_from_s - e.start_s;
  ThreadLog& mine = log();
  mine.figures.expand_s += expand_s;
  mine.figures.build_s += build_s;
  ++mine.figures.expansions;
  mine.latency.add(e.end_s - e.start_s);
  mine.add({e.start_s, float(e.end_s - e.start_s), float(build_s), ActivitySpan::Kind::Expand, false, e.cell_class,
            std::uint32_t(e.faces), std::uint32_t(e.bytes)});

  const std::lock_guard lock(mutex_);
  timeline_.add_work(e.start_s, e.built_from_s, &TimelineBin::expand_s);
  timeline_.add_work(e.built_from_s, e.end_s, &TimelineBin::build_s);
  timeline_.at(e.end_s).faces += e.faces;
  CellClassFigures& figures = classes_[e.cell_class];
  figures.faces += e.faces;
  figures.bytes += e.bytes;
  figures.expand_s += expand_s;
  figures.build_s += build_s;
  if (e.box_ratio <= 0) return;
  ++figures.boxes;
  figures.box_ratio_sum += e.box_ratio;
  figures.box_ratio_max = std::max(figures.box_ratio_max, e.box_ratio);
}

void ExpansionRecorder::add_wait(double start_s) {
  const double end_s = now_s();
  ThreadLog& mine = log();
  mine.figures.wait_s += end_s - start_s;
  ++mine.figures.waits;
  mine.waits.add(end_s - start_s);
  mine.add({start_s, float(end_s - start_s), 0, ActivitySpan::Kind::Wait, false, 0, 0, 0});
  const std::lock_guard lock(mutex_);
  timeline_.add_work(start_s, end_s, &TimelineBin::wait_s);
  ++timeline_.at(end_s).waits;
}

void ExpansionRecorder::change(const CellLabel& label, std::size_t bytes, int sign) {
  std::uint64_t& trees = label.is_surface ? memory_.surface_trees : memory_.box_trees;
  std::uint64_t& arrays = label.is_surface ? memory_.surfaces : memory_.meshes;
  const std::int64_t in_trees = std::int64_t(std::min(label.tree_bytes, bytes));
  trees += std::uint64_t(sign * in_trees);
  arrays += std::uint64_t(sign * (std::int64_t(bytes) - in_trees));
}

void ExpansionRecorder::note_memory() {
  memory_.plans = plan_bytes_();
  timeline_.set_memory(now_s(), memory_);
}

void ExpansionRecorder::expanded(const CellLabel& label, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  change(label, bytes, 1);
  note_memory();
  const bool again = label.cell != 0 && reuse_.expanded(label.cell, bytes);
  TimelineBin& bin = timeline_.at(now_s());
  ++bin.expanded;
  bin.reexpanded += again;
  ++classes_[label.cell_class].expanded;
  classes_[label.cell_class].reexpanded += again;
  ThreadLog& mine = log();  // its last span is that of this expansion
  if (again && mine.kept_last_span) mine.figures.spans.back().is_reexpansion = true;
}

void ExpansionRecorder::evicted(const CellLabel& label, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  reuse_.evicted(label.cell, memory_.resident());
  change(label, bytes, -1);
  memory_.limbo += bytes;
  ++timeline_.at(now_s()).evicted;
  ++classes_[label.cell_class].evicted;
}

void ExpansionRecorder::limbo_is(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  memory_.limbo = bytes;
  note_memory();
}

std::uint32_t* ExpansionRecorder::begin_ray() {
  ThreadLog& mine = log();
  if (mine.figures.rays++ % ray_stride != 0) return nullptr;
  mine.busy_before_s = mine.busy_s();
  mine.ray_start_s = now_s();
  return mine.visits.data();
}

void ExpansionRecorder::end_ray() {
  ThreadLog& mine = log();
  const double busy_s = mine.busy_s() - mine.busy_before_s;
  mine.figures.trace_s += std::max(0.0, now_s() - mine.ray_start_s - busy_s) * ray_stride;
}

ExpansionProfile ExpansionRecorder::profile() const {
  const std::lock_guard lock(mutex_);
  ExpansionProfile p;
  p.duration_s = now_s();
  p.budget_bytes = budget_bytes_;
  p.bin_s = timeline_.bin_s();
  p.timeline = timeline_.bins();
  p.classes = classes_;
  p.reuse = reuse_.figures();
  p.ray_stride = ray_stride;
  for (const auto& mine : logs_) {
    if (!mine) continue;
    p.threads.push_back(mine->figures);
    for (std::size_t i = 0; i < p.classes.size(); ++i)
      p.classes[i].visits += std::uint64_t(mine->visits[i]) * ray_stride;
    p.latency += mine->latency;
    p.waits += mine->waits;
  }
  return p;
}

}  // namespace meristem
