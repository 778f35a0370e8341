#include "geometry/mesh/face_origins.h"

#include <algorithm>

namespace meristem {

FaceOrigins::FaceOrigins(std::span<const FaceOrigin> origins) {
  keys_.reserve(origins.size());
  kind_of_.reserve(origins.size());
  for (const FaceOrigin& origin : origins) add(origin);
  kinds_.shrink_to_fit();
}

std::uint32_t FaceOrigins::add(const FaceOrigin& origin) {
  // What is equal stands close together: faces of one leaf, of one stem
  constexpr std::size_t looked_at = 8;
  FaceOrigin kind = origin;
  kind.key = 0;
  std::size_t number = kinds_.size();
  const std::size_t end = number - std::min(number, looked_at);
  while (number > end && kinds_[number - 1] != kind) --number;
  if (number == end) kinds_.push_back(kind), number = kinds_.size();
  keys_.push_back(origin.key);
  kind_of_.push_back(std::uint32_t(number) - 1);
  return std::uint32_t(keys_.size()) - 1;
}

void FaceOrigins::append(const FaceOrigins& others) {
  const auto first = std::uint32_t(kinds_.size());
  keys_.insert(keys_.end(), others.keys_.begin(), others.keys_.end());
  for (std::uint32_t kind : others.kind_of_) kind_of_.push_back(first + kind);
  kinds_.insert(kinds_.end(), others.kinds_.begin(), others.kinds_.end());
}

void FaceOrigins::shrink_to_fit() {
  for_each_array(*this, 0, [](auto& list, std::size_t) { list.shrink_to_fit(); });
}

std::size_t FaceOrigins::bytes() const {
  std::size_t sum = 0;
  for_each_array(*this, 0, [&](const auto& list, std::size_t) { sum += list.capacity() * sizeof(list[0]); });
  return sum;
}

}  // namespace meristem
