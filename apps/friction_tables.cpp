#include "apps/friction_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "apps/directory_lock.h"
#include "apps/io/input_file.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/program.h"
#include "apps/report/report.h"
#include "apps/summary.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

std::string joined(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += (text.empty() ? "" : "; ") + sentence;
  return text;
}

bool complete(const calibration::FrictionDependences& curves,
              const continuum::RheologyTable& table) {
  const std::vector<std::string> names = continuum::coefficient_names(table);
  return std::ranges::all_of(names, [&](const std::string& name) {
    return curves.coefficients.contains(name) || curves.constants.contains(name);
  });
}

/// The table with the most coefficients among those that can be interpolated: of phi alone where
/// too few tables state a friction law.
const continuum::RheologyTable& fullest(const report::ContactFrictionReport& result) {
  const continuum::RheologyTable* best = nullptr;
  const auto size = [](const auto& table) { return continuum::coefficient_names(table).size(); };
  for (const continuum::RheologyTable& table : result.tables) {
    if (!complete(result.curves, table)) continue;
    if (best == nullptr || size(table) > size(*best)) best = &table;
  }
  if (best == nullptr) {
    throw io::InputError("no table can be made at another mu_p: " + joined(result.curves.left_out));
  }
  return *best;
}

/// What to say of a contact friction that no table reaches; nothing where some do.
std::optional<std::string> beyond_tables(const std::vector<continuum::RheologyTable>& tables,
                                         double contact_friction) {
  const auto [low, high] =
      std::ranges::minmax_element(tables, {}, &continuum::RheologyTable::contact_friction);
  if (contact_friction >= low->contact_friction && contact_friction <= high->contact_friction) {
    return {};
  }
  return fmt::format("mu_p = {} lies outside the tables, {} to {}: extrapolated, errors too small",
                     contact_friction,
                     low->contact_friction,
                     high->contact_friction);
}

report::ContactFrictionReport fit_curves(const FrictionTables& arguments) {
  report::ContactFrictionReport result;
  for (const std::string& path : arguments.tables) {
    result.tables.push_back(io::read_table(path));
    result.table_names.push_back(fs::path(path).stem().string());
  }
  result.curves = calibration::fit_friction_dependences(result.tables);
  if (result.curves.coefficients.empty()) {
    throw io::InputError("no coefficient has a curve over mu_p: " + joined(result.curves.left_out));
  }
  if (arguments.contact_friction) {
    result.interpolated =
        calibration::interpolate(result.curves, fullest(result), *arguments.contact_friction);
    result.interpolated->provenance.data = result.table_names;
  }
  return result;
}

void add_lines(Summary& summary, const report::ContactFrictionReport& result) {
  for (const auto& [name, curve] : result.curves.coefficients) {
    const double fall = curve.at_zero - curve.at_infinity;
    summary.add(name,
                name,
                fmt::format("{:.4g} {} {:.4g} exp(-mu_p / {:.3g}), rms {:.2g}, interpolation {}",
                            curve.at_infinity,
                            fall < 0.0 ? '-' : '+',
                            std::abs(fall),
                            curve.scale,
                            curve.rms,
                            std::isfinite(curve.interpolation_error)
                                ? fmt::format("{:.2g}", curve.interpolation_error)
                                : "untested"));
  }
  for (const auto& [name, value] : result.curves.constants) {
    summary.add(name, name, fmt::format("{:.4g} in all tables", value));
  }
  if (result.interpolated && !result.interpolated->has_friction) {
    summary.add("friction_law", "table", std::string("volume fractions only: no flow follows"));
  }
  if (result.curves.left_out.empty()) return;
  summary.add("left_out", "left out", result.curves.left_out);
}

}  // namespace

ExitCode fit_over_contact_friction(const FrictionTables& arguments, const CommonOptions& options) {
  report::Report report;
  report.title = "Coefficients over contact friction";
  report.command = "grainlaw calibrate --tables";
  report.contact_friction = fit_curves(arguments);
  const report::ContactFrictionReport& result = *report.contact_friction;
  report.table = result.interpolated.value_or(result.tables.front());
  if (arguments.contact_friction) {
    if (const auto warning = beyond_tables(result.tables, *arguments.contact_friction)) {
      say("warning: " + *warning);
      report.warnings.push_back(*warning);
    }
  }
  Summary summary;
  add_lines(summary, result);
  if (!options.check) {
    const fs::path directory = arguments.output;
    if (result.interpolated)
      refuse_overwriting_input((directory / "table.toml").string(), arguments.tables);
    const DirectoryLock lock(directory);
    if (result.interpolated) {
      io::write_table(*result.interpolated, directory / "table.toml");
      summary.add("table", "table", (directory / "table.toml").string());
    }
    report::write_report(report, directory);
    summary.add("report", "report", (directory / "report.html").string());
  }
  print(summary, options);
  return ExitCode::answered;
}

}  // namespace grainlaw
