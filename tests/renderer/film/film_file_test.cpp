#include "renderer/film/film_file.h"

#include "renderer/film/bytes.h"
#include "renderer/film/film_parts.h"
#include "tests/renderer/image/part_values.h"
#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>

namespace meristem {
namespace {

Film small_film() {
  Film film({3, 1, 7, 4}, 0.75f, parse_aovs("all"));
  FirstSurface first;
  first.hit.t = 1;
  first.material = 1;
  for (int y = 1; y < 4; ++y)
    for (int x = 3; x < 7; ++x) {
      first.hit.object = x % 2;
      first.production = y % 2 - 1;
      film.add(x, y, {.radiance = {0.1f * float(x), 1e-7f, 300}, .first = &first, .depth = float(y)});
    }
  return film;
}

FilmInfo small_info() {
  return {{{"seed", "3"}, {"scene", "abc"}},
          {{0, 8}, {16, 24}},
          64,
          48,
          {{"oak", "ash"}, {"default", "bark"}, {"grow 1"}},
          {{"Software", "here"}},
          {"first", "second"}};
}

TEST(FilmFile, ReturnsEverything) {
  const ScratchFolder folder;
  const Film film = small_film();
  const AdaptiveState adaptive{32, std::vector<std::uint8_t>(12, 1)};
  write_film_file(folder / "a.film", film, small_info(), adaptive);
  const FilmFile read = read_film_file(folder / "a.film");
  const FilmInfo info = small_info();
  EXPECT_EQ(read.info.identity, info.identity);
  EXPECT_EQ(read.info.ranges, info.ranges);
  EXPECT_EQ(read.info.frame_width, 64);
  EXPECT_EQ(read.info.frame_height, 48);
  EXPECT_EQ(read.info.names.objects, info.names.objects);
  EXPECT_EQ(read.info.names.productions, info.names.productions);
  EXPECT_EQ(read.info.metadata, info.metadata);
  EXPECT_EQ(read.info.history, info.history);
  EXPECT_EQ(read.film.window(), film.window());
  EXPECT_EQ(read.adaptive.decided_at, 32u);
  EXPECT_EQ(read.adaptive.finished, adaptive.finished);
  const auto expected = film_parts(film, info.names, false), found = film_parts(read.film, info.names, false);
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_EQ(values_of(found[i]), values_of(expected[i])) << found[i].name;
}

// Any byte that is changed, and any end that is missing, is found.
TEST(FilmFile, RefusesDamage) {
  const ScratchFolder folder;
  write_film_file(folder / "a.film", small_film(), small_info(), {});
  const std::string whole = read_text(folder / "a.film");
  const auto refused = [&](const std::string& bytes) {
    std::ofstream(folder / "b.film", std::ios::binary) << bytes;
    try {
      read_film_file(folder / "b.film");
      return false;
    } catch (const FileError&) {
      return true;
    }
  };
  EXPECT_FALSE(refused(whole));
  for (std::size_t i = 0; i < whole.size(); i += i < 500 ? 1 : 37) {
    std::string changed = whole;
    changed[i] = char(changed[i] ^ 0x10);
    EXPECT_TRUE(refused(changed)) << "byte " << i;
    EXPECT_TRUE(refused(whole.substr(0, i))) << i << " bytes";
  }
  EXPECT_TRUE(refused(whole + "x"));
  EXPECT_THROW(read_film_file(folder / "missing.film"), FileError);
}

TEST(FilmFile, AFullDiskLeavesTheOldFile) {
  const ScratchFolder folder;
  write_film_file(folder / "a.film", small_film(), small_info(), {});
  const std::string before = read_text(folder / "a.film");
  const FileSizeLimit limit(1000);
  EXPECT_THROW(write_film_file(folder / "a.film", small_film(), {}, {}), FileError);
  EXPECT_TRUE(read_text(folder / "a.film") == before);
  EXPECT_EQ(folder.files(), 1u);
}

// The check value of CRC-32/ISO-HDLC.
TEST(Bytes, Crc32IsThatOfZip) { EXPECT_EQ(crc32("123456789"), 0xcbf43926u); }

}  // namespace
}  // namespace meristem
