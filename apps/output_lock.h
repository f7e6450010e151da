#pragma once

#include <filesystem>

namespace grainlaw {

/// Keeps other programs from writing the same output at the same time: a lock on OUTPUT.lock, which
/// the kernel drops when the process ends, however it ends.
/// Throws io::FileError when the output is in use or no file can be made beside it.
class OutputLock {
 public:
  explicit OutputLock(const std::filesystem::path& output);
  ~OutputLock();
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace grainlaw
