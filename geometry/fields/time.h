// TimeScope: what `time` is in expressions.
#pragma once

namespace meristem {

// While it lives, `time` in expressions that this thread compiles is this constant, in frames, unless they have a
// variable of that name; without one there is no `time`. Scopes nest: the innermost one holds.
class TimeScope {
 public:
  explicit TimeScope(double time);
  ~TimeScope();
  TimeScope(const TimeScope&) = delete;
  TimeScope& operator=(const TimeScope&) = delete;

  static TimeScope* current();  // null: none

  double read() {
    was_read_ = true;
    return time_;
  }
  // Whether some expression named it: another time may give something else.
  bool was_read() const { return was_read_; }

 private:
  TimeScope* outer_;
  double time_;
  bool was_read_ = false;
};

}  // namespace meristem
