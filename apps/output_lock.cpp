#include "apps/output_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "apps/io/input_file.h"

namespace grainlaw {
namespace {

/// The one who had the lock before removes its file: what was opened may not be there any more.
bool still_there(int descriptor, const std::filesystem::path& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

}  // namespace

OutputLock::OutputLock(const std::filesystem::path& output) : path_(output.string() + ".lock") {
  while (true) {
    descriptor_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor_ < 0) {
      throw io::FileError(fmt::format("cannot write {}: {}", path_.string(), std::strerror(errno)));
    }
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      close(descriptor_);
      if (error != EWOULDBLOCK) {
        throw io::FileError(
            fmt::format("cannot lock {}: {}", path_.string(), std::strerror(error)));
      }
      throw io::FileError(
          fmt::format("{} is being made by another grainlaw program: wait for it or choose another "
                      "with -o",
                      output.string()));
    }
    if (still_there(descriptor_, path_)) return;
    close(descriptor_);
  }
}

OutputLock::~OutputLock() {
  unlink(path_.c_str());  // while the lock is held: nobody else's file
  close(descriptor_);
}

}  // namespace grainlaw
