#include "procedural/plants/child_rows.h"

#include <algorithm>

namespace meristem {

void ChildRows::make_room(std::size_t children) {
  const std::size_t wanted = size() + children + group;
  if (wanted <= length_) return;
  const std::size_t length = std::max(wanted, 2 * length_);
  std::vector<double> rows(row_count * length);
  for (int r = 0; r < row_count; ++r) std::copy_n(view()[r], size(), &rows[std::size_t(r) * length]);
  rows_.swap(rows);
  length_ = length;
}

}  // namespace meristem
