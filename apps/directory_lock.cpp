#include "apps/directory_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "apps/io/input_file.h"

namespace grainlaw {

DirectoryLock::DirectoryLock(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) {
    throw io::FileError(
        fmt::format("cannot create folder {}: {}", directory.string(), error.message()));
  }
  const std::string path = (directory / ".lock").string();
  descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) {
    throw io::FileError(
        fmt::format("cannot write to folder {}: {}", directory.string(), std::strerror(errno)));
  }
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    close(descriptor_);
    throw io::FileError(fmt::format(
        "folder {} is in use by another grainlaw program: wait for it or choose another with -o",
        directory.string()));
  }
}

DirectoryLock::~DirectoryLock() {
  close(descriptor_);
}  // the kernel drops the lock, also on kill

}  // namespace grainlaw
