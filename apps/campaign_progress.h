#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/checkpointed_run.h"
#include "apps/progress.h"

namespace grainlaw {

/// How far one run is, as its process tells the campaign.
struct RunProgress {
  double share = 0.0;         ///< done, 0 to 1
  double seconds_left = 0.0;  ///< 0: not known
  double seconds = 0.0;       ///< expected wall time of the whole run

  std::string text() const;
  static std::optional<RunProgress> parse(std::string_view text);
};
RunProgress run_progress(const dem::Progress& now, const Pace& pace);

/// Progress of all runs together, in one line.
class ProgressBoard {
 public:
  ProgressBoard(std::size_t runs, int processes, ProgressLine& line)
      : runs_(runs), processes_(processes), line_(line) {}

  void update(std::size_t run, const RunProgress& now);
  void note(const std::string& text) { line_.warn(text); }
  /// The run is over; an empty outcome is not reported.
  void finish(std::size_t run, const std::string& outcome);

 private:
  double seconds_left_for_all() const;
  std::string text() const;

  std::vector<RunProgress> runs_;
  int processes_;
  ProgressLine& line_;
};

}  // namespace grainlaw
