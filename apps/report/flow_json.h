#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/report/report.h"

namespace grainlaw::report {

/// Runs of other flows than chutes, with what every table says of them.
nlohmann::ordered_json flows_json(const Report& report);

/// Every table with the scores of all runs.
nlohmann::ordered_json scores_json(const Report& report);

}  // namespace grainlaw::report
