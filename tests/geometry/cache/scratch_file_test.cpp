#include "geometry/cache/scratch_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

namespace meristem {
namespace {

std::vector<int> numbers(int first, std::size_t count) {
  std::vector<int> result(count);
  for (int& n : result) n = first++;
  return result;
}

iovec part(std::vector<int>& values) { return {values.data(), values.size() * sizeof(int)}; }

TEST(ScratchFile, GivesBackWhatWasWritten) {
  const std::string directory = testing::TempDir();
  const auto files = [&] { return std::distance(std::filesystem::directory_iterator(directory), {}); };
  const auto before = files();
  ScratchFile file(directory);
  EXPECT_EQ(files(), before) << "it has no name";
  std::vector<int> a = numbers(0, 1000), none, b = numbers(5000, 3000), c = numbers(7, 1);
  const ScratchFile::Block first = file.write({part(a), part(none), part(b)}), second = file.write({part(c)});
  EXPECT_EQ(first.bytes, 16000u);
  std::vector<int> a2(1000), b2(3000), c2(1), last(2000);
  EXPECT_TRUE(file.read(second, 0, {part(c2)}));
  EXPECT_TRUE(file.read(first, 0, {part(a2), part(none), part(b2)}));
  EXPECT_TRUE(file.read(first, 8000, {part(last)}));
  EXPECT_EQ(a2, a);
  EXPECT_EQ(b2, b);
  EXPECT_EQ(c2, c);
  EXPECT_EQ(last, numbers(6000, 2000));
}

TEST(ScratchFile, UsesFreeRoomAgain) {
  ScratchFile file(testing::TempDir());
  std::vector<int> values = numbers(0, 2000), others = numbers(9, 1900), read(1900);
  const ScratchFile::Block a = file.write({part(values)}), b = file.write({part(values)});
  const std::uint64_t bytes = file.bytes();
  file.free(a);
  const ScratchFile::Block c = file.write({part(others)});
  EXPECT_EQ(c.offset, a.offset);
  EXPECT_NE(c.offset, b.offset);
  EXPECT_EQ(file.bytes(), bytes);
  EXPECT_TRUE(file.read(c, 0, {part(read)}));
  EXPECT_EQ(read, others);
}

TEST(ScratchFile, SaysWhyThereIsNone) {
  try {
    ScratchFile("/no/such/directory");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("No such file"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace meristem
