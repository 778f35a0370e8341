// UTF-8 (RFC 3629): finding what is not, and writing one character.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace meristem {

// The offset of the first byte that begins no well-formed character (too long an encoding, a surrogate, above U+10FFFF,
// cut short), or npos. Linear, no allocation.
std::size_t find_invalid_utf8(std::string_view text);

// Appends a code point (at most U+10FFFF and no surrogate).
void append_utf8(std::string& text, std::uint32_t code);

}  // namespace meristem
