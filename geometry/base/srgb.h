// sRGB: how images and mesh files encode colours (IEC 61966-2-1).
#pragma once

#include <cmath>

namespace meristem {

// Of a channel from 0 to 1.
inline double linear_of_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace meristem
