#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/report/report.h"

namespace grainlaw::report {

/// What in_time_section shows of one run.
nlohmann::ordered_json in_time_json(const RunComparison& run);

}  // namespace grainlaw::report
