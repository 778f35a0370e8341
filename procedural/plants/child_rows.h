// ChildRows: the children of a stem, stems or leaves, a row for each number, so that they are placed many at a time
// (child_kernels.h). For one thread.
#pragma once

#include "geometry/base/key.h"
#include "geometry/base/transform.h"

#include <cstddef>
#include <vector>

namespace meristem {

class ChildRows {
 public:
  // Of a child: its distance along the stem in metres, its place (0 at the first child there may be, 1 at the tip), the
  // part of its segment that is below it; how far it is turned around the stem, and away from it, in radians; its
  // frame.
  enum Row { along, place, part, around, away, x_axis, y_axis = x_axis + 3, z_axis = y_axis + 3, origin = z_axis + 3 };
  static constexpr int row_count = origin + 3;

  // Rows as kernels see them. They may write behind the last child, less than a group of them.
  static constexpr std::size_t group = 8;
  struct View {
    double* first;
    std::size_t length;
    double* operator[](int row) const { return first + std::size_t(row) * length; }
  };

  std::size_t size() const { return keys_.size(); }
  void clear() { keys_.clear(); }
  // Room for so many more.
  void make_room(std::size_t children);
  // Appends one and returns its index; there must be room.
  std::size_t add(Key key) {
    keys_.push_back(key);
    return keys_.size() - 1;
  }

  View view() { return {rows_.data(), length_}; }
  Key key(std::size_t i) const { return keys_[i]; }
  double at(Row row, std::size_t i) const { return rows_[std::size_t(row) * length_ + i]; }
  Affine3d frame(std::size_t i) const {
    return {vector(x_axis, i), vector(y_axis, i), vector(z_axis, i), vector(origin, i)};
  }

 private:
  Vec3d vector(Row row, std::size_t i) const {
    const double* v = &rows_[std::size_t(row) * length_ + i];
    return {v[0], v[length_], v[2 * length_]};
  }

  std::vector<Key> keys_;
  std::vector<double> rows_;
  std::size_t length_ = 0;  // of a row
};

}  // namespace meristem
