#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/report/report.h"

namespace grainlaw::report {

/// What series_section shows.
nlohmann::ordered_json series_json(const SeriesReport& series);

}  // namespace grainlaw::report
