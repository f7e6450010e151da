#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/budget_candidates.h"
#include "apps/campaign_data.h"
#include "calibration/budget_plan.h"

namespace grainlaw {

/// A run to be made.
struct PlannedSpending {
  std::size_t candidate = 0;
  double averaging = 0.0;  ///< [unit of the candidate]
  std::string why;
};

/// The first runs, or what they would take where they do not fit.
struct FirstRound {
  std::vector<PlannedSpending> runs;  ///< empty: too little time even for the cheapest choice
  double seconds = 0.0;               ///< wall time of them, or of the cheapest choice
};

/// Decides which runs a budget goes to, from what the runs before have told.
class BudgetPlanner {
 public:
  static constexpr std::size_t fewest_runs = 3;  ///< two for a straight law, one that tests it
  static constexpr double first_part = 0.6;      ///< of a budget, at most, for the first round

  BudgetPlanner(const io::Campaign& campaign,
                std::vector<BudgetCandidate> candidates,
                int processes);

  std::vector<BudgetCandidate>& candidates() { return candidates_; }
  /// Wall time of runs over the expected one, as seen last.
  void set_pace(double pace) { pace_ = pace; }

  /// A law and the runs it was fitted to. False: nothing can be planned by it.
  bool learn(const continuum::RheologyTable& table, std::span<const MeasuredRun> runs);

  /// The candidates that cover all others best, as short as sensible; the dearest are left out
  /// until the rest fits the first part of the time left.
  FirstRound first_round(double seconds_left) const;

  /// Runs that keep every process at work for the same wall time, in the order in which they
  /// start; none where the time left is too short. A round takes no longer than the longest run
  /// that a candidate may have, or a sixteenth of the time left where that is more.
  std::vector<PlannedSpending> next_round(double seconds_left);

  /// u_s at a tilt with its standard error: that of the table, or, where it is larger, that of the
  /// plan, which holds a curvature that the fit has left out too. Call after learn().
  dem::Estimate surface_velocity(double tilt) const;

  /// The chute of a tilt that is to be predicted.
  continuum::ChuteCase target(double tilt) const;

 private:
  /// A finished run as the planner sees it.
  struct Told {
    std::size_t candidate = 0;
    calibration::Observation observation;
    double averaged = 0.0;  ///< [unit of the candidate]
  };

  double shortest(std::size_t candidate) const;
  std::vector<std::size_t> spread(const std::vector<std::size_t>& pool) const;
  double wall_seconds(const std::vector<std::size_t>& chosen) const;
  double longest_run(double seconds_left) const;
  double next_run_seconds(double all) const;
  std::size_t least_run(double seconds, const std::vector<PlannedSpending>& chosen) const;
  std::size_t most_wanted(double seconds,
                          double round_seconds,
                          const std::vector<Told>& told) const;
  bool any_fits(double seconds) const;
  std::vector<std::vector<double>> target_gradients(
      const std::vector<std::string>& names, std::span<const calibration::Candidate> open) const;
  std::optional<calibration::State> state_of(const BudgetCandidate& candidate) const;
  calibration::Observation observation(const dem::LocalData& run) const;
  std::vector<double> information(const std::vector<std::string>& names,
                                  const std::vector<Told>& told) const;
  double noise(std::size_t candidate) const;
  Told expected(std::size_t candidate, double averaging) const;

  const io::Campaign& campaign_;
  std::vector<BudgetCandidate> candidates_;
  int processes_;
  std::vector<std::size_t> order_;  ///< in which the candidates cover their space
  std::size_t first_runs_ = fewest_runs;
  double pace_ = 1.0;
  double later_ = 0.0;     ///< seconds of runs after the first round
  double explored_ = 0.0;  ///< of them, for lack of fit and repeats
  std::optional<continuum::RheologyTable> table_;
  std::vector<Told> told_;
};

}  // namespace grainlaw
