#include "apps/io/safe_write.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>

#include "tests/apps/io/temporary_directory.h"

namespace grainlaw::io {
namespace {

std::size_t entries(const TemporaryDirectory& directory) {
  const std::filesystem::directory_iterator begin(directory.path());
  return static_cast<std::size_t>(std::distance(begin, {}));
}

TEST(SafeWrite, WhatIsWrittenIsReadBackAndNothingElseIsLeft) {
  const TemporaryDirectory directory;
  const std::string bytes("a\0b\n\xff", 5);
  safe_write(directory / "file", bytes);
  safe_write(directory / "file", bytes);
  EXPECT_EQ(read_file(directory / "file"), bytes);
  EXPECT_EQ(entries(directory), 1u);
}

TEST(SafeWrite, AFullDiskLeavesTheOldFileAndNoTemporaryOne) {
  const TemporaryDirectory directory;
  directory.write("file", "old");
  // A limit on the size of files fails like a full disk: write() returns an error part of the way.
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100000, 100000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      safe_write(directory / "file", std::string(1000000, 'x'));
    } catch (const FileError& error) {
      std::_Exit(std::string(error.what()).find("File too large") != std::string::npos ? 7 : 8);
    }
    std::_Exit(9);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(read_file(directory / "file"), "old");
  EXPECT_EQ(entries(directory), 1u);
}

TEST(SafeWrite, AKilledWriterLeavesTheOldFileOrTheWholeNewOne) {
  const TemporaryDirectory directory;
  const std::string old_bytes(3000000, 'o');
  const std::string new_bytes(3000000, 'n');
  for (int trial = 0; trial < 30; ++trial) {
    safe_write(directory / "file", old_bytes);
    const pid_t child = ::fork();
    if (child == 0) {
      while (true) safe_write(directory / "file", new_bytes);
    }
    ::usleep(static_cast<useconds_t>(300 * trial));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const std::string bytes = read_file(directory / "file");
    EXPECT_TRUE(bytes == old_bytes || bytes == new_bytes) << "trial " << trial;
  }
}

TEST(SafeWrite, ErrorsNameThePathAndTheSystemError) {
  try {
    safe_write("/no/such/directory/file", "x");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_STREQ(error.what(), "cannot write /no/such/directory/file: No such file or directory");
  }
}

TEST(SafeWrite, DevicesAreWrittenToAndLinksStayLinks) {
  const TemporaryDirectory directory;
  EXPECT_NO_THROW(safe_write("/dev/null", "x"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  directory.write("target", "old");
  std::filesystem::create_symlink("target", directory / "link");
  safe_write(directory / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(directory / "link"));
  EXPECT_EQ(read_file(directory / "target"), "new");
}

TEST(SafeWrite, TheFileBeforeIsKeptUnderItsOtherName) {
  const TemporaryDirectory directory;
  for (const char* bytes : {"first", "second", "third"}) {
    safe_write_keeping(directory / "previous", directory / "file", bytes);
  }
  EXPECT_EQ(read_file(directory / "file"), "third");
  EXPECT_EQ(read_file(directory / "previous"), "second");
  EXPECT_EQ(entries(directory), 2u);
}

TEST(SafeWrite, OnlyWhatAWriterOfThisFileLeftIsRemoved) {
  const TemporaryDirectory directory;
  for (const char* name :
       {"file", "file.12.0.tmp", "file.notes.tmp", "file.tmp", "other.12.0.tmp"}) {
    directory.write(name, "x");
  }
  remove_temporaries(directory / "file");
  EXPECT_EQ(entries(directory), 4u);
  EXPECT_FALSE(std::filesystem::exists(directory / "file.12.0.tmp"));
}

TEST(ReadFile, TooLargeAFileIsRefused) {
  const TemporaryDirectory directory;
  EXPECT_THROW(read_file(directory.write("file", std::string(2000, 'x')), 1999), ReadError);
  EXPECT_EQ(read_file(directory / "file", 2000).size(), 2000u);
}

}  // namespace
}  // namespace grainlaw::io
