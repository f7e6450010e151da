#pragma once

#include "apps/report/report.h"
#include "apps/summary.h"

namespace grainlaw {

/// What a campaign of series found, in a few lines.
void add_series_lines(Summary& summary, const report::SeriesReport& series);

}  // namespace grainlaw
