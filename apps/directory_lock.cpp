#include "apps/directory_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "apps/io/input_file.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

bool taken(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

/// The folders on the way to a folder that are not there yet, the innermost first. Throws
/// io::FileError where something else has the name of one.
std::vector<fs::path> missing_folders(const fs::path& directory) {
  std::vector<fs::path> missing;
  fs::path path = directory.lexically_normal();
  if (!path.has_filename()) path = path.parent_path();  // "folder/"
  for (; !path.empty(); path = path.parent_path()) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) return missing;
    if (taken(path)) {
      throw io::FileError(fmt::format("cannot create folder {}: {} is there and is no folder",
                                      directory.string(),
                                      path.string()));
    }
    missing.push_back(path);
  }
  return missing;
}

}  // namespace

DirectoryLock::DirectoryLock(const fs::path& directory)
    : directory_(directory), made_(missing_folders(directory)) {
  std::error_code error;
  fs::create_directories(directory, error);
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
  remove_if_unused();
  close(descriptor_);  // the kernel drops the lock, also on kill
}

/// A folder is only removed where nothing is in it.
void DirectoryLock::remove_if_unused() const {
  if (made_.empty()) return;
  std::error_code ignored;
  const fs::path lock = directory_ / ".lock";
  bool unused = true;
  for (const auto& entry : fs::directory_iterator(directory_, ignored)) {
    const bool empty_folder = entry.is_directory(ignored) && fs::is_empty(entry.path(), ignored);
    unused = unused && (entry.path() == lock || empty_folder);
  }
  if (!unused) return;
  for (const auto& entry : fs::directory_iterator(directory_, ignored))
    fs::remove(entry.path(), ignored);
  for (const fs::path& folder : made_)
    if (!fs::remove(folder, ignored)) return;
}

}  // namespace grainlaw
