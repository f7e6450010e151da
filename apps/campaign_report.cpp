#include "apps/campaign_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "apps/compare_runs.h"
#include "apps/io/profile_csv.h"
#include "apps/io/safe_write.h"
#include "apps/material_runs.h"
#include "apps/program.h"
#include "apps/seed_scatter.h"
#include "calibration/box_points.h"
#include "dem/estimate_text.h"
#include "dem/run.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

/// Adds what a stage took to the costs of a report, when it ends.
class StageClock {
 public:
  StageClock(report::ReportHead& report, std::string stage)
      : report_(report), stage_(std::move(stage)) {}
  ~StageClock() {
    const std::chrono::duration<double> passed = steady_clock::now() - start_;
    report_.costs.push_back({stage_, passed.count(), 0.0});
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  report::ReportHead& report_;
  std::string stage_;
  steady_clock::time_point start_ = steady_clock::now();
};

/// The mechanism that Bo measures, where it was varied or there at all.
std::string cohesion_of(const io::Campaign& campaign) {
  std::string cohesion;
  for (const io::ShearBoxes& boxes : campaign.shear_boxes) {
    const dem::Scene& scene = boxes.scene.scene;
    if (std::holds_alternative<dem::Cohesionless>(scene.cohesion)) continue;
    cohesion = std::visit([](const auto& law) { return std::string(law.name); }, scene.cohesion);
  }
  return cohesion;
}

std::vector<dem::LocalData> boxes_of(const CampaignData& data) {
  std::vector<dem::LocalData> boxes;
  for (const MeasuredRun& run : data.runs) {
    if (run.data.conditions.geometry == "simple_shear") boxes.push_back(run.data);
  }
  return boxes;
}

calibration::MaterialFitOptions material_options(const io::Campaign& campaign) {
  const dem::Scene& scene = campaign.shear_boxes.front().scene.scene;
  calibration::MaterialFitOptions options;
  options.contact_friction = dem::contact_friction(scene);
  options.cohesion = cohesion_of(campaign);
  return options;
}

void fit_boxes(report::Report& report, const io::Campaign& campaign, const CampaignData& data) {
  report.material = study_material(boxes_of(data), material_options(campaign));
  report.table = report.material->fit.table;
}

void fit_chutes(report::Report& report, const CampaignData& data) {
  const std::vector<dem::LocalData> fitted = data.fitted();
  report.fit = calibration::fit_mu_phi(fitted, mean_points(data));
  report.table = report.fit->table;
}

/// In the order of the runs that the table names.
void name_data(continuum::Provenance& provenance, const CampaignData& data) {
  provenance.data.clear();
  for (const MeasuredRun& run : data.runs) {
    if (!run.fitted) continue;
    provenance.geometry = run.data.conditions.geometry;
    provenance.data.push_back(run.data.name);
    provenance.digests.push_back(run.digest);
  }
}

/// Predictions are written from the scenes alone, before any predicted run is looked at.
void write_predictions(const io::Campaign& campaign,
                       const continuum::RheologyTable& table,
                       const fs::path& directory) {
  if (!campaign.predict_tilts.empty()) fs::create_directories(directory);
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

void compare_chutes(report::Report& report, const CampaignData& data) {
  const bool across = report.material.has_value();
  const auto fitted = across ? std::vector<dem::LocalData>{} : data.fitted();
  for (const dem::LocalData& chute : data.chutes()) {
    report.runs.push_back(compare_run(chute, report.table, fitted));
    report::RunComparison& run = report.runs.back();
    if (across) run.kind = calibration::SampleKind::cross_geometry;
    report.warnings.insert(report.warnings.end(), run.notes.begin(), run.notes.end());
  }
}

void record_checks(continuum::RheologyTable& table,
                   const std::vector<report::RunComparison>& runs) {
  for (const report::RunComparison& run : runs) {
    if (run.kind == calibration::SampleKind::in_sample || !run.error) continue;
    table.provenance.checked_against.push_back(fmt::format(
        "{} ({}): velocity within {} % (relative L2)",
        run.data.name,
        name(run.kind),
        value_with_error(100.0 * run.error->velocity.value, 100.0 * run.error->velocity.error)));
  }
}

/// The runs of the series, in their order.
void study_series(report::SeriesReport& report,
                  const io::Campaign& campaign,
                  const CampaignData& data,
                  const std::optional<Reference>& reference) {
  std::vector<calibration::SeriesRun> runs;
  std::vector<std::string> missing;
  for (const io::ChuteSeries& series : campaign.series) {
    for (const io::SceneFile& file : series.scenes) {
      const auto found = std::ranges::find(data.runs, file.scene.name, &MeasuredRun::condition);
      if (found == data.runs.end()) {
        missing.push_back(file.scene.name + ": there is no run of it");
        continue;
      }
      const dem::LocalData& run = found->data;
      runs.push_back({series.name, &run});
      if (run.lifetimes) report.curves.push_back({run.name, series.name, *run.lifetimes});
    }
  }
  constexpr std::size_t touching = 0;  // the smallest d_c
  const continuum::RheologyTable* law = reference ? &reference->table : nullptr;
  if (reference) report.law_name = reference->name;
  report.contacts = calibration::contact_series(runs, touching, {}, law);
  report.contacts.left_out.insert(report.contacts.left_out.begin(), missing.begin(), missing.end());
  const auto attracts = [](const calibration::SeriesRun& entry) {
    return entry.run->conditions.attraction > 0.0;
  };
  if (std::ranges::any_of(runs, attracts)) report.cohesion = calibration::cohesion_series(runs);
}

void begin(report::ReportHead& report, const io::Campaign& campaign, CampaignData& data) {
  report.title = campaign.title;
  report.machine = machine();
  report.warnings = std::move(data.warnings);
  report.costs = std::move(data.costs);
}

}  // namespace

continuum::RheologyTable fit_law(const io::Campaign& campaign, const CampaignData& data) {
  if (campaign.shear_boxes.empty()) {
    return calibration::fit_mu_phi(data.fitted(), mean_points(data)).table;
  }
  std::vector<std::string> left_out;
  const auto points = calibration::state_points(boxes_of(data), left_out);
  return calibration::fit_material(points, material_options(campaign)).table;
}

report::Report evaluate(const io::Campaign& campaign,
                        CampaignData data,
                        const fs::path& directory,
                        const std::optional<Reference>& reference) {
  report::Report report;
  begin(report, campaign, data);
  const bool boxes = !campaign.shear_boxes.empty();
  {
    const StageClock clock(report, "fit");
    boxes ? fit_boxes(report, campaign, data) : fit_chutes(report, data);
  }
  if (report.material && reference) {
    report.material->reference = reference->table;
    report.material->reference_name = reference->name;
  }
  name_data(report.table.provenance, data);
  write_predictions(campaign, report.table, directory / "predictions");
  {
    const StageClock clock(report, "predictions and comparison");
    compare_chutes(report, data);
  }
  if (!boxes) {
    const StageClock clock(report, "error against averaging time");
    report.left_out = leave_one_out(data.fitted());
    report.error_against_time = error_against_time(data.fitted(), data.chutes(), report.table);
  }
  report.seeds = seed_scatter(data);
  record_checks(report.table, report.runs);
  return report;
}

report::SeriesReport evaluate_series(const io::Campaign& campaign,
                                     CampaignData data,
                                     const std::optional<Reference>& reference) {
  report::SeriesReport report;
  begin(report, campaign, data);
  const StageClock clock(report, "fit");
  study_series(report, campaign, data, reference);
  return report;
}

}  // namespace grainlaw
