#include "apps/io/import_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace grainlaw::io {
namespace {

using dem::Estimate;
using dem::LocalRow;

constexpr double systematic = 0.02;  // of a stress, between right programs

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

/// Rows of the sheared bulk, 2 d above the base and denser than half the densest: at the base and
/// in the dilute layer on top the share of a contact in a bin depends on the program.
std::vector<const LocalRow*> bulk(const std::vector<LocalRow>& rows) {
  constexpr double above_base = 2.0;  // [d]
  double densest = 0.0;
  for (const LocalRow& row : rows) densest = std::max(densest, row.volume_fraction.value);
  std::vector<const LocalRow*> out;
  for (const LocalRow& row : rows) {
    if (row.z >= above_base && row.volume_fraction.value > 0.5 * densest) out.push_back(&row);
  }
  return out;
}

/// Sum of a field over rows; its error as if all rows moved together.
Estimate sum(const std::vector<const LocalRow*>& rows, Estimate LocalRow::*field) {
  Estimate total{0.0, 0.0};
  for (const LocalRow* row : rows) {
    total.value += (row->*field).value;
    total.error += (row->*field).error;
  }
  return total;
}

ImportCheck balance(const std::string& name,
                    const std::string& words,
                    double measured,
                    double error,
                    double expected) {
  const double difference = measured / expected - 1.0;
  const double allowed = std::max(systematic, 3.0 * error / std::abs(expected));
  const bool holds = std::abs(difference) <= allowed;
  return {
      name,
      holds ? CheckOutcome::passed : CheckOutcome::failed,
      fmt::format("{} is off by {} (+- {}); {} are allowed{}",
                  words,
                  percent(difference),
                  percent(error / std::abs(expected)),
                  percent(allowed),
                  holds ? "" : ": columns, signs or units are wrong, or the layer accelerates")};
}

ImportCheck nothing_to_check(const std::string& name) {
  return {name,
          CheckOutcome::failed,
          "no row lies 2 d above the base: base_top, z or their units are wrong, or the layer is "
          "too thin"};
}

ImportCheck check_weight(const dem::LocalData& data) {
  const auto rows = bulk(data.rows);
  if (rows.empty()) return nothing_to_check("weight");
  double weight = 0.0;
  for (const LocalRow* row : rows) weight += row->mass_above;
  weight *= data.conditions.gravity * std::cos(data.conditions.inclination);
  const Estimate stress = sum(rows, &LocalRow::normal_stress);
  return balance("weight", "sigma_zz against the weight above", stress.value, stress.error, weight);
}

ImportCheck check_friction(const dem::LocalData& data) {
  const auto rows = bulk(data.rows);
  if (rows.empty()) return nothing_to_check("friction");
  const Estimate shear = sum(rows, &LocalRow::shear_stress);
  const Estimate normal = sum(rows, &LocalRow::normal_stress);
  const double friction = shear.value / normal.value;
  // Of both stresses, whose errors mostly go together: the larger one.
  const double error = std::abs(friction) * std::max(shear.error / std::abs(shear.value),
                                                     normal.error / std::abs(normal.value));
  return balance("friction",
                 "sigma_xz/sigma_zz against tan(theta)",
                 friction,
                 error,
                 std::tan(data.conditions.inclination));
}

/// Frames take the mass above a row from the whole mass less that below, averages from the rows
/// above: only the first need all of the layer.
ImportCheck check_mass(const Import& import, const CheckedProfile& profile) {
  constexpr double allowed = 0.01;
  const double stated = import.conditions.mass_per_area;
  if (stated == 0.0) {
    return {"mass",
            CheckOutcome::not_possible,
            fmt::format("mass per area not stated: {:.4g} m/d^2, the sum over the rows",
                        profile.mass_of_rows)};
  }
  const double missing = 1.0 - profile.mass_of_rows / stated;
  const bool holds = missing > -allowed && (missing < allowed || !profile.has_history);
  return {"mass",
          holds ? CheckOutcome::passed : CheckOutcome::failed,
          fmt::format("the rows hold {:.4g} of {:.4g} m/d^2 ({} missing)",
                      profile.mass_of_rows,
                      stated,
                      percent(missing))};
}

ImportCheck check_steadiness(const Import& import,
                             const dem::LocalData& data,
                             const CheckedProfile& profile) {
  if (profile.has_history) {
    return {"steadiness",
            data.window.steady ? CheckOutcome::passed : CheckOutcome::failed,
            data.window.reason};
  }
  if (import.steady) {
    return {"steadiness",
            CheckOutcome::not_possible,
            "averages only: steady because the import file says so"};
  }
  return {"steadiness",
          CheckOutcome::failed,
          "averages only, and the import file does not say that the flow was steady ([window] "
          "steady = true)"};
}

ImportCheck check_stress(const CheckedProfile& profile) {
  if (profile.has_kinetic_part) {
    return {"stress", CheckOutcome::passed, "contact and kinetic part"};
  }
  return {"stress",
          CheckOutcome::not_possible,
          "contact part only: there are no columns of mean squares of the velocity; the kinetic "
          "part grows with I^2 and matters at the surface"};
}

}  // namespace

std::vector<ImportCheck> check_import(const Import& import,
                                      const dem::LocalData& data,
                                      const CheckedProfile& profile) {
  return {check_mass(import, profile),
          check_weight(data),
          check_friction(data),
          check_steadiness(import, data, profile),
          check_stress(profile),
          {"errors", CheckOutcome::passed, profile.errors}};
}

}  // namespace grainlaw::io
