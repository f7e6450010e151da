#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/campaign_data.h"
#include "apps/io/campaign_input.h"
#include "apps/report/report.h"

namespace grainlaw {

/// The law that fits the data, without anything else. Throws calibration::FitError.
continuum::RheologyTable fit_law(const io::Campaign& campaign, const CampaignData& data);

/// A table that what is measured is held against: published coefficients beside those of shear
/// boxes, the flow it predicts beside the runs of a series.
struct Reference {
  std::string name;
  continuum::RheologyTable table;
};

/// From the data of a campaign to its report: fit, predictions (written to DIR/predictions before
/// any predicted run is looked at), comparison. With shear boxes the law is fitted to them and the
/// chutes are compared across geometries. Throws calibration::FitError.
report::Report evaluate(const io::Campaign& campaign,
                        CampaignData data,
                        const std::filesystem::path& directory,
                        const std::optional<Reference>& reference = {});

/// The same of a campaign of series, to which no law is fitted.
report::SeriesReport evaluate_series(const io::Campaign& campaign,
                                     CampaignData data,
                                     const std::optional<Reference>& reference = {});

}  // namespace grainlaw
