// Cryptomatte: mattes as channels of floats, with the names of things beside them (Friedman and Jones 2015, "Fully
// Automatic ID Mattes with Support for Motion Blur and Transparency"; the layout is that of version 1.2 of the
// specification). A pixel has ranks, the thing that covers most of it first: pairs of a hash of its name, taken as a
// float, and its coverage; two ranks make a layer R, G, B, A. Pure functions; any thread.
#pragma once

#include "renderer/film/matte.h"
#include "renderer/image/image.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace meristem::cryptomatte {

constexpr int layers = 3;  // six ranks

// MurmurHash3_x86_32 with the seed 0 (Appleby 2011).
std::uint32_t murmur_hash_3(std::string_view text);

// The hash of a name as Cryptomatte stores it: an exponent that would make a float infinite, NaN or a denormal has one
// bit flipped.
std::uint32_t name_hash(std::string_view name);
std::vector<std::uint32_t> name_hashes(const std::vector<std::string>& names);

// "crypto_object00.R", "crypto_object00.G", ... for all layers.
std::vector<std::string> channel_names(const std::string& type, int layer_count);

// What a part with these channels says of itself: hash, conversion and manifest, the JSON of names and hashes.
Metadata metadata(const std::string& type, const std::vector<std::string>& names);

// Writes the ranks of one pixel: pairs of hash and coverage, the largest first; `divisor` makes coverage of weights.
void write_ranks(const std::vector<MatteEntry>& entries, const std::vector<std::uint32_t>& hashes, double divisor,
                 int layer_count, float* out);

}  // namespace meristem::cryptomatte
