#pragma once

#include <filesystem>

#include "apps/campaign_data.h"
#include "apps/io/campaign_input.h"
#include "apps/report/report.h"

namespace grainlaw {

/// The law that fits the data, without anything else. Throws calibration::FitError.
continuum::RheologyTable fit_law(const io::Campaign& campaign, const CampaignData& data);

/// From the data of a campaign to its report: fit, predictions (written to DIR/predictions before
/// any predicted run is looked at), comparison. With shear boxes the law is fitted to them and the
/// chutes are compared across geometries. Throws calibration::FitError.
report::Report evaluate(const io::Campaign& campaign,
                        CampaignData data,
                        const std::filesystem::path& directory);

}  // namespace grainlaw
