#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>

#include "apps/budget.h"
#include "apps/campaign_check.h"
#include "apps/campaign_data.h"
#include "apps/campaign_report.h"
#include "apps/campaign_run.h"
#include "apps/command_line.h"
#include "apps/directory_lock.h"
#include "apps/friction_tables.h"
#include "apps/imported_runs.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/program.h"
#include "apps/scene_run.h"
#include "apps/series_summary.h"
#include "dem/estimate_text.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string campaign;
  std::string output = "calibration-report";
  std::vector<std::string> from;
  std::string reference;  ///< table to compare the law of shear boxes with; empty: none
  bool list = false;
  std::vector<std::string> tables;  ///< of grains that differ in mu_p only, instead of a campaign
  std::string contact_friction;     ///< mu_p of a table between them; empty: none
  double max_wall = 0.0;            ///< [s]; 0: no limit
  double budget = 0.0;              ///< [s] of wall time to plan runs for; 0: run the campaign
};

/// One warning for all runs whose standard errors rest on few samples.
void warn_of_few_samples(CampaignData& data) {
  constexpr std::size_t most = 6;  // names in a sentence
  std::vector<std::string> found;
  for (const dem::LocalData& run : data.chutes()) {
    const auto few = few_samples(run);
    if (few) found.push_back(fmt::format("{} {}", run.name, *few));
  }
  if (found.empty()) return;
  const std::size_t more = found.size() > most ? found.size() - most : 0;
  found.resize(found.size() - more);
  const std::string names = fmt::format(
      "{}{}", fmt::join(found, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
  data.warnings.push_back("few independent samples of the velocity at the worst height (" + names +
                          "): standard errors are rough; a longer averaging_time would help");
}

void add_run_lines(Summary& summary, const CampaignData& data) {
  summary.add("runs", "runs", static_cast<long>(data.runs.size()));
  if (data.kept > 0) summary.add("runs_kept", "  finished before", static_cast<long>(data.kept));
  if (!data.failed.empty()) summary.add("runs_failed", "  failed", data.failed);
}

/// What the last law of a budget promises for its targets, and what of it is known.
void add_budget_lines(Summary& summary, const report::BudgetReport& budget) {
  summary.add("budget_rounds", "rounds", static_cast<long>(budget.rounds.size()));
  summary.add("budget_spent", "  budget spent", duration_text(budget.spent_seconds));
  summary.add("dem_cpu_seconds", "  CPU of DEM", budget.rounds.back().cpu_seconds, "s");
  for (std::size_t k = 0; k < budget.targets.size(); ++k) {
    const std::string tilt = fmt::format("{:.4g}", io::degrees(budget.targets[k]));
    const dem::Estimate& velocity = budget.rounds.back().surface_velocity[k];
    summary.add_estimate("surface_velocity_" + tilt,
                         tilt + " degrees, surface velocity",
                         velocity.value,
                         velocity.error,
                         "sqrt(g d)");
  }
}

void add_fit_lines(Summary& summary,
                   const calibration::FitSummary& friction,
                   const calibration::FitSummary& volume_fraction) {
  for (const calibration::FitSummary* part : {&friction, &volume_fraction}) {
    for (const auto& coefficient : part->coefficients) {
      summary.add_estimate(
          coefficient.name, coefficient.name, coefficient.value, coefficient.error);
    }
  }
}

/// By tilt; by name where several seeds have the same.
std::string key_of(const report::RunComparison& run,
                   const std::vector<report::RunComparison>& all) {
  const double tilt = run.data.conditions.inclination;
  const auto same = std::ranges::count_if(all, [&](const report::RunComparison& other) {
    return other.data.conditions.inclination == tilt;
  });
  return same > 1 ? run.data.name : fmt::format("{:.4g}", io::degrees(tilt));
}

void add_error_lines(Summary& summary, const std::vector<report::RunComparison>& runs) {
  for (const report::RunComparison& run : runs) {
    const std::string key = key_of(run, runs);
    const std::string degrees = fmt::format("{:.4g}", io::degrees(run.data.conditions.inclination));
    const std::string label =
        fmt::format("{}, {}", key == degrees ? key + " degrees" : key, name(run.kind));
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

void add_seed_lines(Summary& summary, const std::vector<report::SeedScatter>& seeds) {
  for (const report::SeedScatter& one : seeds) {
    summary.add("seed_scatter_" + one.condition + "_" + one.quantity,
                fmt::format("{}, {}", one.condition, one.quantity),
                fmt::format("{} in time, {} seeds scatter by {:.2g} ({:.2g} expected)",
                            value_with_error(one.mean.value, one.mean.error),
                            one.seeds,
                            one.scatter,
                            one.expected_scatter()));
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

/// The table that shear boxes or the runs of a series are held against, where one is given.
std::optional<Reference> reference_of(const io::Campaign& campaign, const Arguments& arguments) {
  if (arguments.reference.empty()) return {};
  if (campaign.shear_boxes.empty() && campaign.series.empty()) {
    throw io::InputError(
        "--reference goes with [[shear_boxes]] and [[series]]; hold runs of chutes against a table "
        "with "
        "`grainlaw compare`");
  }
  continuum::RheologyTable table = io::read_table(arguments.reference);
  if (!std::holds_alternative<continuum::MuPhi>(table.law)) {
    throw io::InputError(
        fmt::format("{}: holds the a and b of one tilt; a table of mu(I, p*, Bo) or phi(I, p*, Bo) "
                    "is wanted as --reference",
                    arguments.reference));
  }
  // "table.toml" in the folder of a calibration is known by its folder
  const fs::path path = fs::absolute(arguments.reference);
  const fs::path name = path.stem() == "table" ? path.parent_path().filename() : path.stem();
  return Reference{name.string(), std::move(table)};
}

ExitCode check(const io::Campaign& campaign,
               const Arguments& arguments,
               const CommonOptions& options) {
  reference_of(campaign, arguments);
  if (arguments.budget > 0.0)
    check_budget(campaign, arguments.from, arguments.budget, options);
  else if (!arguments.from.empty())
    check_given(campaign, arguments.from, options);
  else
    check_runs(campaign, options);
  return ExitCode::answered;
}

/// One command per run, for other programs to start.
ExitCode list(const io::Campaign& campaign, const fs::path& directory) {
  const DirectoryLock lock(directory);
  const fs::path runs = directory / "runs";
  fs::create_directories(runs);
  std::vector<std::string> warnings;
  std::vector<io::SceneFile> scenes;
  for (io::PlannedRun& run : runs_with_starts(campaign, directory, warnings)) {
    scenes.push_back(std::move(run.file));
  }
  write_scenes(scenes, runs);
  for (const std::string& warning : warnings) say("warning: " + warning);
  for (const io::SceneFile& file : scenes) {
    fmt::print("grainlaw dem {} -o {}\n",
               shell_word(scene_path(runs, file.scene.name).string()),
               shell_word(data_path(runs, file.scene.name).string()));
  }
  return ExitCode::answered;
}

void write_results(const report::Report& report, const fs::path& directory, Summary& summary) {
  io::write_table(report.table, directory / "table.toml");
  if (report.fit) write_bagnold_tables(report.runs, directory / "bagnold");
  report::write_report(report, directory);
  if (report.fit) add_fit_lines(summary, report.fit->friction, report.fit->volume_fraction);
  if (report.material) {
    add_fit_lines(summary, report.material->fit.friction, report.material->fit.volume_fraction);
  }
  add_error_lines(summary, report.runs);
  add_seed_lines(summary, report.seeds);
  summary.add("table", "table", (directory / "table.toml").string());
}

void write_results(const report::SeriesReport& report,
                   const fs::path& directory,
                   Summary& summary) {
  report::write_report(report, directory);
  add_series_lines(summary, report);
}

/// What made a report, as far as it decides what is in it.
std::string command_of(const io::Campaign& campaign, const Arguments& arguments) {
  std::string text = "grainlaw calibrate " + shell_word(campaign.path.filename().string());
  text += option_text("--from", arguments.from);
  if (!arguments.reference.empty()) text += option_text("--reference", {arguments.reference});
  if (arguments.budget > 0.0) text += fmt::format(" --budget {:g}s", arguments.budget);
  return text;
}

/// From data to table and report.
Summary conclude(const io::Campaign& campaign,
                 const Arguments& arguments,
                 const std::optional<Reference>& reference,
                 CampaignData data,
                 std::optional<report::BudgetReport> budget) {
  Summary summary;
  add_run_lines(summary, data);
  for (const io::RunRecord& record : data.imported) add_checks(summary, record);
  const fs::path directory = arguments.output;
  if (campaign.series.empty()) {
    report::Report report = evaluate(campaign, std::move(data), directory, reference);
    report.command = command_of(campaign, arguments);
    if (budget) add_budget_lines(summary, *budget);
    report.budget = std::move(budget);
    write_results(report, directory, summary);
  } else {
    report::SeriesReport report = evaluate_series(campaign, std::move(data), reference);
    report.command = command_of(campaign, arguments);
    write_results(report, directory, summary);
  }
  summary.add("report", "report", (directory / "report.html").string());
  return summary;
}

ExitCode run(const io::Campaign& campaign,
             const Arguments& arguments,
             const CommonOptions& options) {
  const auto reference = reference_of(campaign, arguments);  // before hours of runs
  const fs::path directory = arguments.output;
  refuse_overwriting_input((directory / "table.toml").string(),
                           {arguments.reference, campaign.start_table.string()});
  const DirectoryLock lock(directory);
  catch_stop_signals(arguments.max_wall);
  std::optional<report::BudgetReport> budget;
  CampaignData data;
  if (arguments.budget > 0.0) {
    const auto write = [&](const CampaignData& now, const report::BudgetReport& spent) {
      conclude(campaign, arguments, reference, now, spent);
    };
    BudgetOutcome outcome = measure_within(campaign,
                                           directory,
                                           {.seconds = arguments.budget,
                                            .processes = options.threads,
                                            .from = arguments.from,
                                            .quiet = options.quiet,
                                            .write_report = write});
    budget = std::move(outcome.report);
    data = std::move(outcome.data);
  } else {
    data = arguments.from.empty() ? measure(campaign, directory, options.threads, options.quiet)
                                  : gather(campaign, arguments.from);
  }
  if (stop_requested()) {
    say(fmt::format("grainlaw calibrate: stopped {}; the same command goes on with the runs in {}",
                    stop_reason(),
                    (directory / "runs").string()));
    return ExitCode::stopped;
  }
  warn_of_few_samples(data);
  for (const std::string& warning : data.warnings) say("warning: " + warning);
  store_imported(data.imported, directory / "runs", arguments.from);
  print(conclude(campaign, arguments, reference, std::move(data), std::move(budget)), options);
  return ExitCode::answered;
}

ExitCode fit_over_tables(const Arguments& arguments, const CommonOptions& options) {
  FrictionTables wanted{
      .tables = arguments.tables, .output = arguments.output, .contact_friction = {}};
  const std::string& text = arguments.contact_friction;
  if (!text.empty()) {
    double value = -1.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value >= 0.0)) {
      throw io::InputError(
          fmt::format("--contact-friction {}: a number of at least 0 is expected", text));
    }
    wanted.contact_friction = value;
  }
  return fit_over_contact_friction(wanted, options);
}

ExitCode calibrate(const Arguments& arguments, const CommonOptions& options) {
  if (arguments.tables.empty() == arguments.campaign.empty()) {
    throw io::InputError("give either a CAMPAIGN.toml or --tables; --help shows examples");
  }
  if (!arguments.tables.empty()) {
    if (arguments.list || !arguments.from.empty() || !arguments.reference.empty() ||
        arguments.budget > 0.0 || arguments.max_wall > 0.0) {
      throw io::InputError(
          "--list, --from, --reference, --budget and --max-wall go with a campaign, not with "
          "--tables");
    }
    return fit_over_tables(arguments, options);
  }
  if (!arguments.contact_friction.empty()) {
    throw io::InputError(
        "--contact-friction goes with --tables; a campaign has that of its grains");
  }
  if (arguments.budget > 0.0 && (arguments.list || arguments.max_wall > 0.0)) {
    throw io::InputError(
        "--budget plans its runs and their end itself: it goes neither with --list nor with "
        "--max-wall");
  }
  if (arguments.list && !arguments.from.empty()) {
    throw io::InputError(
        "--list and --from exclude each other: the one names runs to make, the "
        "other finished ones");
  }
  const io::Campaign campaign = io::read_campaign(arguments.campaign);
  if (options.check) return check(campaign, arguments, options);
  if (arguments.list) return list(campaign, arguments.output);
  return run(campaign, arguments, options);
}

}  // namespace
}  // namespace grainlaw

int main(int argc, char** argv) {
  using namespace grainlaw;
  CommandLine line(
      "calibrate",
      "Runs the scenes of a campaign, fits mu(I) and phi(I) to chutes, with a and b per\n"
      "tilt, or mu(I, p*, Bo) and phi(I, p*, Bo) to shear boxes, predicts every chute\n"
      "from the fitted table, writes table, predictions, report.",
      "  grainlaw calibrate data/campaigns/quickstart/campaign.toml -o results\n"
      "  grainlaw calibrate CAMPAIGN.toml -o results --budget 10min\n"
      "  grainlaw calibrate CAMPAIGN.toml -o results --list | parallel\n"
      "  grainlaw calibrate CAMPAIGN.toml -o results --from results/runs");
  Arguments arguments;
  line.option("CAMPAIGN.toml", arguments.campaign, "the campaign");
  line.option("-o,--output", arguments.output, "folder for results (default: calibration-report)");
  line.option_list("--from", arguments.from, "finished runs, folders or imports; run nothing");
  line.flag("--list", arguments.list, "write the scenes, print a command for each");
  line.option("--reference", arguments.reference, "table to hold boxes or runs of series against");
  line.option_list("--tables", arguments.tables, "no campaign: coefficients over contact friction");
  line.option("--contact-friction",
              arguments.contact_friction,
              "with --tables: write the table at this value");
  line.duration("--max-wall", arguments.max_wall, "stop with checkpoints after this wall time");
  line.duration("--budget", arguments.budget, "choose runs that tell most in this wall time");
  line.threads("runs at once, one process each (default: cores)", 0);
  return line.run(
      argc, argv, [&](const CommonOptions& options) { return calibrate(arguments, options); });
}
