#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace grainlaw {

/// One line of progress on stderr: redrawn on a terminal, printed plainly every 10 s otherwise.
/// May be called from several threads.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const std::string& text);    ///< shown when it is time for it
  void report(const std::string& text);  ///< a line that stays
  void warn(const std::string& text);    ///< the same, also when quiet

 private:
  void clear();

  std::mutex mutex_;
  bool quiet_;
  bool terminal_;
  std::size_t shown_ = 0;  ///< characters on the terminal line now
  std::chrono::steady_clock::time_point last_;
};

/// "1 h 05 min", "3 min 20 s", "12 s".
std::string duration_text(double seconds);

}  // namespace grainlaw
