#pragma once

#include <string>

#include "apps/report/report.h"

namespace grainlaw::report {

/// All numbers of a report as JSON, in the units of the runs (not scaled as in the figures).
/// Numbers that are not there (NaN) are null.
std::string report_json(const Report& report);
std::string report_json(const SeriesReport& report);

}  // namespace grainlaw::report
