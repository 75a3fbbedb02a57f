// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/atomic_file.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "recording/captures.h"
#include "support/temp_folder.h"

namespace ada::test {
namespace {

TEST(AtomicFile, AppearsOnlyWithCommit) {
  const TempFolder folder;
  AtomicFile file(folder / "a");
  file.write("content");
  file.flush();
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
  file.commit();
  EXPECT_EQ(read_file(folder / "a"), "content");
  EXPECT_EQ(folder.names().size(), 1u);
}

TEST(AtomicFile, LeavesTheOldFileAndNothingElseWithoutCommit) {
  const TempFolder folder;
  write_file(folder / "a", "old");
  {
    AtomicFile file(folder / "a");
    file.write(std::string(1 << 20, 'x')); // more than the buffer, so the disk has some of it
  }
  EXPECT_EQ(read_file(folder / "a"), "old");
  EXPECT_EQ(folder.names().size(), 1u);
}

TEST(AtomicFile, RemovesTheTemporaryWhenTheRenameFails) {
  const TempFolder folder;
  {
    AtomicFile file(folder / "a");
    file.write("content");
    std::filesystem::create_directory(folder / "a"); // a file cannot replace a folder
    ada4571_status status = ADA4571_OK;
    EXPECT_NE(failure([&] { file.commit(); }, &status), "");
    EXPECT_EQ(status, ADA4571_ERROR_IO);
  }
  EXPECT_EQ(folder.names().size(), 1u);
}

TEST(AtomicFile, KeepsPermissionsOfTheFileItReplaces) {
  const TempFolder folder;
  write_file(folder / "a", "old");
  ::chmod((folder / "a").c_str(), 0640);
  AtomicFile file(folder / "a");
  file.commit();
  struct stat info {};
  ASSERT_EQ(::stat((folder / "a").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 07777, 0640u);
}

TEST(AtomicFile, FollowsALinkToItsTarget) {
  const TempFolder folder;
  write_file(folder / "target", "old");
  std::filesystem::create_symlink(folder / "target", folder / "link");
  AtomicFile file(folder / "link");
  file.write("new");
  file.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(folder / "target"), "new");
}

TEST(AtomicFile, HasNoNameUntilItIsComplete) {
  const TempFolder folder;
  write_file(folder / "a", "old");
  AtomicFile file(folder / "a");
  file.write("new");
  file.sync();
  // Where the file system has no nameless files there is a second one, of a documented name.
  EXPECT_LE(folder.names().size(), 2u);
  for (const std::string &name : folder.names())
    EXPECT_TRUE(name == "a" || (name.starts_with("a.") && name.ends_with(".tmp"))) << name;
  EXPECT_EQ(read_file(folder / "a"), "old");
  file.commit();
  EXPECT_EQ(folder.names().size(), 1u);
  EXPECT_EQ(read_file(folder / "a"), "new");
}

TEST(AtomicFile, FollowsALinkToWhatIsNotThereYet) {
  const TempFolder folder;
  std::filesystem::create_symlink("target", folder / "link");
  AtomicFile file(folder / "link");
  file.write("new");
  file.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(folder / "target"), "new");
}

TEST(AtomicFile, NeverReplacesADevice) {
  AtomicFile file("/dev/null");
  EXPECT_TRUE(file.in_place());
  file.write("content");
  file.commit();
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(AtomicFile, ReportsAFullDiskByItsReason) {
  AtomicFile file("/dev/full");
  file.write("content");
  EXPECT_EQ(failure([&] { file.commit(); }), "/dev/full: cannot write: No space left on device");
}

TEST(AtomicFile, ReportsAMissingFolderAtOnce) {
  const TempFolder folder;
  ada4571_status status = ADA4571_OK;
  EXPECT_EQ(failure([&] { AtomicFile file(folder / "no/a"); }, &status),
            (folder / "no/a") + ": cannot create: No such file or directory");
  EXPECT_EQ(status, ADA4571_ERROR_NOT_FOUND);
}

} // namespace
} // namespace ada::test
