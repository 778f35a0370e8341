#include "renderer/film/cryptomatte.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <set>

namespace meristem::cryptomatte {

namespace {

std::uint32_t mixed(std::uint32_t k) { return std::rotl(k * 0xcc9e2d51u, 15) * 0x1b873593u; }

std::uint32_t finished(std::uint32_t h) {
  h ^= h >> 16;
  h *= 0x85ebca6bu;
  h ^= h >> 13;
  h *= 0xc2b2ae35u;
  return h ^ (h >> 16);
}

std::string escaped(std::string_view name) {
  std::string result;
  for (const char c : name) {
    if (c == '"' || c == '\\') result += '\\';
    if (std::uint8_t(c) < 0x20)
      result += fmt::format("\\u{:04x}", std::uint8_t(c));
    else
      result += c;
  }
  return result;
}

std::string manifest(const std::vector<std::string>& names) {
  std::string text = "{";
  const std::set<std::string> unique(names.begin(), names.end());
  for (const std::string& name : unique)
    text += fmt::format("{}\"{}\":\"{:08x}\"", text.size() > 1 ? "," : "", escaped(name), name_hash(name));
  return text + "}";
}

}  // namespace

std::uint32_t murmur_hash_3(std::string_view text) {
  std::uint32_t h = 0;
  const auto byte = [&](std::size_t i) { return std::uint32_t(std::uint8_t(text[i])); };
  const std::size_t blocks = text.size() / 4;
  for (std::size_t i = 0; i < blocks; ++i) {
    const std::uint32_t k = byte(4 * i) | byte(4 * i + 1) << 8 | byte(4 * i + 2) << 16 | byte(4 * i + 3) << 24;
    h = std::rotl(h ^ mixed(k), 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t tail = 0;
  for (std::size_t i = text.size(); i > 4 * blocks; --i) tail = tail << 8 | byte(i - 1);
  if (text.size() % 4) h ^= mixed(tail);
  return finished(h ^ std::uint32_t(text.size()));
}

std::uint32_t name_hash(std::string_view name) {
  const std::uint32_t hash = murmur_hash_3(name);
  const std::uint32_t exponent = hash >> 23 & 255;
  return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

std::vector<std::uint32_t> name_hashes(const std::vector<std::string>& names) {
  std::vector<std::uint32_t> hashes;
  for (const std::string& name : names) hashes.push_back(name_hash(name));
  return hashes;
}

std::vector<std::string> channel_names(const std::string& type, int layer_count) {
  std::vector<std::string> names;
  for (int layer = 0; layer < layer_count; ++layer)
    for (const char channel : {'R', 'G', 'B', 'A'}) names.push_back(fmt::format("{}{:02}.{}", type, layer, channel));
  return names;
}

Metadata metadata(const std::string& type, const std::vector<std::string>& names) {
  // The key of a matte in the header: the first seven digits of the hash of its name
  const std::string key = fmt::format("cryptomatte/{:.7}/", fmt::format("{:08x}", name_hash(type)));
  return {{key + "name", type},
          {key + "hash", "MurmurHash3_32"},
          {key + "conversion", "uint32_to_float32"},
          {key + "manifest", manifest(names)}};
}

void write_ranks(const std::vector<MatteEntry>& entries, const std::vector<std::uint32_t>& hashes, double divisor,
                 int layer_count, float* out) {
  std::vector<MatteEntry> ranked;
  for (const MatteEntry& e : entries)
    if (e.weight > 0) ranked.push_back(e);
  std::ranges::stable_sort(ranked, std::greater(), &MatteEntry::weight);
  const std::size_t ranks = std::min(ranked.size(), std::size_t(2 * layer_count));
  std::fill(out, out + 4 * layer_count, 0.0f);
  for (std::size_t i = 0; i < ranks && divisor > 0; ++i) {
    out[2 * i] = std::bit_cast<float>(hashes[std::size_t(ranked[i].thing)]);
    out[2 * i + 1] = float(std::min(1.0, ranked[i].weight / divisor));
  }
}

}  // namespace meristem::cryptomatte
