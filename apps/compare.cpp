#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "apps/command_line.h"
#include "apps/compare_cases.h"
#include "apps/compare_flows.h"
#include "apps/compare_runs.h"
#include "apps/compare_scores.h"
#include "apps/directory_lock.h"
#include "apps/imported_runs.h"
#include "apps/io/import.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/io/safe_write.h"
#include "apps/program.h"
#include "apps/summary.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::vector<std::string> runs;
  std::vector<std::string> tables;
  std::string output = "comparison-report";
  std::optional<double> nonlocal;  ///< absent: local laws only
  bool fit_nonlocal = false;
};

/// Everything a comparison reads.
struct Input {
  std::vector<io::RunRecord> runs;
  std::vector<ComparedTable> tables;
};

bool is_chute(const io::RunRecord& record) {
  return record.data.conditions.geometry == dem::ChuteConditions{}.geometry;
}

Input read(const Arguments& arguments) {
  Input input;
  io::Units units;  // of the scenes: a table of a, b, tau_c in SI needs their sizes
  std::set<std::string> seen;
  for (const std::string& path : arguments.runs) {
    input.runs.push_back(io::read_run(path));
    units = input.runs.back().units;
    if (!seen.insert(io::digest(input.runs.back())).second)
      throw io::InputError(path + ": the same run is given twice; it would be scored twice");
  }
  const auto alike = [&](const fs::path& path) {
    return std::ranges::count_if(arguments.tables, [&](const std::string& other) {
      return fs::path(other).filename() == path.filename();
    });
  };
  for (const fs::path path : arguments.tables) {  // with its folder where the name tells too little
    if (!seen.insert(io::read_file(path)).second)
      throw io::InputError(path.string() + ": the same table is given twice");
    const continuum::RheologyTable table = io::read_table(path);
    if (!table.has_friction)
      throw io::InputError(path.string() +
                           ": has phi only, and without friction nothing flows by it");
    const fs::path folder = fs::absolute(path).parent_path().filename();
    const fs::path name = alike(path) > 1 ? folder / path.filename() : path.filename();
    input.tables.push_back({name.string(), io::in_grain_units(table, units)});
  }
  return input;
}

/// The other flows are made of mu(I); a law of one tilt says nothing of them.
void require_mu_phi(const Input& input) {
  const auto flow = std::ranges::find_if_not(input.runs, is_chute);
  if (flow == input.runs.end()) return;
  for (const ComparedTable& compared : input.tables) {
    const auto& table = compared.table;
    if (std::holds_alternative<continuum::MuPhi>(table.law) && table.has_friction) continue;
    throw io::InputError(
        fmt::format("{}: run '{}' is a {}, which needs a table of mu(I) and phi(I)",
                    compared.name,
                    flow->data.name,
                    flow->data.conditions.geometry));
  }
}

/// Runs named in the table's provenance were fitted; the others are out of sample.
std::vector<dem::LocalData> fitted_runs(const std::vector<io::RunRecord>& runs,
                                        const continuum::RheologyTable& table) {
  std::vector<dem::LocalData> fitted;
  for (const io::RunRecord& run : runs) {
    if (was_fitted(table, run)) fitted.push_back(run.data);
  }
  return fitted;
}

std::string check_line(const io::RunRecord& record, const continuum::RheologyTable& table) {
  const dem::LocalData& data = record.data;
  const std::string steady = data.window.steady ? "steady" : "not steady";
  if (is_chute(record)) {
    const auto answer = continuum::steady_chute(table, chute_case(data.conditions)).answer;
    return fmt::format("{:.4g} degrees, {}; table answers {}",
                       io::degrees(data.conditions.inclination),
                       steady,
                       name(answer.outcome));
  }
  if (!is_band(data)) return fmt::format("{}, {}", data.conditions.geometry, steady);
  const auto answer = continuum::shear_band(table, band_case(scene_of(record), data)).answer;
  return fmt::format(
      "{}, {}; table answers {}", data.conditions.geometry, steady, name(answer.outcome));
}

void check(Summary& summary, const Input& input) {
  for (const io::RunRecord& run : input.runs) {
    for (const ComparedTable& compared : input.tables) {
      const std::string label =
          run.data.name + (input.tables.size() > 1 ? ", " + compared.name : "");
      summary.add(label, label, check_line(run, compared.table));
    }
  }
}

std::optional<report::NonlocalAmplitude> amplitude(const Arguments& arguments, const Input& input) {
  if (arguments.nonlocal) return report::NonlocalAmplitude{.value = *arguments.nonlocal, .run = {}};
  if (!arguments.fit_nonlocal) return std::nullopt;
  for (const io::RunRecord& run : input.runs) {
    if (has_nonlocal_flow(run.data)) return fit_nonlocal(run, input.tables.front().table);
  }
  throw io::InputError(
      "--fit-nonlocal needs a run of plane shear, of a body-force box or of a ring cell");
}

void take_notes(report::Report& report, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    if (std::ranges::find(report.warnings, note) != report.warnings.end()) continue;
    report.warnings.push_back(note);
    say("warning: " + note);
  }
}

/// Only its history can be scored then.
void note_unsteady(const dem::LocalData& data, report::Report& report) {
  if (data.window.steady) return;
  take_notes(
      report,
      {data.name + " is not steady, its steady profile is not scored: " + data.window.reason});
}

/// What a start from rest is held against, where frames were joined.
void note_joined_frames(const io::RunRecord& run, report::RunComparison& compared) {
  if (run.reduced_from.empty() || compared.in_time.empty()) return;
  const dem::ProfileFrame& first = run.data.frames.frames.front();
  compared.notes.push_back(
      fmt::format("{}: a reduced file, its start is averaged over {:.3g} sqrt(d/g) at a time",
                  run.data.name,
                  first.end - first.begin));
}

/// Chutes against the first table fill the report; those against the others give scores only.
void compare_chutes(const Input& input, report::Report& report) {
  for (std::size_t t = 0; t < input.tables.size(); ++t) {
    const continuum::RheologyTable& table = input.tables[t].table;
    const std::vector<dem::LocalData> fitted = fitted_runs(input.runs, table);
    for (const io::RunRecord& run : input.runs) {
      if (!is_chute(run)) continue;
      note_unsteady(run.data, report);
      report::RunComparison compared = compare_run(run.data, table, fitted);
      note_joined_frames(run, compared);
      auto& scores = report.tables[t].scores;
      scores.push_back(score_of(compared));
      std::ranges::move(in_time_scores(compared), std::back_inserter(scores));
      take_notes(report, compared.notes);
      if (t > 0) continue;
      report.costs.push_back({"prediction " + run.data.name, compared.predict_seconds, 0.0});
      report.runs.push_back(std::move(compared));
    }
    if (t > 0) continue;
    report.left_out = leave_one_out(fitted);
    for (const auto& left : report.left_out) report.tables[t].scores.push_back(score_of(left));
  }
}

void compare_flows(const Input& input, report::Report& report) {
  for (const io::RunRecord& run : input.runs) {
    if (is_chute(run)) continue;
    report.flows.push_back(compare_flow(run, input.tables, report.nonlocal));
    take_notes(report, report.flows.back().notes);
    for (std::size_t t = 0; t < input.tables.size(); ++t) {
      const auto scores = scores_of(report.flows.back(), t);
      auto& all = report.tables[t].scores;
      all.insert(all.end(), scores.begin(), scores.end());
    }
  }
}

/// `table`: its number from 1, 0 where it is the only one.
void add_line(Summary& summary, const report::Score& score, std::size_t table) {
  const std::string of = table > 0 ? fmt::format(", table {}", table) : std::string();
  const bool profile = score.quantity.front() == 'u';
  const bool left_out = score.kind == calibration::SampleKind::leave_one_out;
  const bool chute = score.flow == dem::ChuteConditions{}.geometry && score.quantity == "u";
  const std::string key =
      score.run + (left_out ? " left out" : "") + (chute ? "" : " " + score.quantity) + of;
  const std::string label =
      fmt::format("{} {} ({})", score.run, score.quantity, calibration::name(score.kind));
  if (std::isfinite(score.difference.value)) {
    summary.add_estimate(key,
                         label,
                         100.0 * score.difference.value,
                         100.0 * score.difference.error,
                         profile ? "% (L2)" : "%");
  } else if (score.quantity != "phi") {  // says the same again
    summary.add(key, label, score.remark);
  }
}

/// Times as such, for those who read the JSON; by the first table.
void add_times(Summary& summary, const report::RunComparison& run) {
  const auto add = [&](const std::string& what, const dem::Estimate& time) {
    summary.add_estimate(run.data.name + " " + what,
                         run.data.name + " " + what,
                         time.value,
                         time.error,
                         "sqrt(d/g)");
  };
  for (const calibration::Stretch& stretch : run.in_time) {
    const std::string of = ", " + std::string(calibration::name(stretch.change));
    if (stretch.to_steady) {
      add("time to steady" + of + ", DEM", stretch.to_steady->measured);
      add("time to steady" + of + ", continuum", stretch.to_steady->predicted);
    }
    if (!stretch.stop) continue;
    if (stretch.stop->measured) add("stopping time, DEM", *stretch.stop->measured);
    const std::string predicted = run.data.name + " stopping time, continuum";
    if (stretch.stop->predicted)
      summary.add(predicted, predicted, *stretch.stop->predicted, "sqrt(d/g)");
  }
}

void add_lines(Summary& summary, const report::Report& report) {
  const bool several = report.tables.size() > 1;
  for (std::size_t t = 0; several && t < report.tables.size(); ++t) {
    const std::string number = fmt::format("table {}", t + 1);
    summary.add(number, number, report.tables[t].name);
  }
  for (std::size_t t = 0; t < report.tables.size(); ++t) {
    if (several) summary.heading(fmt::format("table {}", t + 1));
    for (const report::Score& score : report.tables[t].scores)
      add_line(summary, score, several ? t + 1 : 0);
  }
  for (const report::RunComparison& run : report.runs) add_times(summary, run);
}

void add_nonlocal(Summary& summary, const report::NonlocalAmplitude& nonlocal) {
  if (nonlocal.run.empty()) {
    summary.add("nonlocal", "A, given", nonlocal.value, "");
    return;
  }
  summary.add_estimate(
      "nonlocal", "A, fitted to " + nonlocal.run, nonlocal.value, nonlocal.error, "");
}

/// What made a report.
std::string command_of(const Arguments& arguments) {
  std::string text = "grainlaw compare" + option_text("", arguments.runs) +
                     option_text("--table", arguments.tables);
  if (arguments.nonlocal) text += fmt::format(" --nonlocal {}", *arguments.nonlocal);
  return arguments.fit_nonlocal ? text + " --fit-nonlocal" : text;
}

ExitCode compare(const Arguments& arguments, const CommonOptions& options) {
  if (arguments.nonlocal && arguments.fit_nonlocal)
    throw io::InputError("--nonlocal gives the amplitude A and --fit-nonlocal finds it: give one");
  const Input input = read(arguments);
  require_mu_phi(input);
  std::vector<io::RunRecord> imported;
  for (const io::RunRecord& run : input.runs) {
    if (!run.imported_from.empty()) imported.push_back(run);
  }
  Summary summary;
  for (const io::RunRecord& record : imported) add_checks(summary, record);
  if (options.check) {
    check(summary, input);
    print(summary, options);
    return ExitCode::answered;
  }
  const fs::path directory = arguments.output;
  const DirectoryLock lock(directory);
  store_imported(imported, directory / "runs", arguments.runs);
  report::Report report;
  report.title = "DEM against continuum: ";
  report.title += input.tables.size() == 1 ? input.tables.front().name
                                           : fmt::format("{} tables", input.tables.size());
  report.command = command_of(arguments);
  report.machine = machine();
  report.table = input.tables.front().table;
  for (const ComparedTable& t : input.tables) report.tables.push_back({t.name, t.table, {}});
  take_notes(report, failed_checks(imported));
  for (const io::RunRecord& run : input.runs) {
    report.costs.push_back({"DEM " + run.data.name, run.data.summary.wall_seconds, 0.0});
  }
  report.nonlocal = amplitude(arguments, input);
  compare_chutes(input, report);
  compare_flows(input, report);
  report::write_report(report, directory);
  add_lines(summary, report);
  if (report.nonlocal) add_nonlocal(summary, *report.nonlocal);
  summary.add("report", "report", (directory / "report.html").string());
  print(summary, options);
  return ExitCode::answered;
}

}  // namespace
}  // namespace grainlaw

int main(int argc, char** argv) {
  using namespace grainlaw;
  CommandLine line("compare",
                   "Holds DEM runs of any flow against one or more tables and reports the\n"
                   "differences: chutes, plane shear and body-force boxes against predictions of\n"
                   "their scenes, simple shear and ring cells against the law at their states.",
                   "  grainlaw compare results/runs/*.h5 -t results/table.toml -o comparison\n"
                   "  grainlaw compare box.h5 walls.h5 -t a.toml b.toml --fit-nonlocal");
  Arguments arguments;
  line.list("RUN.h5", arguments.runs, "runs, or import files (.toml) of others");
  line.option_list("-t,--table", arguments.tables, "rheology tables", true);
  line.option(
      "-o,--output", arguments.output, "folder for the report (default: comparison-report)");
  line.number("--nonlocal", arguments.nonlocal, "predict bands with this amplitude A too");
  line.flag(
      "--fit-nonlocal", arguments.fit_nonlocal, "fit A to the first band or ring cell among them");
  return line.run(
      argc, argv, [&](const CommonOptions& options) { return compare(arguments, options); });
}
