// What a part of an EXR file holds, as a whole.
#pragma once

#include "renderer/image/exr_parts.h"

#include <vector>

namespace meristem {

inline std::vector<float> values_of(const ExrPart& part) {
  std::vector<float> values(std::size_t(part.rows.width) * std::size_t(part.rows.height) * part.channels.size());
  part.rows.fill(0, part.rows.height, values.data());
  return values;
}

}  // namespace meristem
