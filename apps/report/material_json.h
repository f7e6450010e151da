#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/report/report.h"

namespace grainlaw::report {

/// The parts of report.json that material_section and contact_friction_section show.
nlohmann::ordered_json material_json(const MaterialReport& material);
nlohmann::ordered_json contact_friction_json(const ContactFrictionReport& report);

}  // namespace grainlaw::report
