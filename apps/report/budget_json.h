#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/report/report.h"

namespace grainlaw::report {

/// What budget_section shows.
nlohmann::ordered_json budget_json(const BudgetReport& budget);

}  // namespace grainlaw::report
