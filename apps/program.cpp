#include "apps/program.h"

#include <fmt/core.h>

#include <csignal>
#include <fstream>
#include <new>
#include <thread>

#include "apps/io/input_file.h"
#include "continuum/ode_solver.h"
#include "continuum/rheology_table.h"

namespace grainlaw {
namespace {

volatile std::sig_atomic_t stop_flag = 0;

int fail(const char* program, ExitCode code, const char* message) {
  // Input errors carry file:line:column first, as compilers do, so that editors can jump there.
  if (code == ExitCode::bad_input) {
    fmt::print(stderr, "{}\n", message);
  } else {
    fmt::print(stderr, "{}: {}\n", program, message);
  }
  return static_cast<int>(code);
}

}  // namespace

int run_program(const char* name, const std::function<ExitCode()>& body) {
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

void catch_stop_signals() {
  std::signal(SIGINT, [](int) { stop_flag = 1; });
  std::signal(SIGTERM, [](int) { stop_flag = 1; });
}

bool stop_requested() {
  return stop_flag != 0;
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
