#include "renderer/image/atomic_file.h"

#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

#include <filesystem>

#include <sys/stat.h>

namespace meristem {
namespace {

namespace fs = std::filesystem;

TEST(AtomicFile, WritesTheTextAndLeavesNothingElse) {
  const ScratchFolder folder;
  write_file(folder / "a.txt", "first");
  write_file(folder / "a.txt", "second");
  EXPECT_EQ(read_text(folder / "a.txt"), "second");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(AtomicFile, WithoutCommitTheOldFileStays) {
  const ScratchFolder folder;
  write_file(folder / "a.txt", "old");
  {
    AtomicFile file(folder / "a.txt");
    file.append("new");
  }
  EXPECT_EQ(read_text(folder / "a.txt"), "old");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(AtomicFile, NothingIsSeenBeforeItIsWhole) {
  const ScratchFolder folder;
  AtomicFile file(folder / "a.txt");
  file.append("half");
  EXPECT_FALSE(fs::exists(folder / "a.txt"));
  file.append(" and half");
  file.commit();
  EXPECT_EQ(read_text(folder / "a.txt"), "half and half");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(AtomicFile, KeepsPermissionsAndFollowsLinks) {
  const ScratchFolder folder;
  write_file(folder / "real.txt", "old");
  ::chmod((folder / "real.txt").c_str(), 0640);
  fs::create_symlink("real.txt", folder / "link.txt");
  write_file(folder / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(read_text(folder / "real.txt"), "new");
  EXPECT_EQ(fs::status(folder / "real.txt").permissions(), fs::perms(0640));
}

TEST(AtomicFile, RefusesWhatIsNotARegularFile) {
  const ScratchFolder folder;
  fs::create_symlink("/dev/full", folder / "device.txt");
  fs::create_directory(folder / "folder.txt");
  for (const char* name : {"device.txt", "folder.txt"}) {
    EXPECT_THROW(write_file(folder / name, "text"), FileError) << name;
    EXPECT_THROW(check_writable(folder / name), FileError) << name;
  }
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(AtomicFile, AFolderThatCannotTakeItIsAnErrorWithThePath) {
  const ScratchFolder folder;
  write_file(folder / "plain", "a file, not a folder");
  for (const std::string& path : {folder / "missing/a.txt", folder / "plain/a.txt"}) {
    try {
      check_writable(path);
      ADD_FAILURE() << path;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
    EXPECT_THROW(write_file(path, "text"), FileError);
  }
}

TEST(AtomicFile, AFullDiskLeavesTheOldFile) {
  const ScratchFolder folder;
  write_file(folder / "a.txt", "old");
  {
    const FileSizeLimit limit(1000);
    EXPECT_THROW(write_file(folder / "a.txt", std::string(5000, 'x')), FileError);
  }
  EXPECT_EQ(read_text(folder / "a.txt"), "old");
  EXPECT_EQ(folder.files(), 1u);
}

}  // namespace
}  // namespace meristem
