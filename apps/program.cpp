#include "apps/program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <thread>

#include "apps/io/input_file.h"
#include "continuum/ode_solver.h"
#include "continuum/rheology_table.h"

namespace grainlaw {
namespace {

using std::chrono::steady_clock;

std::atomic<bool> stop_flag = false;  // written by a signal, read by worker threads
static_assert(std::atomic<bool>::is_always_lock_free);
std::atomic<steady_clock::time_point> stop_time = steady_clock::time_point::max();

int fail(const std::string& program, ExitCode code, const char* message) {
  // Input errors carry file:line:column first, as compilers do, so that editors can jump there.
  say(code == ExitCode::bad_input ? std::string(message) : fmt::format("{}: {}", program, message));
  return static_cast<int>(code);
}

}  // namespace

int run_program(const std::string& name, const std::function<ExitCode()>& body) {
  try {
    const auto code = static_cast<int>(body());
    if (std::fflush(stdout) != 0) return fail(name, ExitCode::resource, "cannot write to stdout");
    return code;
  } catch (const io::InputError& error) {
    return fail(name, ExitCode::bad_input, error.what());
  } catch (const continuum::TableError& error) {
    return fail(name, ExitCode::bad_input, error.what());
  } catch (const io::FileError& error) {
    return fail(name, ExitCode::resource, error.what());
  } catch (const std::bad_alloc&) {
    return fail(name, ExitCode::resource, "out of memory");
  } catch (const std::invalid_argument& error) {
    return fail(name, ExitCode::bad_input, error.what());
  } catch (const std::exception& error) {  // NoAnswer, solver, fit and run errors
    return fail(name, ExitCode::no_answer, error.what());
  }
}

void say(std::string_view line) {
  const std::string text = std::string(line) + '\n';
  std::fputs(text.c_str(), stderr);
}

void catch_stop_signals(double max_wall) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::signal(signal, [](int) { stop_flag = true; });
  }
  std::signal(SIGXFSZ, SIG_IGN);
  if (max_wall > 0.0) stop_after(max_wall);
}

void stop_after(double seconds) {
  constexpr double longest = 1e9;  // [s], more than the clock needs to be safe from overflow
  const std::chrono::duration<double> wait(std::min(seconds, longest));
  stop_time = steady_clock::now() + std::chrono::duration_cast<steady_clock::duration>(wait);
}

bool stop_requested() {
  return stop_flag || steady_clock::now() >= stop_time.load();
}

const char* stop_reason() {
  return stop_flag ? "by a signal" : "because --max-wall is over";
}

void refuse_overwriting_input(const std::string& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code none;
    if (!output.empty() && std::filesystem::equivalent(output, input, none)) {
      throw io::InputError(
          fmt::format("{}: is an input and would be overwritten; choose another -o", output));
    }
  }
}

void refuse_overwriting_run(const std::string& output) {
  std::ifstream file(output, std::ios::binary);
  std::string begin(4, ' ');
  if (file.read(begin.data(), 4) && begin == "\x89HDF") {
    throw io::InputError(
        fmt::format("{}: is an HDF5 file and would be overwritten; choose another -o", output));
  }
  if (file.is_open() && std::filesystem::path(output).extension() == ".toml") {
    throw io::InputError(fmt::format(
        "{}: is a TOML file, as inputs are, and would be overwritten; choose another -o", output));
  }
}

void require_writable(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  if (access(folder.c_str(), W_OK) != 0) {
    throw io::FileError(fmt::format("cannot write {}: {}", path, std::strerror(errno)));
  }
  if (std::filesystem::is_directory(path)) {
    throw io::FileError(fmt::format("cannot write {}: it is a folder", path));
  }
}

std::string shell_word(const std::string& text) {
  constexpr std::string_view harmless =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+./,:=@%";
  if (!text.empty() && text.find_first_not_of(harmless) == std::string::npos) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

std::string option_text(const std::string& name, const std::vector<std::string>& words) {
  if (words.empty()) return {};
  std::string text = name.empty() ? name : ' ' + name;
  for (const std::string& word : words) text.append(1, ' ').append(shell_word(word));
  return text;
}

std::string machine() {
  std::string processor = "unknown processor";
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    processor = line.substr(line.find(": ") + 2);
    break;
  }
  return fmt::format("{}, {} cores", processor, std::thread::hardware_concurrency());
}

}  // namespace grainlaw
