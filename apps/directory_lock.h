#pragma once

#include <filesystem>

namespace grainlaw {

/// Creates a results folder and keeps other programs from writing into it at the same time.
/// Throws io::FileError when the folder cannot be made, written, or is in use.
class DirectoryLock {
 public:
  explicit DirectoryLock(const std::filesystem::path& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace grainlaw
