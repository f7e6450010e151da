#include "apps/directory_lock.h"

#include <gtest/gtest.h>

#include <fstream>

#include "apps/io/input_file.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

std::string refusal(const fs::path& directory) {
  try {
    const DirectoryLock lock(directory);
  } catch (const io::FileError& error) {
    return error.what();
  }
  return "locked";
}

TEST(DirectoryLock, AFolderThatHoldsNothingInTheEndIsGone) {
  const io::TemporaryDirectory directory;
  {
    const DirectoryLock lock(directory / "a/b/");
    fs::create_directories(directory / "a/b/runs");
    EXPECT_NE(refusal(directory / "a/b").find("in use"), std::string::npos);
  }
  EXPECT_TRUE(fs::is_empty(directory.path()));
}

TEST(DirectoryLock, WhatWasThereOrHoldsResultsStays) {
  const io::TemporaryDirectory directory;
  fs::create_directories(directory / "mine");
  { const DirectoryLock lock(directory / "mine"); }
  EXPECT_TRUE(fs::exists(directory / "mine"));
  {
    const DirectoryLock lock(directory / "out");
    fs::create_directories(directory / "out/runs");
    std::ofstream(directory / "out/runs/a.h5") << "hours";
  }
  EXPECT_TRUE(fs::exists(directory / "out/runs/a.h5"));
}

TEST(DirectoryLock, WhatIsInTheWayOfAFolderIsNamed) {
  const io::TemporaryDirectory directory;
  const std::string file = directory / "file";
  std::ofstream(file) << "text";
  for (const char* below : {"", "/", "/a", "/a/b"})
    EXPECT_NE(refusal(file + below).find(": " + file + " is there and is no folder"),
              std::string::npos)
        << refusal(file + below);
}

}  // namespace
}  // namespace grainlaw
