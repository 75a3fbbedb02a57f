// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/atomic_file.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

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

TEST(AtomicFile, WritesPiecesInTheirOrderAfterWhatCameBefore) {
  const TempFolder folder;
  AtomicFile file(folder / "a");
  std::vector<std::string> some;
  std::string all = "before ";
  for (std::size_t k = 0; k < 40; ++k) // more than one call takes; some are empty
    some.emplace_back(k % 5 * 1000, static_cast<char>('a' + k % 26));
  for (const std::string &piece : some)
    all += piece;
  file.expect(all.size());
  file.write("before ");
  const std::vector<std::string_view> pieces(some.begin(), some.end());
  file.write(pieces);
  file.commit();
  EXPECT_EQ(read_file(folder / "a"), all);
}

/// A pipe takes what it has room for: the rest follows from within a piece.
TEST(AtomicFile, WritesPiecesToAPipeThatTakesAPartAtATime) {
  const TempFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const std::string piece(30011, 'x');
  const std::vector<std::string_view> pieces(20, piece);
  std::size_t read = 0;
  std::thread reader([&] {
    std::ifstream from(pipe, std::ios::binary);
    char some[997];
    while (from.read(some, sizeof some) || from.gcount() > 0)
      read += static_cast<std::size_t>(from.gcount());
  });
  {
    AtomicFile file(pipe);
    file.expect(1); // no regular file: nothing to make room in
    file.write(pieces);
    file.commit();
  }
  reader.join();
  EXPECT_EQ(read, 20 * piece.size());
}

TEST(AtomicFile, RefusesMoreBytesThanTheDiskHasRoomFor) {
  const TempFolder folder;
  struct statvfs disk {};
  ASSERT_EQ(::statvfs((folder / "").c_str(), &disk), 0);
  const std::uint64_t room = std::uint64_t{disk.f_blocks} * disk.f_frsize;
  AtomicFile file(folder / "a");
  ada4571_status status = ADA4571_OK;
  const std::string said = failure([&] { file.expect(room + (1 << 20)); }, &status);
  if (said.empty())
    GTEST_SKIP() << "this file system does not say how much room there is";
  EXPECT_EQ(status, ADA4571_ERROR_IO);
  EXPECT_NE(said.find("No space left"), std::string::npos) << said;
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
