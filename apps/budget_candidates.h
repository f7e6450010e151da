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
  int runs = 0;                   ///< that count, so far
  int failures = 0;

  /// Wall time of a run that averages this long, start and reserve included [s].
  double seconds(double averaging) const;
  /// What a run of this wall time averages; below `least` it is not worth making.
  double averaging(double seconds) const;
  bool fits(double seconds) const { return averaging(seconds) >= least; }
};

/// Every condition that the law can be fitted to, its cost measured by a short run.
std::vector<BudgetCandidate> budget_candidates(const std::vector<io::PlannedRun>& planned);

/// The scene of a run of a candidate, this many seeds on from that of its scene.
io::SceneFile budget_scene(const BudgetCandidate& candidate,
                           const std::string& name,
                           double averaging,
                           std::size_t seeds_on);

}  // namespace grainlaw
