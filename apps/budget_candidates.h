#pragma once

#include <string>
#include <vector>

#include "apps/io/campaign_scenes.h"

namespace grainlaw {

/// A condition of a campaign at which a budget may be spent. Lengths of runs are counted in the
/// unit of their flow: strain for boxes, sqrt(d/g) for chutes.
struct BudgetCandidate {
  io::PlannedRun planned;         ///< its scene; seed, name and times are set per run
  std::vector<double> place;      ///< ln I, ln p*, Bo of a box, the tilt of a chute
  double unit = 1.0;              ///< of length [time]
  double seconds_per_unit = 0.0;  ///< wall time
  double warm_up = 0.0;           ///< before averaging begins
  double usable = 0.0;            ///< of averaging, for a standard error to mean anything
  double least = 0.0;             ///< of averaging to plan a run for, at least `usable`
  double most = 0.0;              ///< of averaging in one run; further time goes to further seeds
  int runs = 0;                   ///< that count, so far
  int unsteady = 0;               ///< runs that were not steady and do not count
  int failures = 0;

  /// Wall time of a run that averages this long, start and reserve included [s].
  double seconds(double averaging) const;
  /// What a run of this wall time averages; below `least` it is not worth making.
  double averaging(double seconds) const;
  bool fits(double seconds) const { return averaging(seconds) >= least; }

  /// Runs of which a further one would be a repeat: one that was not steady is made anew.
  int tries() const;
  /// Of runs, as seen so far; 1 where none was made.
  double steady_share() const;
  /// A run of this warm-up was not steady. Where that is the rule, further runs get twice as much,
  /// `most` at the most; where it is not, the test met its share of false alarms.
  void count_unsteady(double warm_up_of_run, bool may_be_start);
};

/// Every condition that the law can be fitted to, its cost measured by a short run.
std::vector<BudgetCandidate> budget_candidates(const std::vector<io::PlannedRun>& planned);

/// The scene of a run of a candidate, this many seeds on from that of its scene.
io::SceneFile budget_scene(const BudgetCandidate& candidate,
                           const std::string& name,
                           double averaging,
                           std::size_t seeds_on);

}  // namespace grainlaw
