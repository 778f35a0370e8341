#include "renderer/report/recording.h"

#include "renderer/language/json_value.h"
#include "renderer/language/json_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

constexpr std::size_t max_memory_samples = 4096;

// Microseconds are what the clocks tell.
Value seconds(double s) { return json::number(std::round(s * 1e6) / 1e6); }

template <class List, class Make>
Value list(const List& items, const Make& make) {
  std::vector<Value> values;
  for (const auto& item : items) values.push_back(make(item));
  return json::array(std::move(values));
}

Value memory_column(const ExpansionProfile& p, std::uint64_t GeometryMemory::*kind) {
  return list(p.timeline, [=](const TimelineBin& b) { return json::count(b.memory.*kind); });
}
Value count_column(const ExpansionProfile& p, std::uint64_t TimelineBin::*figure) {
  return list(p.timeline, [=](const TimelineBin& b) { return json::count(b.*figure); });
}
Value time_column(const ExpansionProfile& p, double TimelineBin::*figure) {
  return list(p.timeline, [=](const TimelineBin& b) { return seconds(b.*figure); });
}

Value timeline_value(const ExpansionProfile& p) {
  return json::object({{"bin_s", json::number(p.bin_s)},
                       {"surfaces_bytes", memory_column(p, &GeometryMemory::surfaces)},
                       {"surface_trees_bytes", memory_column(p, &GeometryMemory::surface_trees)},
                       {"meshes_bytes", memory_column(p, &GeometryMemory::meshes)},
                       {"box_trees_bytes", memory_column(p, &GeometryMemory::box_trees)},
                       {"limbo_bytes", memory_column(p, &GeometryMemory::limbo)},
                       {"plans_bytes", memory_column(p, &GeometryMemory::plans)},
                       {"expanded", count_column(p, &TimelineBin::expanded)},
                       {"reexpanded", count_column(p, &TimelineBin::reexpanded)},
                       {"evicted", count_column(p, &TimelineBin::evicted)},
                       {"waits", count_column(p, &TimelineBin::waits)},
                       {"faces", count_column(p, &TimelineBin::faces)},
                       {"expand_s", time_column(p, &TimelineBin::expand_s)},
                       {"build_s", time_column(p, &TimelineBin::build_s)},
                       {"wait_s", time_column(p, &TimelineBin::wait_s)}});
}

Value class_value(const CellClassFigures& c) {
  return json::object({{"model", json::text(c.cells.model)},
                       {"level", json::number(c.cells.level)},
                       {"rule", json::text(c.cells.rule)},
                       {"final", json::boolean(c.cells.final)},
                       {"expanded", json::count(c.expanded)},
                       {"reexpanded", json::count(c.reexpanded)},
                       {"evicted", json::count(c.evicted)},
                       {"faces", json::count(c.faces)},
                       {"bytes", json::count(c.bytes)},
                       {"expand_s", seconds(c.expand_s)},
                       {"build_s", seconds(c.build_s)},
                       {"visits", json::count(c.visits)},
                       {"hits", json::count(c.visits > c.expanded ? c.visits - c.expanded : 0)},
                       {"boxes", json::count(c.boxes)},
                       {"box_ratio_mean", json::number(c.mean_box_ratio())},
                       {"box_ratio_max", json::number(c.box_ratio_max)}});
}

Value thread_value(const ThreadProfile& t) {
  return json::object({{"expand_s", seconds(t.expand_s)},
                       {"build_s", seconds(t.build_s)},
                       {"wait_s", seconds(t.wait_s)},
                       {"trace_s", seconds(t.trace_s)},
                       {"expansions", json::count(t.expansions)},
                       {"waits", json::count(t.waits)},
                       {"rays", json::count(t.rays)}});
}

Value latency_value(const LatencyHistogram& h) {
  std::vector<Value> bounds;
  for (int bin = 0; bin < LatencyHistogram::bin_count; ++bin)
    bounds.push_back(json::number(LatencyHistogram::lower_bound_s(bin)));
  return json::object({{"total", json::count(h.total())},
                       {"p50_s", json::number(h.quantile_s(0.5))},
                       {"p90_s", json::number(h.quantile_s(0.9))},
                       {"p99_s", json::number(h.quantile_s(0.99))},
                       {"max_s", json::number(h.max_s)},
                       {"lower_bounds_s", json::array(std::move(bounds))},
                       {"counts", list(h.counts, [](std::uint64_t n) { return json::count(n); })}});
}

Value reuse_value(const ReuseFigures& r) {
  return json::object({{"sampled_share", json::number(r.sampled_share)},
                       {"distinct_cells", json::number(r.distinct_cells)},
                       {"distinct_bytes", json::number(r.distinct_bytes)},
                       {"reexpanded", json::number(r.reexpanded)},
                       {"by_budget", list(r.by_budget, [](const ReuseFigures::Step& s) {
                          return json::object({{"budget_bytes", json::count(s.budget_bytes)},
                                               {"reexpanded", json::number(s.reexpanded)}});
                        })}});
}

Value process_value(const MemorySamples& samples) {
  using Sample = MemorySamples::Sample;
  return json::object(
      {{"age_s", list(samples.list(), [](const Sample& s) { return seconds(s.age_s); })},
       {"resident_bytes", list(samples.list(), [](const Sample& s) { return json::count(s.resident_bytes); })}});
}

Value phases_value(const PhaseTimes& p) {
  return json::object({{"load", seconds(p.load)},
                       {"expand", seconds(p.expand)},
                       {"build", seconds(p.build)},
                       {"trace", seconds(p.trace)},
                       {"shade", seconds(p.shade)},
                       {"wait", seconds(p.wait)}});
}

// Collects trace events; one process, thread 0 stands for the program as a whole.
class TraceWriter {
 public:
  explicit TraceWriter(const Recording& recording) : recording_(recording), start_s_(recording.start_s) {}

  void name_thread(std::size_t thread, const std::string& name) {
    events_.push_back(
        fmt::format(R"({{"ph":"M","pid":1,"tid":{},"name":"thread_name","args":{{"name":{}}}}})", thread, text(name)));
  }
  // `start_s` counts from the start of the process.
  void span(std::size_t thread, const char* name, double start_s, double duration_s, const std::string& args = "") {
    events_.push_back(fmt::format(R"({{"ph":"X","pid":1,"tid":{},"name":"{}","ts":{:.3f},"dur":{:.3f},"args":{{{}}}}})",
                                  thread, name, start_s * 1e6, duration_s * 1e6, args));
  }
  void counter(const char* name, double start_s, const std::string& args) {
    events_.push_back(
        fmt::format(R"({{"ph":"C","pid":1,"name":"{}","ts":{:.3f},"args":{{{}}}}})", name, start_s * 1e6, args));
  }

  void add_thread(std::size_t thread, const ThreadProfile& profile) {
    for (const ActivitySpan& s : profile.spans) {
      const double from = start_s_ + s.start_s;
      if (s.kind == ActivitySpan::Kind::Wait) {
        span(thread, "wait", from, double(s.duration_s));
        continue;
      }
      const CellClass& cells = recording_.expansion.classes[s.cell_class].cells;
      span(thread, s.is_reexpansion ? "expand again" : "expand", from, double(s.duration_s),
           fmt::format(R"("model":{},"level":{},"rule":{},"faces":{},"bytes":{})", text(cells.model), cells.level,
                       text(cells.rule), s.faces, s.bytes));
      span(thread, "build", from + double(s.duration_s - s.build_s), double(s.build_s));
    }
  }

  void add_timeline(const ExpansionProfile& p) {
    for (std::size_t i = 0; i < p.timeline.size(); ++i) {
      const TimelineBin& b = p.timeline[i];
      const double at = start_s_ + double(i) * p.bin_s;
      counter(
          "geometry MiB", at,
          fmt::format(R"("surfaces":{:.3f},"surface trees":{:.3f},"meshes":{:.3f},"box trees":{:.3f},"limbo":{:.3f})",
                      mib(b.memory.surfaces), mib(b.memory.surface_trees), mib(b.memory.meshes),
                      mib(b.memory.box_trees), mib(b.memory.limbo)));
      counter("cells", at,
              fmt::format(R"("expanded again":{},"expanded first":{},"evicted":{})", b.reexpanded,
                          b.expanded - b.reexpanded, b.evicted));
    }
  }

  std::string take() const {
    return fmt::format("{{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n{}\n]}}\n", fmt::join(events_, ",\n"));
  }

 private:
  static std::string text(const std::string& t) { return to_json(json::text(t)); }
  static double mib(std::uint64_t bytes) { return double(bytes) / (1 << 20); }

  const Recording& recording_;
  const double start_s_;
  std::vector<std::string> events_;
};

}  // namespace

void MemorySamples::add(const Sample& sample) {
  if (seen_++ % stride_ != 0) return;
  if (list_.size() == max_memory_samples) {
    for (std::size_t i = 0; i < max_memory_samples / 2; ++i) list_[i] = list_[2 * i];
    list_.resize(max_memory_samples / 2);
    stride_ *= 2;
  }
  list_.push_back(sample);
}

PhaseTimes phase_times(const ExpansionProfile& profile, double load_s, double render_s, int threads,
                       bool expands_while_loading) {
  PhaseTimes t;
  t.load = load_s;
  for (const ThreadProfile& thread : profile.threads) {
    t.expand += thread.expand_s;
    t.build += thread.build_s;
    t.wait += thread.wait_s;
    t.trace += thread.trace_s;
  }
  const double rendering = render_s * threads, expanding = expands_while_loading ? 0 : t.expand + t.build + t.wait;
  t.trace = std::min(t.trace, std::max(0.0, rendering - expanding));
  t.shade = std::max(0.0, rendering - expanding - t.trace);
  return t;
}

Value recording_value(const Recording& recording, const PhaseTimes& phases) {
  const ExpansionProfile& p = recording.expansion;
  return json::object({{"start_s", seconds(recording.start_s)},
                       {"duration_s", seconds(p.duration_s)},
                       {"budget_bytes", p.budget_bytes ? json::count(p.budget_bytes) : Value{}},
                       {"phases_s", phases_value(phases)},
                       {"timeline", timeline_value(p)},
                       {"process", process_value(recording.process)},
                       {"classes", list(p.classes, class_value)},
                       {"threads", list(p.threads, thread_value)},
                       {"latency", latency_value(p.latency)},
                       {"waits", latency_value(p.waits)},
                       {"reuse", reuse_value(p.reuse)},
                       {"ray_stride", json::number(p.ray_stride)}});
}

std::string chrome_trace(const Recording& recording, double load_s, double render_s) {
  const ExpansionProfile& p = recording.expansion;
  const double end_s = recording.start_s + p.duration_s;
  TraceWriter trace(recording);
  trace.name_thread(0, "program");
  trace.span(0, "load", std::max(0.0, end_s - render_s - load_s), load_s);
  trace.span(0, "render", end_s - render_s, render_s);
  for (std::size_t i = 0; i < p.threads.size(); ++i) {
    trace.name_thread(i + 1, fmt::format("thread {}", i));
    trace.add_thread(i + 1, p.threads[i]);
  }
  trace.add_timeline(p);
  return trace.take();
}

}  // namespace meristem
