// Laws from simple to complex, fitted to the same runs: error of what they predict against the time
// of the fit, and their rank by AICc.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "apps/compare_runs.h"
#include "apps/exit_code.h"
#include "apps/io/import.h"
#include "apps/study_kinds.h"
#include "apps/study_timing.h"
#include "calibration/bagnold_fit.h"
#include "calibration/material_fit.h"
#include "calibration/model_choice.h"
#include "calibration/mu_phi_fit.h"

namespace grainlaw::study {
namespace {

using continuum::RheologyTable;
using LocalRuns = std::vector<dem::LocalData>;

struct Data {
  LocalRuns chutes;     ///< fitted
  LocalRuns boxes;      ///< fitted: homogeneous shear, for p* and Bo
  LocalRuns predicted;  ///< chutes
};

dem::LocalData read_steady(const std::filesystem::path& path) {
  dem::LocalData data = io::read_run(path).data;
  if (!data.window.steady) {
    throw io::InputError(path.string() + ": is not steady: " + data.window.reason);
  }
  return data;
}

Data read_data(const io::LawStudy& study) {
  Data data;
  for (const auto& path : study.fitted) {
    dem::LocalData run = read_steady(path);
    const std::string& geometry = run.conditions.geometry;
    if (geometry != "chute" && geometry != "simple_shear") {
      throw io::InputError(path.string() + ": a " + geometry +
                           "; laws are fitted to chutes and simple shear");
    }
    (geometry == "chute" ? data.chutes : data.boxes).push_back(std::move(run));
  }
  for (const auto& path : study.predicted) {
    data.predicted.push_back(read_steady(path));
    if (data.predicted.back().conditions.geometry != "chute") {
      throw io::InputError(path.string() + ": is no chute, which is what is predicted");
    }
  }
  if (data.chutes.empty()) {
    throw io::InputError("the fitted runs have no chute: it gives the no-slip height of the base");
  }
  return data;
}

/// A fitted law: the table to use for a chute.
struct FittedLaw {
  std::function<const RheologyTable&(const dem::ChuteConditions&)> table_for;
  int coefficients = 0;
};

/// A law that can be fitted; throws FitError where the runs do not allow it.
struct Law {
  std::string name;
  std::function<FittedLaw(const Data&)> fit;
};

/// Those that were fitted; the mass below the no-slip height follows from the height.
int fitted_coefficients(const RheologyTable& table) {
  const auto names = table.covariance ? table.covariance->names : coefficient_names(table);
  return static_cast<int>(names.size() - std::ranges::count(names, "mass_below"));
}

FittedLaw one_for_all(RheologyTable table) {
  const int coefficients = fitted_coefficients(table);
  const auto shared = std::make_shared<RheologyTable>(std::move(table));
  return {[shared](const dem::ChuteConditions&) -> const RheologyTable& { return *shared; },
          coefficients};
}

/// Closure A belongs to a tilt: that of the nearest fitted run is used.
template <class Fit>
FittedLaw one_per_tilt(const Data& data, int coefficients, const Fit& fit) {
  const auto tables = std::make_shared<std::vector<std::pair<double, RheologyTable>>>();
  for (const dem::LocalData& run : data.chutes) {
    tables->emplace_back(run.conditions.inclination, fit(run));
  }
  return {[tables](const dem::ChuteConditions& chute) -> const RheologyTable& {
            return std::ranges::min_element(
                       *tables,
                       {},
                       [&](const auto& table) { return std::abs(table.first - chute.inclination); })
                ->second;
          },
          coefficients* static_cast<int>(data.chutes.size())};
}

/// tau = a gd^2 with mu = tau/p and I = gd d sqrt(rho_p/p) of the run: a = mu rho_p d^2 / I^2.
RheologyTable bagnold_table(const dem::LocalData& run) {
  const calibration::FlowPoint point = calibration::flow_point(run);
  const double I = point.inertial_number.value;
  RheologyTable table;
  table.law =
      continuum::GeneralisedBagnold{.a = point.friction.value * run.conditions.grain_density *
                                         std::pow(run.conditions.grain_diameter / I, 2),
                                    .volume_fraction = point.volume_fraction.value,
                                    .inclination = run.conditions.inclination};
  table.base = continuum::EffectiveBase{.no_slip_height = point.no_slip_height.value,
                                        .mass_below = point.mass_below.value};
  return table;
}

RheologyTable generalised_table(const dem::LocalData& run) {
  return calibration::fit_bagnold(run, {.cohesive = run.conditions.attraction > 0.0}).table;
}

calibration::StatePoint chute_state(const dem::LocalData& run) {
  const calibration::FlowPoint point = calibration::flow_point(run);
  const dem::ChuteConditions& grains = run.conditions;
  const double softness = 0.5 * (point.softness_lower + point.softness_upper);
  calibration::StatePoint state;
  state.name = run.name;
  state.inertial_number = point.inertial_number;
  state.friction = calibration::friction_for_fit(point);
  if (!(state.friction.error > 0.0)) state.friction.error = point.friction.error;
  state.volume_fraction = point.volume_fraction;
  state.softness = {softness, 0.0};
  // Bo = f_a / (p d^2) at the p of that softness, p* = p d / k_n.
  state.bond_number = {
      softness > 0.0 ? grains.attraction / (softness * grains.stiffness * grains.grain_diameter)
                     : 0.0,
      0.0};
  return state;
}

calibration::StatePoint box_state(const dem::LocalData& run) {
  const dem::LocalRow& row = run.rows.front();
  const dem::ChuteConditions& grains = run.conditions;
  calibration::StatePoint state;
  state.name = run.name;
  state.inertial_number = row.inertial_number;
  state.friction = row.friction;
  state.volume_fraction = row.volume_fraction;
  state.softness = row.softness;
  const double d = grains.grain_diameter;
  state.bond_number = {grains.attraction / (row.normal_stress.value * d * d), 0.0};
  return state;
}

/// mu(I, p*) or mu(I, p*, Bo), where the runs can tell these terms.
RheologyTable material_table(const Data& data, bool cohesion) {
  std::vector<calibration::StatePoint> states;
  for (const dem::LocalData& run : data.chutes) states.push_back(chute_state(run));
  for (const dem::LocalData& run : data.boxes) states.push_back(box_state(run));
  if (!cohesion) {
    for (calibration::StatePoint& state : states) state.bond_number = {0.0, 0.0};
  }
  const auto fit = calibration::fit_material(
      states,
      {.range = {},
       .contact_friction = data.chutes.front().conditions.contact_friction,
       .cohesion = cohesion ? "largest attraction" : ""});
  const auto& law = std::get<continuum::MuPhi>(fit.table.law);
  const bool told =
      cohesion ? law.cohesion_friction || law.cohesion_stress : law.softness_friction.has_value();
  if (!told) {
    throw calibration::FitError(
        fmt::format("the runs do not tell a term in {} from none", cohesion ? "Bo" : "p*"));
  }
  RheologyTable table = fit.table;
  table.base = calibration::fit_mu_phi(data.chutes).table.base;
  return table;
}

std::vector<Law> laws() {
  return {
      {"Bagnold", [](const Data& data) { return one_per_tilt(data, 2, bagnold_table); }},
      {"generalised Bagnold",
       [](const Data& data) { return one_per_tilt(data, 3, generalised_table); }},
      {"mu(I)",
       [](const Data& data) { return one_for_all(calibration::fit_mu_phi(data.chutes).table); }},
      {"mu(I) + p*", [](const Data& data) { return one_for_all(material_table(data, false)); }},
      {"mu(I) + p* + Bo",
       [](const Data& data) { return one_for_all(material_table(data, true)); }}};
}

continuum::SteadyChute predict(const FittedLaw& law, const dem::LocalData& run) {
  return continuum::steady_chute(law.table_for(run.conditions), chute_case(run.conditions));
}

/// How well a law gives back the velocities it was fitted to.
struct Score {
  double chi_squared = 0.0;
  int data = 0;
};

/// Rows are correlated over the width of the kernel, so every second one counts, or every one of
/// data without a kernel; the surface, where grains are few, does not.
Score score(const FittedLaw& law, const LocalRuns& chutes) {
  constexpr double dense = 0.5;
  Score score;
  for (const dem::LocalData& run : chutes) {
    const auto steady = predict(law, run);
    const std::size_t stride = run.fields.empty() ? 1 : 2;
    for (std::size_t k = 0; k < run.rows.size(); k += stride) {
      const dem::LocalRow& row = run.rows[k];
      if (row.z < 0.0 || row.volume_fraction.value < dense || !(row.velocity.error > 0.0)) continue;
      const double there =
          steady.profile.rows.empty() ? 0.0 : calibration::velocity_at(steady.profile, row.z);
      score.chi_squared += std::pow((there - row.velocity.value) / row.velocity.error, 2);
      ++score.data;
    }
  }
  return score;
}

Point prediction(const Law& law, const dem::LocalData& run, const std::string& quantity) {
  Point point;
  point.quantity = point.series = quantity + " of " + run.name;
  point.setting = law.name;
  return point;
}

void add_predictions(
    Result& result, const Law& law, const FittedLaw& fitted, const Data& data, Seconds seconds) {
  for (const dem::LocalData& run : data.predicted) {
    Point point = prediction(law, run, "velocity");
    point.cost = point.cpu_seconds = seconds.cpu;
    point.wall_seconds = seconds.wall;
    const auto steady = predict(fitted, run);
    if (steady.profile.rows.empty()) {
      point.failure = steady.answer.text;
    } else {
      const dem::Estimate error = calibration::profile_error(run, steady.profile).velocity;
      point.error = error.value;
      point.error_bar = error.error;
    }
    result.points.push_back(point);
  }
}

std::string rank_text(const calibration::ModelScore& one, double least) {
  return fmt::format(
      "{} ({}, {} coefficients)",
      one.name,
      std::isfinite(one.aicc) ? fmt::format("{:+.1f}", one.aicc - least) : "too few data to tell",
      one.coefficients);
}

std::string ranking(std::vector<calibration::ModelScore> scores) {
  std::ranges::stable_sort(scores, {}, &calibration::ModelScore::aicc);
  std::string text;
  for (const calibration::ModelScore& one : scores) {
    text += (text.empty() ? "" : ", ") + rank_text(one, scores.front().aicc);
  }
  return "By AICc on the velocities of the fitted runs: " + text + ".";
}

}  // namespace

Plan plan(const io::LawStudy& study) {
  const Data data = read_data(study);
  return {.scenes = {},
          .other = {fmt::format("{} laws fitted to {} chutes and {} boxes, predicting {} chutes",
                                laws().size(),
                                data.chutes.size(),
                                data.boxes.size(),
                                data.predicted.size())}};
}

Result run(const io::LawStudy& study, const io::StudyFile& file, const Context&) {
  const Data data = read_data(study);
  Result result;
  std::vector<calibration::ModelScore> scores;
  for (const Law& law : laws()) {
    try {
      FittedLaw fitted;
      const Seconds seconds = median_seconds(file.repeats, [&] { fitted = law.fit(data); });
      add_predictions(result, law, fitted, data, seconds);
      const Score in_sample = score(fitted, data.chutes);
      scores.push_back({.name = law.name,
                        .coefficients = fitted.coefficients,
                        .chi_squared = in_sample.chi_squared,
                        .aicc = calibration::corrected_akaike(
                            in_sample.chi_squared, in_sample.data, fitted.coefficients)});
    } catch (const calibration::FitError& error) {
      for (const dem::LocalData& run : data.predicted) {
        result.points.push_back(prediction(law, run, "velocity"));
        result.points.back().failure = error.what();
      }
    }
  }
  if (scores.empty()) throw NoAnswer("no law could be fitted to these runs");
  result.reference = "the DEM profiles of the predicted runs, which no law was fitted to.";
  result.cost_label = "CPU time of the fit [s]";
  result.error_label = "velocity error, relative L_2";
  result.remarks.push_back(ranking(scores));
  result.remarks.emplace_back(
      "Laws of Bagnold belong to a tilt: the nearest fitted one is used. AICc compares in sample "
      "and "
      "counts every second row where a kernel smooths; error bars are the noise of the predicted "
      "runs.");
  result.advice = advise(result.points, file.accuracy);
  return result;
}

}  // namespace grainlaw::study
