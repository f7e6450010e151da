#include "apps/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>

#include "apps/io/input_file.h"

namespace grainlaw {
namespace {

using Size = std::uint32_t;  ///< in front of every message

[[noreturn]] void fail(const char* call) {
  throw io::FileError(fmt::format("cannot start a process ({}): {}", call, std::strerror(errno)));
}

void write_all(int pipe, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(pipe, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void send_message(int pipe, std::string_view message) {
  const auto size = static_cast<Size>(message.size());
  std::string bytes(sizeof(size), '\0');
  std::memcpy(bytes.data(), &size, sizeof(size));
  write_all(pipe, bytes.append(message));
}

/// Takes the first whole message off the bytes.
bool take_message(std::string& bytes, std::string& message) {
  Size size = 0;
  if (bytes.size() < sizeof(size)) return false;
  std::memcpy(&size, bytes.data(), sizeof(size));
  if (bytes.size() < sizeof(size) + size) return false;
  message = bytes.substr(sizeof(size), size);
  bytes.erase(0, sizeof(size) + size);
  return true;
}

/// The child's whole life. It leaves without the clean-up of the parent's objects and buffers; an
/// exception ends it as a crash would.
[[noreturn]] void live(pid_t parent, int pipe, const ChildProcess::Work& work) noexcept {
  std::signal(SIGPIPE, SIG_IGN);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(EXIT_FAILURE);  // it was gone before the line above
  ::_exit(work([&](std::string_view message) { send_message(pipe, message); }));
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

ChildProcess::ChildProcess(const Work& work) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe");
  const pid_t parent = ::getpid();
  id_ = ::fork();
  if (id_ == 0) {
    ::close(ends[0]);
    live(parent, ends[1], work);
  }
  ::close(ends[1]);
  pipe_ = ends[0];
  if (id_ < 0) {
    ::close(pipe_);
    fail("fork");
  }
}

ChildProcess::~ChildProcess() {
  ::close(pipe_);  // before: a child that waits for its reader would never end
  if (id_ < 0) return;
  ask_to_stop();
  wait();
}

std::vector<std::string> ChildProcess::receive() {
  std::array<char, 4096> buffer{};
  const ssize_t count = ::read(pipe_, buffer.data(), buffer.size());
  if (count == 0) ended_ = true;
  if (count > 0) received_.append(buffer.data(), static_cast<std::size_t>(count));
  std::vector<std::string> messages;
  for (std::string message; take_message(received_, message);) messages.push_back(message);
  return messages;
}

void ChildProcess::ask_to_stop() const {
  if (id_ > 0) ::kill(id_, SIGTERM);
}

ChildProcess::Ending ChildProcess::wait() {
  Ending ending;
  int status = 0;
  rusage use{};
  while (::wait4(id_, &status, 0, &use) < 0 && errno == EINTR) continue;
  id_ = -1;
  if (WIFEXITED(status)) ending.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) ending.signal = WTERMSIG(status);
  ending.cpu_seconds = seconds(use.ru_utime) + seconds(use.ru_stime);
  return ending;
}

}  // namespace grainlaw
