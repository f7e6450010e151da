#include "apps/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/program.h"

namespace grainlaw {
namespace {

using std::chrono::steady_clock;
constexpr auto terminal_interval = std::chrono::milliseconds(500);
constexpr auto plain_interval = std::chrono::seconds(10);

std::size_t terminal_width() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

}  // namespace

ProgressLine::ProgressLine(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), last_(steady_clock::now()) {}

ProgressLine::~ProgressLine() {
  clear();
}

void ProgressLine::clear() {
  if (shown_ > 0) std::fputs(fmt::format("\r{:{}}\r", "", shown_).c_str(), stderr);
  shown_ = 0;
}

void ProgressLine::show(const std::string& text) {
  const std::lock_guard lock(mutex_);
  const auto now = steady_clock::now();
  if (quiet_) return;
  if (terminal_ ? now - last_ < terminal_interval : now - last_ < plain_interval) return;
  last_ = now;
  if (!terminal_) {
    say(text);
    return;
  }
  clear();
  const std::string cut = text.substr(0, terminal_width() - 1);
  std::fputs(cut.c_str(), stderr);
  std::fflush(stderr);
  shown_ = cut.size();
}

void ProgressLine::report(const std::string& text) {
  if (!quiet_) warn(text);
}

void ProgressLine::warn(const std::string& text) {
  const std::lock_guard lock(mutex_);
  clear();
  say(text);
}

std::string duration_text(double seconds) {
  const long total = std::lround(std::max(0.0, seconds));
  if (total >= 3600) return fmt::format("{} h {:02} min", total / 3600, total % 3600 / 60);
  if (total >= 60) return fmt::format("{} min {:02} s", total / 60, total % 60);
  return fmt::format("{} s", total);
}

}  // namespace grainlaw
