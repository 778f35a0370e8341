// FaceOrigins: a list of what faces bring along from growth, for as long as a cell is resident. Faces that one
// production made differ by their keys and little else, so each has a key and the number of a kind: some 15 bytes
// instead of 48. Thread-safe to read.
#pragma once

#include "geometry/mesh/face_origin.h"

#include <cstddef>
#include <span>
#include <vector>

namespace meristem {

class FaceOrigins {
 public:
  FaceOrigins() = default;
  explicit FaceOrigins(std::span<const FaceOrigin> origins);

  std::size_t size() const { return keys_.size(); }
  bool empty() const { return keys_.empty(); }
  FaceOrigin operator[](std::size_t i) const {
    FaceOrigin origin = kinds_[kind_of_[i]];
    origin.key = keys_[i];
    return origin;
  }

  // Appends one and returns its number.
  std::uint32_t add(const FaceOrigin& origin);
  void append(const FaceOrigins& others);
  void shrink_to_fit();
  std::size_t bytes() const;

  // Calls visit(array, i) for each of its arrays, from number `first` on.
  static constexpr std::size_t arrays = 3;
  template <class Origins, class Visit>
  static void for_each_array(Origins& origins, std::size_t first, const Visit& visit) {
    visit(origins.keys_, first), visit(origins.kind_of_, first + 1), visit(origins.kinds_, first + 2);
  }

 private:
  std::vector<Key> keys_;
  std::vector<std::uint32_t> kind_of_;
  std::vector<FaceOrigin> kinds_;  // their keys mean nothing
};

}  // namespace meristem
