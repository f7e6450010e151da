#pragma once

#include <filesystem>
#include <vector>

namespace grainlaw {

/// Creates a results folder and keeps other programs from writing into it at the same time. A
/// folder that it made and that holds nothing in the end, as where the input was refused, goes with
/// it. Throws io::FileError when the folder cannot be made, written, or is in use.
class DirectoryLock {
 public:
  explicit DirectoryLock(const std::filesystem::path& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  void remove_if_unused() const;

  std::filesystem::path directory_;
  std::vector<std::filesystem::path> made_;  ///< folders, the innermost first
  int descriptor_ = -1;
};

}  // namespace grainlaw
