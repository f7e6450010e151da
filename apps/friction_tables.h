#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/command_line.h"
#include "apps/exit_code.h"

namespace grainlaw {

/// `grainlaw calibrate --tables A.toml B.toml C.toml D.toml [--contact-friction 0.3] -o DIR`.
struct FrictionTables {
  std::vector<std::string> tables;         ///< of grains that differ in mu_p only, 4 at least
  std::string output;                      ///< folder of report.html, report.json, table.toml
  std::optional<double> contact_friction;  ///< mu_p of the table to write; none: no table
};

/// Fits every coefficient as a function of the contact friction (Shi et al. 2020, eq. 1B), writes
/// the report and the table in between.
ExitCode fit_over_contact_friction(const FrictionTables& arguments, const CommonOptions& options);

}  // namespace grainlaw
