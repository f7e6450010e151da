#include "apps/io/safe_write.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

namespace grainlaw::io {
namespace {

std::string message(const char* verb, const std::filesystem::path& path, int error) {
  return fmt::format("cannot {} {}: {}", verb, path.string(), std::strerror(error));
}

[[noreturn]] void fail(const char* verb, const std::filesystem::path& path, int error) {
  throw FileError(message(verb, path, error));
}

[[noreturn]] void fail_to_read(const std::filesystem::path& path, int error) {
  throw ReadError(message("read", path, error));
}

class FileDescriptor {
 public:
  explicit FileDescriptor(int id) : id_(id) {}
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  ~FileDescriptor() {
    if (id_ >= 0) ::close(id_);
  }
  int id() const { return id_; }
  int close() { return ::close(std::exchange(id_, -1)); }

 private:
  int id_;
};

/// Removes the temporary file unless it was renamed.
struct TemporaryFile {
  std::string path;
  bool kept = false;
  ~TemporaryFile() {
    if (!kept) std::remove(path.c_str());
  }
};

int write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : ENOSPC;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

/// Makes the new name itself durable. File systems that cannot sync a directory say EINVAL.
void sync_directory(const std::filesystem::path& directory) {
  const FileDescriptor file(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (file.id() < 0) fail("open", directory, errno);
  if (::fsync(file.id()) != 0 && errno != EINVAL) fail("sync", directory, errno);
}

/// A new file beside `target`, with the permissions the process gives to new files.
FileDescriptor create_beside(const std::filesystem::path& target, std::string& temporary) {
  for (int attempt = 0;; ++attempt) {
    temporary = fmt::format("{}.{}.{}.tmp", target.string(), ::getpid(), attempt);
    const int id = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (id >= 0) return FileDescriptor(id);
    if (errno != EEXIST || attempt == 1000) fail("write", target, errno);
  }
}

/// Pipes and devices (-o /dev/stdout) are not replaced but written to.
void write_in_place(const std::filesystem::path& path, std::string_view bytes) {
  const FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (file.id() < 0) fail("write", path, errno);
  if (const int error = write_all(file.id(), bytes)) fail("write", path, error);
}

/// Writes the bytes under another name, then gives them theirs. The file that was there gets the
/// name `previous`, unless that is empty.
void replace(const std::filesystem::path& path,
             std::string_view bytes,
             const std::filesystem::path& previous) {
  TemporaryFile temporary;
  FileDescriptor file = create_beside(path, temporary.path);
  if (const int error = write_all(file.id(), bytes)) fail("write", path, error);
  if (::fsync(file.id()) != 0) fail("write", path, errno);
  if (file.close() != 0) fail("write", path, errno);
  if (!previous.empty() && std::rename(path.c_str(), previous.c_str()) != 0 && errno != ENOENT) {
    fail("rename", path, errno);
  }
  if (std::rename(temporary.path.c_str(), path.c_str()) != 0) fail("write", path, errno);
  temporary.kept = true;
  sync_directory(folder_of(path));
}

/// "1234.0.tmp", as create_beside names files.
bool is_temporary_ending(std::string_view text) {
  constexpr std::string_view ending = ".tmp";
  if (!text.ends_with(ending)) return false;
  text.remove_suffix(ending.size());
  return text.find('.') != std::string_view::npos &&
         text.find_first_not_of("0123456789.") == std::string_view::npos;
}

}  // namespace

void safe_write(const std::filesystem::path& target, std::string_view bytes) {
  std::error_code unknown;
  const auto kind = std::filesystem::status(target, unknown).type();
  if (kind != std::filesystem::file_type::regular &&
      kind != std::filesystem::file_type::not_found) {
    return write_in_place(target, bytes);
  }
  // A link stays a link: what it points to is replaced.
  const bool link =
      kind == std::filesystem::file_type::regular && std::filesystem::is_symlink(target, unknown);
  const std::filesystem::path path = link ? std::filesystem::canonical(target, unknown) : target;
  replace(path, bytes, {});
}

void safe_write_keeping(const std::filesystem::path& previous,
                        const std::filesystem::path& path,
                        std::string_view bytes) {
  replace(path, bytes, previous);
}

void remove_temporaries(const std::filesystem::path& path) {
  const std::string prefix = path.filename().string() + ".";
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder_of(path), none)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(prefix) && is_temporary_ending(name.substr(prefix.size()))) {
      std::filesystem::remove(entry.path(), none);
    }
  }
}

std::string read_file(const std::filesystem::path& path, std::size_t largest) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.id() < 0) fail_to_read(path, errno);
  std::string bytes;
  std::size_t used = 0;
  while (true) {
    if (bytes.size() - used < 65536) bytes.resize(2 * bytes.size() + 65536);
    const ssize_t got = ::read(file.id(), bytes.data() + used, bytes.size() - used);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_to_read(path, errno);
    if (got == 0) break;
    used += static_cast<std::size_t>(got);
    if (used > largest) fail_to_read(path, EFBIG);
  }
  bytes.resize(used);
  return bytes;
}

std::string read_text(const std::filesystem::path& path, std::size_t largest) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  std::string text = read_file(path, largest);
  if (text.starts_with(byte_order_mark)) text.erase(0, byte_order_mark.size());
  return text;
}

}  // namespace grainlaw::io
