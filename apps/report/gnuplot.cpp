#include "apps/report/gnuplot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace grainlaw::report {
namespace {

/// Where the child process starts: in `directory`, no input, output dropped, errors into a pipe.
class SpawnActions {
 public:
  SpawnActions(const std::filesystem::path& directory, int error_pipe) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addchdir_np(&actions_, directory.c_str());
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions_, error_pipe, STDERR_FILENO);
  }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;

  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

std::string read_to_end(int descriptor) {
  std::string result;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t length = read(descriptor, buffer.data(), buffer.size());
    if (length < 0 && errno == EINTR) continue;
    if (length <= 0) return result;
    result.append(buffer.data(), static_cast<std::size_t>(length));
  }
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

/// gnuplot prints the offending line, a caret and then the reason: the last line that is not empty.
std::string last_line(const std::string& message) {
  const std::size_t end = message.find_last_not_of(" \n\t");
  if (end == std::string::npos) return "no message";
  const std::size_t line_break = message.rfind('\n', end);
  const std::size_t begin = line_break == std::string::npos ? 0 : line_break + 1;
  return message.substr(begin, end + 1 - begin);
}

std::optional<std::string> failure(int status, const std::string& message) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return std::nullopt;
  if (WIFSIGNALED(status)) return fmt::format("gnuplot was ended by signal {}", WTERMSIG(status));
  return "gnuplot failed: " + last_line(message);
}

}  // namespace

std::optional<std::string> run_gnuplot(const std::filesystem::path& directory,
                                       const std::string& script) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return std::string("no pipe: ") + std::strerror(errno);
  std::string program = "gnuplot";
  std::string no_user_settings = "--default-settings";
  std::string argument = script;
  const std::array<char*, 4> arguments = {
      program.data(), no_user_settings.data(), argument.data(), nullptr};
  pid_t child = 0;
  const int code = posix_spawnp(&child,
                                program.c_str(),
                                SpawnActions(directory, ends[1]).get(),
                                nullptr,
                                arguments.data(),
                                environ);
  close(ends[1]);
  const std::string message = code == 0 ? read_to_end(ends[0]) : std::string{};
  close(ends[0]);
  if (code == ENOENT) return "gnuplot was not found on this machine";
  if (code != 0) return std::string("gnuplot could not be started: ") + std::strerror(code);
  return failure(wait_for(child), message);
}

}  // namespace grainlaw::report
