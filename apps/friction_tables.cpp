#include "apps/friction_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "apps/directory_lock.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/program.h"
#include "apps/report/report.h"
#include "apps/summary.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

/// The one with the fewest coefficients: of phi alone where some tables have no friction law.
const continuum::RheologyTable& smallest(const std::vector<continuum::RheologyTable>& tables) {
  return *std::min_element(tables.begin(), tables.end(), [](const auto& a, const auto& b) {
    return continuum::coefficient_names(a).size() < continuum::coefficient_names(b).size();
  });
}

report::ContactFrictionReport fit_curves(const FrictionTables& arguments) {
  report::ContactFrictionReport result;
  for (const std::string& path : arguments.tables) {
    result.tables.push_back(io::read_table(path));
    result.table_names.push_back(fs::path(path).stem().string());
  }
  result.curves = calibration::fit_friction_dependences(result.tables);
  if (arguments.contact_friction) {
    result.interpolated = calibration::interpolate(
        result.curves, smallest(result.tables), *arguments.contact_friction);
    result.interpolated->provenance.data = result.table_names;
  }
  return result;
}

void add_lines(Summary& summary, const report::ContactFrictionReport& result) {
  for (const auto& [name, curve] : result.curves.coefficients) {
    summary.add(name,
                name,
                fmt::format("{:.4g} + {:.4g} exp(-mu_p / {:.3g}), rms {:.2g}, interpolation {:.2g}",
                            curve.at_infinity,
                            curve.at_zero - curve.at_infinity,
                            curve.scale,
                            curve.rms,
                            curve.interpolation_error));
  }
  if (result.curves.left_out.empty()) return;
  summary.add("left_out", "left out", fmt::format("{}", fmt::join(result.curves.left_out, "; ")));
}

}  // namespace

ExitCode fit_over_contact_friction(const FrictionTables& arguments, const CommonOptions& options) {
  report::Report report;
  report.title = "Coefficients over contact friction";
  report.command = "grainlaw calibrate --tables";
  report.contact_friction = fit_curves(arguments);
  const report::ContactFrictionReport& result = *report.contact_friction;
  report.table = result.interpolated.value_or(result.tables.front());
  Summary summary;
  add_lines(summary, result);
  if (!options.check) {
    const fs::path directory = arguments.output;
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
