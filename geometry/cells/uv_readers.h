// UvReaders: which materials read u, v of what is hit. A surface without any of them does not keep u, v. Immutable; any
// thread.
#pragma once

#include "geometry/mesh/face_origin.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace meristem {

class UvReaders {
 public:
  // Whoever may ask: all are kept.
  UvReaders() = default;
  // By number; those of faces that name none are of the first.
  explicit UvReaders(std::vector<bool> materials) : all_(false), materials_(std::move(materials)) {}

  bool reads(const FaceOrigin& origin) const {
    const auto number = std::size_t(std::max(origin.material, 0));
    return all_ || number >= materials_.size() || materials_[number];
  }

 private:
  bool all_ = true;
  std::vector<bool> materials_;
};

}  // namespace meristem
