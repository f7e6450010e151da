#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/campaign_data.h"
#include "apps/report/report.h"

namespace grainlaw {

/// How a campaign is to be calibrated within a wall time.
struct BudgetSettings {
  double seconds = 0.0;  ///< [s]
  int processes = 1;     ///< runs at once
  std::vector<std::string>
      from;  ///< finished runs: they cost nothing, and targets among them check
  bool quiet = false;
  /// Writes the report of what there is. Called once the first law is known: a report is there from
  /// then on, and what it took is kept for the last one.
  std::function<void(const CampaignData&, const report::BudgetReport&)> write_report{};
};

/// What a budget gave.
struct BudgetOutcome {
  CampaignData data;
  report::BudgetReport report;
};

/// Makes those runs of a campaign in DIR/runs from which the surface velocity of its `predict`
/// tilts will be known best within the wall time. The first round spreads over the candidates; then
/// the law is fitted after every round, and the next runs are those with the largest V-optimal
/// share, three tenths of the time going to conditions not yet run and to other seeds, which show
/// what the law does not hold. No predicted tilt is run: `from` may hold it. Chutes of later rounds
/// start with the profile of the law as it is then. A run that the end of the budget or its own
/// time limit cuts off counts with what it has, if 16 frames of it are steady.
///
/// Throws NoAnswer where the budget is too small for three runs, naming one that is not;
/// calibration::FitError where no law could be fitted in the end; what run_scenes throws. After a
/// signal the data are not complete.
BudgetOutcome measure_within(const io::Campaign& campaign,
                             const std::filesystem::path& directory,
                             const BudgetSettings& settings);

}  // namespace grainlaw
