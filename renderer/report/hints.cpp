#include "renderer/report/hints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace meristem {

namespace {

// Below these, nothing is worth a word.
constexpr double notable_share = 0.02, notable_ratio = 2;
constexpr std::size_t most_rules = 3;

std::string percent(double share) { return fmt::format("{:.{}f} %", share * 100, share < 0.0995 ? 1 : 0); }

std::string duration(double s) {
  return s < 1e-3 ? fmt::format("{:.0f} \u00b5s", s * 1e6)
         : s < 1  ? fmt::format("{:.3g} ms", s * 1e3)
                  : fmt::format("{:.3g} s", s);
}

std::string name_of(const CellClass& cells) {
  return cells.rule.empty() ? fmt::format("the cells of model \"{}\" that carry no symbol", cells.model)
                            : fmt::format("rule \"{}\" of model \"{}\"", cells.rule, cells.model);
}

class HintWriter {
 public:
  explicit HintWriter(const RenderStatistics& s) : s_(s), p_(s.recording->expansion), phases_(statistics_phases(s)) {
    busy_s_ = phases_.expand + phases_.build + phases_.trace + phases_.shade + phases_.wait;
  }

  std::vector<Hint> take() {
    budget();
    bounds();
    waiting();
    latency();
    time();
    memory();
    std::ranges::stable_partition(hints_, &Hint::is_advice);
    return std::move(hints_);
  }

 private:
  void add(const char* about, std::string text, bool is_advice = false) {
    hints_.push_back({about, std::move(text), is_advice});
  }

  void budget() {
    const ReuseFigures& r = p_.reuse;
    const double expanded = double(s_.expansion.cells_expanded);
    if (p_.budget_bytes == 0 || expanded == 0) return;
    if (s_.expansion.evicted == 0)
      return add("budget", fmt::format("Nothing was evicted: all expanded geometry took {} of the budget of {}.",
                                       format_bytes(s_.expansion.resident_bytes_peak), format_bytes(p_.budget_bytes)));
    const double share = r.reexpanded / expanded;
    if (share < notable_share)
      return add("budget", fmt::format("The budget of {} suffices: {} of the expansions repeated earlier ones.",
                                       format_bytes(p_.budget_bytes), percent(share)));
    std::string text =
        fmt::format("With {}, {} of {} expansions ({}) repeated earlier ones. About {} would end re-expansion",
                    format_bytes(p_.budget_bytes), format_count(std::uint64_t(std::llround(r.reexpanded))),
                    format_count(s_.expansion.cells_expanded), percent(share), format_bytes(budget_for(0)));
    if (const std::uint64_t half = budget_for(0.5); double(half) < 0.9 * double(budget_for(0)))
      text += fmt::format("; {} would halve it", format_bytes(half));
    add("budget", text + ".", true);
  }

  // The smallest budget that leaves at most this share of the repeated expansions.
  std::uint64_t budget_for(double share) const {
    for (const ReuseFigures::Step& step : p_.reuse.by_budget)
      if (step.reexpanded <= share * p_.reuse.reexpanded) return step.budget_bytes;
    return std::uint64_t(p_.reuse.distinct_bytes);
  }

  // By rule, over all levels.
  void bounds() {
    std::map<std::pair<std::string, std::string>, CellClassFigures> rules;
    std::uint64_t visits = 0;
    for (const CellClassFigures& c : p_.classes) {
      CellClassFigures& rule = rules[{c.cells.model, c.cells.rule}];
      rule.cells = c.cells;
      rule.boxes += c.boxes;
      rule.box_ratio_sum += c.box_ratio_sum;
      rule.visits += c.visits;
      visits += c.visits;
    }
    std::vector<CellClassFigures> loose;
    for (const auto& [name, rule] : rules)
      if (rule.mean_box_ratio() >= notable_ratio && double(rule.visits) >= notable_share * double(visits))
        loose.push_back(rule);
    std::ranges::sort(loose, std::greater{},
                      [](const CellClassFigures& c) { return c.mean_box_ratio() * double(c.visits); });
    loose.resize(std::min(loose.size(), most_rules));
    for (const CellClassFigures& rule : loose)
      add("bounds",
          fmt::format(
              "Bounds of {} are {:.2g} times too large by area before expansion: {} of the rays that enter one do "
              "so in vain, and may expand it in vain. Tighter expressions in placements and rules help.",
              name_of(rule.cells), rule.mean_box_ratio(), percent(1 - 1 / rule.mean_box_ratio())),
          true);
  }

  void waiting() {
    if (busy_s_ <= 0 || phases_.wait < notable_share * busy_s_) return;
    add("waiting",
        fmt::format("Threads slept {} of their time ({}) until a cell was expanded that another thread was at; the "
                    "longest wait took {}. Smaller cells or a smaller first step share the work better.",
                    percent(phases_.wait / busy_s_), duration(phases_.wait), duration(p_.waits.max_s)),
        true);
  }

  void latency() {
    if (p_.latency.total() == 0) return;
    add("latency", fmt::format("Half of the expansions took less than {}, 99 % less than {}; the longest took {}.",
                               duration(p_.latency.quantile_s(0.5)), duration(p_.latency.quantile_s(0.99)),
                               duration(p_.latency.max_s)));
  }

  void time() {
    if (busy_s_ <= 0) return;
    const double growing = phases_.expand + phases_.build;
    std::string text = fmt::format("Of {} of thread time, {} went into expansion, {} into tracing and {} into shading",
                                   duration(busy_s_), percent(growing / busy_s_), percent(phases_.trace / busy_s_),
                                   percent(phases_.shade / busy_s_));
    const auto slowest = std::ranges::max_element(s_.expansion.by_step, {}, &StepStatistics::time_s);
    if (slowest != s_.expansion.by_step.end() && slowest->time_s > 0 && s_.expansion.time_s > 0)
      text += fmt::format(". The dearest step is \"{}\" of model \"{}\", with {} of the time of expansion",
                          slowest->step, slowest->model, percent(slowest->time_s / s_.expansion.time_s));
    add("time", text + ".");
  }

  void memory() {
    std::string text = fmt::format("The process held {} at most; {} of that was expanded geometry",
                                   format_bytes(s_.peak_rss_bytes), format_bytes(s_.expansion.resident_bytes_peak));
    if (s_.expansion.limbo_bytes_peak > 0)
      text += fmt::format(", {} evicted geometry that rays in flight might still use",
                          format_bytes(s_.expansion.limbo_bytes_peak));
    add("memory", text + fmt::format(", {} refinement plans that cells share.", format_bytes(s_.expansion.plan_bytes)));
  }

  const RenderStatistics& s_;
  const ExpansionProfile& p_;
  const PhaseTimes phases_;
  double busy_s_ = 0;  // of the threads, without loading
  std::vector<Hint> hints_;
};

}  // namespace

std::vector<Hint> hints_of(const RenderStatistics& s) {
  if (!s.recording) return {};
  return HintWriter(s).take();
}

}  // namespace meristem
