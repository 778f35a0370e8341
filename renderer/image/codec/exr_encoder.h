// EXR files of several parts, in memory.
#pragma once

#include "renderer/image/exr_parts.h"

#include <string>
#include <vector>

namespace meristem {

// See ImageCodec::encode_parts().
std::vector<unsigned char> encode_exr_parts(const std::string& path, const std::vector<ExrPart>& parts,
                                            const ExrFrame& frame, const Metadata& metadata);

}  // namespace meristem
