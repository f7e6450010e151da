#pragma once

#include <vector>

#include "apps/campaign_data.h"
#include "apps/report/report.h"

namespace grainlaw {

/// The points of the fitted chutes, one per condition: where it was run with several seeds, their
/// mean with its error in time. Throws calibration::FitError.
std::vector<calibration::FlowPoint> mean_points(const CampaignData& data);

/// How much the seeds of each condition scatter, beside what the errors in time let expect; steady
/// runs only, and nothing where there is one seed.
std::vector<report::SeedScatter> seed_scatter(const CampaignData& data);

}  // namespace grainlaw
