#include "renderer/film/film_file.h"

#include "renderer/film/bytes.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace meristem {

namespace {

constexpr std::string_view magic("MERISTEM FILM 3\n");
constexpr int largest_side = 65536;

void put_texts(ByteWriter& out, const std::vector<std::string>& texts) {
  out.put(std::uint64_t(texts.size()));
  for (const std::string& text : texts) out.put_text(text);
}

std::vector<std::string> get_texts(ByteReader& in) {
  std::vector<std::string> texts(in.get_count(sizeof(std::uint64_t)));
  for (std::string& text : texts) text = in.get_text();
  return texts;
}

void put_pairs(ByteWriter& out, const std::vector<std::pair<std::string, std::string>>& pairs) {
  out.put(std::uint64_t(pairs.size()));
  for (const auto& [name, value] : pairs) {
    out.put_text(name);
    out.put_text(value);
  }
}

std::vector<std::pair<std::string, std::string>> get_pairs(ByteReader& in) {
  std::vector<std::pair<std::string, std::string>> pairs(in.get_count(2 * sizeof(std::uint64_t)));
  for (auto& [name, value] : pairs) {
    name = in.get_text();
    value = in.get_text();
  }
  return pairs;
}

std::string info_bytes(const FilmInfo& info) {
  ByteWriter out;
  put_pairs(out, info.identity);
  out.put_array(info.ranges);
  out.put(std::int32_t(info.frame_width));
  out.put(std::int32_t(info.frame_height));
  put_texts(out, info.names.objects);
  put_texts(out, info.names.materials);
  put_texts(out, info.names.productions);
  put_pairs(out, info.metadata);
  put_texts(out, info.history);
  return out.bytes();
}

FilmInfo info_of_bytes(std::string_view bytes) {
  ByteReader in(bytes);
  FilmInfo info;
  info.identity = get_pairs(in);
  info.ranges = in.get_array<SampleRange>();
  info.frame_width = in.get<std::int32_t>();
  info.frame_height = in.get<std::int32_t>();
  info.names.objects = get_texts(in);
  info.names.materials = get_texts(in);
  info.names.productions = get_texts(in);
  info.metadata = get_pairs(in);
  info.history = get_texts(in);
  return info;
}

void append_section(AtomicFile& file, std::string_view bytes) {
  ByteWriter head;
  head.put(std::uint64_t(bytes.size()));
  head.put(crc32(bytes));
  file.append(head.bytes());
  file.append(bytes);
}

std::string_view next_section(ByteReader& in) {
  const auto size = in.get<std::uint64_t>();
  const auto crc = in.get<std::uint32_t>();
  const std::string_view bytes = in.take(size);
  if (crc32(bytes) != crc) throw DamagedBytes();
  return bytes;
}

std::string read_whole(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw FileError(fmt::format("cannot read {}: {}", path, error ? error.message() : "it is not a regular file"));
  std::ifstream in(path, std::ios::binary);
  std::string bytes(std::filesystem::file_size(path, error), '\0');
  if (!in.read(bytes.data(), std::streamsize(bytes.size())))
    throw FileError(fmt::format("cannot read {}: {}", path, std::strerror(errno)));
  return bytes;
}

bool is_plausible(const PixelWindow& w) {
  return w.x0 >= 0 && w.y0 >= 0 && w.x1 <= largest_side && w.y1 <= largest_side && !w.empty();
}

}  // namespace

// The one that knows how a film lies in memory.
class FilmStorage {
 public:
  static std::string bytes_of(const Film& film) {
    ByteWriter out;
    out.put(film.window_);
    out.put(film.mean_weight_);
    out.put_array(film.aovs_);
    out.put_array(film.pixels_);
    out.put_array(film.squares_);
    out.put_array(film.second_halves_);
    out.put_array(film.surfaces_);
    out.put_array(film.nearest_);
    out.put_array(film.costs_);
    for (const Matte& matte : film.mattes_)
      for (std::size_t i = 0; i < matte.pixel_count(); ++i) out.put_array(matte.entries(i));
    return out.bytes();
  }

  static Film film_of(std::string_view bytes, const SceneNames& names) {
    ByteReader in(bytes);
    const auto window = in.get<PixelWindow>();
    const auto mean_weight = in.get<float>();
    const auto aovs = in.get_array<Aov>();
    const std::uint64_t pixels =
        is_plausible(window) ? std::uint64_t(window.width()) * std::uint64_t(window.height()) : 0;
    if (pixels == 0 || pixels > bytes.size() / sizeof(Film::Pixel) || !std::isfinite(mean_weight)) throw DamagedBytes();
    for (const Aov aov : aovs)
      if (std::size_t(aov) >= aov_infos().size()) throw DamagedBytes();
    Film film(window, mean_weight, aovs);
    replace(film.pixels_, in);
    replace(film.squares_, in);
    replace(film.second_halves_, in);
    replace(film.surfaces_, in);
    replace(film.nearest_, in);
    replace(film.costs_, in);
    const std::array counts{names.objects.size(), names.materials.size(), names.productions.size()};
    for (std::size_t m = 0; m < Film::matte_count; ++m) read_matte(film.mattes_[m], counts[m], in);
    if (!in.at_end()) throw DamagedBytes();
    return film;
  }

 private:
  template <class T>
  static void replace(ZeroedVector<T>& values, ByteReader& in) {
    auto read = in.get_array_as<ZeroedVector<T>>();
    if (read.size() != values.size()) throw DamagedBytes();
    values = std::move(read);
  }

  static void read_matte(Matte& matte, std::size_t things, ByteReader& in) {
    for (std::size_t i = 0; i < matte.pixel_count(); ++i)
      for (const MatteEntry& entry : in.get_array<MatteEntry>()) {
        if (entry.thing < 0 || std::size_t(entry.thing) >= things) throw DamagedBytes();
        matte.add(i, entry);
      }
  }
};

void write_film_file(const std::string& path, const Film& film, const FilmInfo& info, const AdaptiveState& adaptive) {
  AtomicFile file(path);
  file.append(magic);
  append_section(file, info_bytes(info));
  append_section(file, FilmStorage::bytes_of(film));
  ByteWriter state;
  state.put(adaptive.decided_at);
  state.put_array(adaptive.finished);
  append_section(file, state.bytes());
  file.commit();
}

FilmFile read_film_file(const std::string& path) {
  const std::string bytes = read_whole(path);
  if (!bytes.starts_with(magic))
    throw FileError(fmt::format("cannot read {}: it is no film file of this version", path));
  try {
    ByteReader in(std::string_view(bytes).substr(magic.size()));
    FilmInfo info = info_of_bytes(next_section(in));
    Film film = FilmStorage::film_of(next_section(in), info.names);
    ByteReader state(next_section(in));
    AdaptiveState adaptive{state.get<std::uint32_t>(), state.get_array<std::uint8_t>()};
    const std::size_t pixels = std::size_t(film.window().width()) * std::size_t(film.window().height());
    if (!in.at_end() || (!adaptive.finished.empty() && adaptive.finished.size() != pixels)) throw DamagedBytes();
    return {std::move(info), std::move(film), std::move(adaptive)};
  } catch (const DamagedBytes& error) {
    throw FileError(fmt::format("cannot read {}: {}", path, error.what()));
  }
}

}  // namespace meristem
