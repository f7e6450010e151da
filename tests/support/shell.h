#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

namespace grainlaw::testing {

/// What a command left behind.
struct CommandOutput {
  int code = -1;     ///< exit code; -1: it could not start or a signal ended it
  std::string text;  ///< stdout and stderr

  bool says(const std::string& words) const { return text.find(words) != std::string::npos; }
};

/// Runs a command in a shell of its own.
inline CommandOutput run_command(const std::string& command) {
  CommandOutput output;
  FILE* pipe = popen(("(" + command + ") 2>&1").c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    output.text.append(buffer.data(), n);
  }
  const int status = pclose(pipe);
  output.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return output;
}

}  // namespace grainlaw::testing
