#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <set>

#include "apps/campaign_run.h"
#include "apps/command_line.h"
#include "apps/compare_runs.h"
#include "apps/directory_lock.h"
#include "apps/imported_runs.h"
#include "apps/io/campaign_input.h"
#include "apps/io/import.h"
#include "apps/io/profile_csv.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/io/safe_write.h"
#include "apps/program.h"
#include "apps/scene_run.h"
#include "dem/run.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

struct Arguments {
  std::string campaign;
  std::string output = "calibration-report";
  std::vector<std::string> from;
  double max_wall = 0.0;  ///< [s]; 0: no limit
};

double seconds_since(steady_clock::time_point start) {
  return std::chrono::duration<double>(steady_clock::now() - start).count();
}

/// Runs of a campaign: those that calibrate and those that are predicted.
struct Runs {
  std::vector<dem::LocalData> fitted;
  std::vector<dem::LocalData> predicted;
  std::vector<report::StageCost> costs;
  std::vector<std::string> warnings;
  std::vector<io::RunRecord> imported;

  std::vector<dem::LocalData> all() const {
    std::vector<dem::LocalData> runs = fitted;
    runs.insert(runs.end(), predicted.begin(), predicted.end());
    std::sort(runs.begin(), runs.end(), [](const auto& a, const auto& b) {
      return a.conditions.inclination < b.conditions.inclination;
    });
    return runs;
  }
};

/// Calibration runs first: the fit needs them.
std::vector<io::SceneFile> scenes(const io::Campaign& campaign) {
  std::vector<io::SceneFile> files;
  for (const auto* tilts : {&campaign.calibrate_tilts, &campaign.predict_tilts}) {
    for (const double tilt : *tilts) files.push_back(io::scene_at(campaign, tilt));
  }
  return files;
}

/// The scenes with the profiles that the table of the campaign predicts as their start, written to
/// a file each. Where it predicts no flow a run starts from rest, which is said.
void start_from_predictions(std::vector<io::SceneFile>& files,
                            const fs::path& table_path,
                            const fs::path& directory,
                            std::vector<std::string>& warnings) {
  fs::create_directories(directory);
  for (io::SceneFile& file : files) {
    const auto table = io::in_grain_units(io::read_table(table_path), file.units);
    const auto steady = continuum::steady_chute(table, chute_case(dem::conditions(file.scene)));
    if (!continuum::flows(steady.answer.outcome)) {
      warnings.push_back(fmt::format("{} starts from rest: {} predicts {}",
                                     file.scene.name,
                                     table_path.filename().string(),
                                     name(steady.answer.outcome)));
      continue;
    }
    const fs::path csv = fs::absolute(directory / (file.scene.name + ".csv"));
    io::safe_write(csv, io::profile_csv(steady.profile, steady.answer, file.units));
    for (const continuum::ProfileRow& row : steady.profile.rows) {
      file.scene.start_profile.push_back({row.z, row.velocity});
    }
    io::restate(file, {{"start", "profile", fmt::format("\"{}\"", csv.string())}});
  }
}

bool among(double inclination, const std::vector<double>& tilts) {
  return std::any_of(
      tilts.begin(), tilts.end(), [&](double tilt) { return std::abs(tilt - inclination) < 1e-9; });
}

void sort_in(Runs& runs, dem::LocalData data, const io::Campaign& campaign) {
  if (!data.window.steady) {
    runs.warnings.push_back(fmt::format(
        "{} is not steady and is not fitted or scored: {}", data.name, data.window.reason));
  }
  if (among(data.conditions.inclination, campaign.calibrate_tilts) && data.window.steady) {
    runs.fitted.push_back(std::move(data));
  } else {
    runs.predicted.push_back(std::move(data));
  }
}

Runs measure(const io::Campaign& campaign, const fs::path& directory, int threads, bool quiet) {
  Runs runs;
  ProgressLine progress(quiet);
  const fs::path run_directory = directory / "runs";
  fs::create_directories(run_directory);
  std::vector<io::SceneFile> files = scenes(campaign);
  if (!campaign.start_table.empty()) {
    start_from_predictions(files, campaign.start_table, directory / "starts", runs.warnings);
  }
  for (CampaignRun& run : run_scenes(files, run_directory, threads, progress)) {
    if (!run.data) {
      runs.warnings.push_back(fmt::format("{} failed: {}", run.name, run.failure));
      continue;
    }
    runs.costs.push_back({"DEM " + run.name, run.data->summary.wall_seconds, run.cpu_seconds});
    sort_in(runs, std::move(*run.data), campaign);
  }
  return runs;
}

/// One warning for all runs whose standard errors rest on few samples.
void warn_of_few_samples(Runs& runs) {
  std::string names;
  for (const dem::LocalData& data : runs.all()) {
    const auto few = few_samples(data);
    if (few) names += fmt::format("{}{} {}", names.empty() ? "" : ", ", data.name, *few);
  }
  if (names.empty()) return;
  runs.warnings.push_back("few independent samples of the velocity at the worst height (" + names +
                          "): standard errors are rough; a longer averaging_time would help");
}

/// Equal but for the rounding of files.
bool equal(double a, double b) {
  return std::abs(a - b) <= 1e-6 * std::max(std::abs(a), std::abs(b));
}

/// Runs of other programs: their base is their own, and numbers were rounded on the way.
bool same_grains_elsewhere(const dem::ChuteConditions& a, const dem::ChuteConditions& b) {
  return equal(a.grain_diameter, b.grain_diameter) && equal(a.grain_density, b.grain_density) &&
         equal(a.stiffness, b.stiffness) && equal(a.contact_friction, b.contact_friction) &&
         equal(a.mass_per_area, b.mass_per_area);
}

/// A finished run belongs to a campaign when it ran under the conditions of its scene at one of its
/// tilts.
bool belongs(const io::RunRecord& record, const io::Campaign& campaign) {
  const dem::ChuteConditions& found = record.data.conditions;
  const double tilt = found.inclination;
  if (!among(tilt, campaign.calibrate_tilts) && !among(tilt, campaign.predict_tilts)) return false;
  const dem::ChuteConditions expected = dem::conditions(campaign.scene.scene);
  if (!record.imported_from.empty()) return same_grains_elsewhere(found, expected);
  return same_grains(found, expected) && found.mass_per_area == expected.mass_per_area;
}

Runs gather(const io::Campaign& campaign, const std::vector<std::string>& files) {
  Runs runs;
  std::set<std::string> seen;
  for (const std::string& file : files) {
    io::RunRecord record = io::read_run(file);
    if (!seen.insert(io::digest(record)).second) {
      throw io::InputError(file + ": the same run is given twice; it would count twice in the fit");
    }
    if (!belongs(record, campaign)) {
      throw io::InputError(file +
                           ": grains, base, mass or tilt are not those of the campaign; compare it "
                           "with `grainlaw compare` instead");
    }
    runs.costs.push_back({"DEM " + record.data.name, record.data.summary.wall_seconds, 0.0});
    sort_in(runs, record.data, campaign);
    if (!record.imported_from.empty()) runs.imported.push_back(std::move(record));
  }
  const std::vector<std::string> failed = failed_checks(runs.imported);
  runs.warnings.insert(runs.warnings.end(), failed.begin(), failed.end());
  return runs;
}

/// Predictions are written from the scenes alone, before any predicted run is looked at.
void write_predictions(const io::Campaign& campaign,
                       const continuum::RheologyTable& table,
                       const fs::path& directory) {
  fs::create_directories(directory);
  for (const double tilt : campaign.predict_tilts) {
    const io::SceneFile file = io::scene_at(campaign, tilt);
    const auto chute = chute_case(dem::conditions(file.scene));
    auto steady = continuum::steady_chute(table, chute);
    if (steady.profile.rows.empty()) continue;
    continuum::add_error_band(steady, table, chute);
    io::safe_write(directory / (file.scene.name + ".csv"),
                   io::profile_csv(steady.profile, steady.answer, io::grain_units()));
  }
}

void add_fit_lines(Summary& summary, const calibration::MuPhiFit& fit) {
  for (const calibration::FitSummary* part : {&fit.friction, &fit.volume_fraction}) {
    for (const auto& coefficient : part->coefficients) {
      summary.add_estimate(
          coefficient.name, coefficient.name, coefficient.value, coefficient.error);
    }
  }
}

void add_error_lines(Summary& summary, const std::vector<report::RunComparison>& runs) {
  for (const report::RunComparison& run : runs) {
    const std::string key = fmt::format("{:.4g}", io::degrees(run.data.conditions.inclination));
    const std::string label = fmt::format("{} degrees, {}", key, name(run.kind));
    if (run.error) {
      summary.add_estimate("velocity_error_percent_" + key,
                           label,
                           100.0 * run.error->velocity.value,
                           100.0 * run.error->velocity.error,
                           "% of the velocity (relative L2)");
    } else {
      summary.add(
          "answer_" + key, label, run.steady.answer.text + "; DEM: " + run.data.window.reason);
    }
    if (run.naive_error) {
      summary.add_estimate("naive_error_percent_" + key,
                           "  naive guess",
                           100.0 * run.naive_error->velocity.value,
                           100.0 * run.naive_error->velocity.error,
                           "% (" + run.naive_source + " rescaled)");
    }
  }
}

void write_bagnold_tables(const std::vector<report::RunComparison>& runs,
                          const fs::path& directory) {
  fs::create_directories(directory);
  for (const report::RunComparison& run : runs) {
    if (run.kind != calibration::SampleKind::in_sample || !run.own_bagnold_error) continue;
    io::write_table(run.own_bagnold->table, directory / (run.data.name + ".toml"));
  }
}

void record_checks(continuum::RheologyTable& table,
                   const std::vector<report::RunComparison>& runs) {
  for (const report::RunComparison& run : runs) {
    if (run.kind == calibration::SampleKind::in_sample || !run.error) continue;
    table.provenance.checked_against.push_back(
        fmt::format("{} ({}): velocity within {:.1f} +- {:.1f} % (relative L2)",
                    run.data.name,
                    name(run.kind),
                    100.0 * run.error->velocity.value,
                    100.0 * run.error->velocity.error));
  }
}

report::Report evaluate(const io::Campaign& campaign, Runs runs, const fs::path& directory) {
  report::Report report;
  report.title = campaign.title;
  report.machine = machine();
  report.warnings = std::move(runs.warnings);
  report.costs = std::move(runs.costs);
  auto start = steady_clock::now();
  report.fit = calibration::fit_mu_phi(runs.fitted);
  report.table = report.fit->table;
  report.costs.push_back({"fit", seconds_since(start), 0.0});
  write_predictions(campaign, report.table, directory / "predictions");
  const std::vector<dem::LocalData> all = runs.all();
  start = steady_clock::now();
  for (const dem::LocalData& data : all) {
    report.runs.push_back(compare_run(data, report.table, runs.fitted));
    const auto& notes = report.runs.back().notes;
    report.warnings.insert(report.warnings.end(), notes.begin(), notes.end());
  }
  report.costs.push_back({"predictions and comparison", seconds_since(start), 0.0});
  start = steady_clock::now();
  report.error_against_time = error_against_time(runs.fitted, all, report.table);
  report.costs.push_back({"error against averaging time", seconds_since(start), 0.0});
  record_checks(report.table, report.runs);
  return report;
}

ExitCode check(const io::Campaign& campaign, const CommonOptions& options) {
  std::string text;
  for (const io::SceneFile& file : scenes(campaign)) {
    const Summary summary = check_scene(file);
    if (!text.empty()) text += options.json ? ",\n" : "\n";
    text += options.json ? summary.json() : summary.text();
  }
  fmt::print("{}", options.json ? "[\n" + text + "]\n" : text);
  return ExitCode::answered;
}

ExitCode calibrate(const Arguments& arguments, const CommonOptions& options) {
  const io::Campaign campaign = io::read_campaign(arguments.campaign);
  if (options.check) return check(campaign, options);
  const fs::path directory = arguments.output;
  const DirectoryLock lock(directory);
  catch_stop_signals();
  if (arguments.max_wall > 0.0) stop_after(arguments.max_wall);
  Runs runs = arguments.from.empty() ? measure(campaign, directory, options.threads, options.quiet)
                                     : gather(campaign, arguments.from);
  if (stop_requested()) {
    say(fmt::format("grainlaw calibrate: stopped {}; the same command goes on with the runs in {}",
                    stop_reason(),
                    (directory / "runs").string()));
    return ExitCode::stopped;
  }
  warn_of_few_samples(runs);
  for (const std::string& warning : runs.warnings) say("warning: " + warning);
  store_imported(runs.imported, directory / "runs", arguments.from);
  Summary summary;
  for (const io::RunRecord& record : runs.imported) add_checks(summary, record);
  report::Report report = evaluate(campaign, std::move(runs), directory);
  report.command = "grainlaw calibrate " + fs::path(arguments.campaign).filename().string();
  io::write_table(report.table, directory / "table.toml");
  write_bagnold_tables(report.runs, directory / "bagnold");
  report::write_report(report, directory);
  add_fit_lines(summary, *report.fit);
  add_error_lines(summary, report.runs);
  summary.add("table", "table", (directory / "table.toml").string());
  summary.add("report", "report", (directory / "report.html").string());
  print(summary, options);
  return ExitCode::answered;
}

}  // namespace
}  // namespace grainlaw

int main(int argc, char** argv) {
  using namespace grainlaw;
  CommonOptions options;
  CommandLine line("grainlaw-calibrate",
                   "Runs the scenes of a campaign, fits mu(I) and phi(I) and, per tilt, a and b,\n"
                   "predicts every run from the fitted table, writes table, predictions, report.",
                   "  grainlaw calibrate data/campaigns/quickstart/campaign.toml -o results",
                   options);
  Arguments arguments;
  line.required("CAMPAIGN.toml", arguments.campaign, "the campaign");
  line.option("-o,--output", arguments.output, "folder for results (default: calibration-report)");
  line.option_list(
      "--from", arguments.from, "finished runs or imports (.toml) to use, run nothing");
  line.duration("--max-wall", arguments.max_wall, "stop with checkpoints after this wall time");
  line.threads("runs at once, one thread each (default: cores)", 0);
  if (const auto code = line.parse(argc, argv)) return *code;
  return run_program("grainlaw calibrate", [&] { return calibrate(arguments, options); });
}
