#include "geometry/fields/grid.h"

namespace meristem {

namespace {

thread_local GridSource* current_source = nullptr;

}  // namespace

GridScope::GridScope(GridSource* source) : outer_(current_source) { current_source = source; }
GridScope::~GridScope() { current_source = outer_; }
GridSource* GridScope::current() { return current_source; }

}  // namespace meristem
