#include "geometry/accel/expansion_counts.h"

#include <algorithm>
#include <chrono>

namespace meristem {

namespace {

// The name in the scene: those of individuals differ behind a "#".
std::string kind_of(const Model& model) { return model.name().substr(0, model.name().find('#')); }

// What the scene calls the symbol of a cell's first face.
std::string rule_of(const MadeCell& cell) {
  std::string name;
  for (int level = 0; level < cell.model.levels() && name.empty() && cell.symbol >= 0; ++level)
    name = cell.model.step(level).symbol_name(cell.symbol);
  return name;
}

}  // namespace

double ExpansionCounts::now_s() const {
  if (recorder_) return recorder_->now_s();
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void ExpansionCounts::add(const Model& model, const Expansion& expansion, double seconds) {
  const std::string kind = kind_of(model);
  const std::lock_guard lock(mutex_);
  faces_ += expansion.faces;
  time_s_ += seconds;
  for (std::size_t level = 0; level < expansion.work.size(); ++level) {
    const StepWork& work = expansion.work[level];
    if (work.faces == 0) continue;
    const std::string name = model.step(int(level)).name();
    auto row =
        std::ranges::find_if(by_step_, [&](const StepStatistics& s) { return s.model == kind && s.step == name; });
    if (row == by_step_.end()) row = by_step_.insert(row, StepStatistics{kind, name, 0, 0, 0});
    ++row->cells;
    row->faces += work.faces;
    row->time_s += work.time_s;
  }
}

void ExpansionCounts::add(const MadeCell& cell, CacheEntry& entry) {
  add(cell.model, cell.expansion, now_s() - cell.start_s);
  if (recorder_) record(cell, entry);
}

void ExpansionCounts::record(const MadeCell& cell, CacheEntry& entry) const {
  CellLabel& label = entry.label;
  label.cell = hash_keys(hash_text(cell.model.name()), cell.key, Key(cell.level));
  label.cell_class = recorder_->class_of({kind_of(cell.model), cell.level, rule_of(cell), label.is_surface});
  RecordedExpansion record{label.cell_class,   cell.start_s,         cell.built_from_s,
                           recorder_->now_s(), cell.expansion.faces, entry.bytes};
  const double real_area = double(cell.real_bounds.surface_area());
  if (label.is_surface && real_area > 0) record.box_ratio = double(cell.bounds.surface_area()) / real_area;
  recorder_->add_expansion(record);
}

void ExpansionCounts::add_defect(std::string message) {
  const std::lock_guard lock(mutex_);
  ++failed_;
  defects_.insert(std::move(message));
}

void ExpansionCounts::write(ExpansionStatistics& statistics) const {
  const std::lock_guard lock(mutex_);
  statistics.faces = faces_;
  statistics.time_s = time_s_;
  statistics.failed = failed_;
  statistics.by_step = by_step_;
  statistics.defects.assign(defects_.begin(), defects_.end());
}

}  // namespace meristem
