#include "apps/campaign_progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace grainlaw {

std::string RunProgress::text() const {
  return fmt::format("{} {} {}", share, seconds_left, seconds);
}

std::optional<RunProgress> RunProgress::parse(std::string_view text) {
  RunProgress now;
  const std::string words(text);
  const int read =
      std::sscanf(words.c_str(), "%lf %lf %lf", &now.share, &now.seconds_left, &now.seconds);
  return read == 3 ? std::optional(now) : std::nullopt;
}

RunProgress run_progress(const dem::Progress& now, const Pace& pace) {
  const bool begun = !now.settling && now.expected_end > 0.0;
  const double left = pace.seconds_left();
  // A run may outlast what is expected of it; finish() says when it is done.
  constexpr double nearly_done = 0.99;
  return {.share = begun ? std::clamp(now.time / now.expected_end, 0.0, nearly_done) : 0.0,
          .seconds_left = left,
          .seconds = now.wall_seconds + left};
}

void ProgressBoard::update(std::size_t run, const RunProgress& now) {
  runs_[run] = now;
  line_.show(text());
}

void ProgressBoard::finish(std::size_t run, const std::string& outcome) {
  runs_[run].share = 1.0;
  runs_[run].seconds_left = 0.0;
  if (!outcome.empty()) line_.report(outcome);
}

/// Runs that have not begun are expected to take as long as those that have.
double ProgressBoard::seconds_left_for_all() const {
  double known = 0.0;
  int begun = 0;
  for (const RunProgress& run : runs_) {
    known += run.seconds;
    if (run.seconds > 0.0) ++begun;
  }
  const double typical = begun > 0 ? known / begun : 0.0;
  double left = 0.0;
  for (const RunProgress& run : runs_) left += run.share == 0.0 ? typical : run.seconds_left;
  return left / std::min<double>(processes_, static_cast<double>(runs_.size()));
}

std::string ProgressBoard::text() const {
  const auto done = std::ranges::count(runs_, 1.0, &RunProgress::share);
  std::string out = fmt::format("DEM: {} of {} runs done", done, runs_.size());
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    const double share = runs_[k].share;
    if (share > 0.0 && share < 1.0) out += fmt::format(", run {} {:.0f} %", k + 1, 100.0 * share);
  }
  return out + fmt::format(", about {} left", duration_text(seconds_left_for_all()));
}

}  // namespace grainlaw
