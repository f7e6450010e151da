#pragma once

#include <span>

#include "apps/report/report.h"

namespace grainlaw {

/// Everything from runs of homogeneous flow (simple shear; rows of plane shear and body-force
/// boxes) to the part of the report on their material laws: points, fit, bands, information, cost.
/// Throws calibration::FitError where no law can be fitted.
report::MaterialReport study_material(std::span<const dem::LocalData> runs,
                                      const calibration::MaterialFitOptions& options);

}  // namespace grainlaw
