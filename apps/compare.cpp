#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "apps/command_line.h"
#include "apps/compare_runs.h"
#include "apps/directory_lock.h"
#include "apps/imported_runs.h"
#include "apps/io/import.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/program.h"
#include "apps/summary.h"

namespace grainlaw {
namespace {

struct Arguments {
  std::vector<std::string> runs;
  std::string table;
  std::string output = "comparison-report";
};

/// Runs named in the table's provenance were fitted; the others are out of sample.
std::vector<dem::LocalData> fitted_runs(const std::vector<dem::LocalData>& runs,
                                        const continuum::RheologyTable& table) {
  std::vector<dem::LocalData> fitted;
  for (const dem::LocalData& run : runs) {
    const auto& names = table.provenance.data;
    if (std::find(names.begin(), names.end(), run.name) != names.end()) fitted.push_back(run);
  }
  return fitted;
}

std::string check_line(const dem::LocalData& data, const continuum::RheologyTable& table) {
  const auto steady = continuum::steady_chute(table, chute_case(data.conditions));
  return fmt::format("{}: {:.4g} degrees, {}; table answers {}",
                     data.name,
                     io::degrees(data.conditions.inclination),
                     data.window.steady ? "steady" : "not steady",
                     name(steady.answer.outcome));
}

void add_lines(Summary& summary, const report::RunComparison& run) {
  const std::string label = fmt::format("{} ({})", run.data.name, name(run.kind));
  if (!run.error) {
    summary.add(run.data.name, label, run.steady.answer.text + "; DEM: " + run.data.window.reason);
    return;
  }
  summary.add_estimate(run.data.name,
                       label,
                       100.0 * run.error->velocity.value,
                       100.0 * run.error->velocity.error,
                       "% of the velocity (relative L2)");
}

/// The other flows have no prediction yet.
void require_chute(const dem::LocalData& data, const std::string& path) {
  const std::string& geometry = data.conditions.geometry;
  if (geometry == dem::ChuteConditions{}.geometry) return;
  throw io::InputError(
      fmt::format("{}: a {}: chutes only are predicted from a table", path, geometry));
}

ExitCode compare(const Arguments& arguments, const CommonOptions& options) {
  std::vector<dem::LocalData> runs;
  std::vector<io::RunRecord> imported;
  io::Units units;  // of the scenes: a table of a, b, tau_c in SI needs their sizes
  for (const std::string& path : arguments.runs) {
    io::RunRecord record = io::read_run(path);
    require_chute(record.data, path);
    units = record.units;
    runs.push_back(record.data);
    if (!record.imported_from.empty()) imported.push_back(std::move(record));
  }
  const continuum::RheologyTable table = io::in_grain_units(io::read_table(arguments.table), units);
  Summary summary;
  for (const io::RunRecord& record : imported) add_checks(summary, record);
  if (options.check) {
    for (const dem::LocalData& data : runs) summary.add(data.name, "run", check_line(data, table));
    print(summary, options);
    return ExitCode::answered;
  }
  const std::filesystem::path directory = arguments.output;
  const DirectoryLock lock(directory);
  store_imported(imported, directory / "runs", arguments.runs);
  const std::vector<dem::LocalData> fitted = fitted_runs(runs, table);
  report::Report report;
  report.title =
      "DEM against continuum: " + std::filesystem::path(arguments.table).filename().string();
  report.command = "grainlaw compare";
  report.machine = machine();
  report.table = table;
  report.warnings = failed_checks(imported);
  for (const std::string& warning : report.warnings) say("warning: " + warning);
  for (const dem::LocalData& data : runs) {
    report.costs.push_back({"DEM " + data.name, data.summary.wall_seconds, 0.0});
    report.runs.push_back(compare_run(data, table, fitted));
    report.costs.push_back({"prediction " + data.name, report.runs.back().predict_seconds, 0.0});
    const auto& notes = report.runs.back().notes;
    report.warnings.insert(report.warnings.end(), notes.begin(), notes.end());
    for (const std::string& note : notes) say("warning: " + note);
    add_lines(summary, report.runs.back());
  }
  report::write_report(report, directory);
  summary.add("report", "report", (directory / "report.html").string());
  print(summary, options);
  return ExitCode::answered;
}

}  // namespace
}  // namespace grainlaw

int main(int argc, char** argv) {
  using namespace grainlaw;
  CommonOptions options;
  CommandLine line("grainlaw-compare",
                   "Predicts the scene of every DEM run from a table and reports the differences.",
                   "  grainlaw compare results/runs/*.h5 -t results/table.toml -o comparison\n"
                   "  grainlaw compare lammps.toml -t results/table.toml -o comparison",
                   options);
  Arguments arguments;
  line.list("RUN.h5", arguments.runs, "runs, or import files (.toml) of others");
  line.option("-t,--table", arguments.table, "rheology table", true);
  line.option(
      "-o,--output", arguments.output, "folder for the report (default: comparison-report)");
  if (const auto code = line.parse(argc, argv)) return *code;
  return run_program("grainlaw compare", [&] { return compare(arguments, options); });
}
