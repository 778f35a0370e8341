#include "geometry/fields/time.h"

namespace meristem {

namespace {

thread_local TimeScope* current_scope = nullptr;

}  // namespace

TimeScope::TimeScope(double time) : outer_(current_scope), time_(time) { current_scope = this; }
TimeScope::~TimeScope() { current_scope = outer_; }
TimeScope* TimeScope::current() { return current_scope; }

}  // namespace meristem
