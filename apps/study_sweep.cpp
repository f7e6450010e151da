#include "apps/study_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "apps/exit_code.h"
#include "apps/summary.h"
#include "calibration/bagnold_fit.h"
#include "calibration/mu_phi_fit.h"

namespace grainlaw::study {
namespace {

using dem::Estimate;

struct Measured {
  std::string quantity;
  Estimate estimate{};
  std::string failure{};
};

/// A quantity that the data of a run may not give.
void add(std::vector<Measured>& to, const std::string& name, const std::function<Estimate()>& of) {
  try {
    to.push_back({name, of(), {}});
  } catch (const calibration::FitError& error) {
    to.push_back({name, {}, error.what()});
  }
}

Estimate estimate(const calibration::FittedCoefficient& coefficient) {
  return {coefficient.value, coefficient.error};
}

/// I, phi, a and b of a chute.
std::vector<Measured> measure_chute(const dem::LocalData& data) {
  std::vector<Measured> result;
  const bool cohesive = data.conditions.attraction > 0.0;
  const auto point = [&] { return calibration::flow_point(data); };
  const auto fit = [&] { return calibration::fit_bagnold(data, {.cohesive = cohesive}).summary; };
  add(result, "I", [&] { return point().inertial_number; });
  add(result, "phi", [&] { return point().volume_fraction; });
  add(result, "a", [&] { return estimate(fit()["a"]); });
  add(result, "b", [&] { return estimate(fit()["b"]); });
  return result;
}

/// mu and phi of homogeneous shear.
std::vector<Measured> measure_box(const dem::LocalData& data) {
  if (data.rows.empty()) return {{"mu", {}, "no local data"}, {"phi", {}, "no local data"}};
  return {{"mu", data.rows.front().friction, {}}, {"phi", data.rows.front().volume_fraction, {}}};
}

std::vector<Measured> measure(const Run& run) {
  const bool chute = run.data && run.data->conditions.geometry == "chute";
  if (run.data && run.data->window.steady) {
    return chute ? measure_chute(*run.data) : measure_box(*run.data);
  }
  return {};
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Mean over the runs of a setting. Its error is that of their scatter, but not below what they
/// claim themselves: a few runs may lie close together by chance.
Estimate mean(const std::vector<Estimate>& of) {
  if (of.size() == 1) return of.front();
  std::vector<double> values;
  double claimed = 0.0;
  for (const Estimate& one : of) {
    values.push_back(one.value);
    if (std::isfinite(one.error)) claimed += one.error * one.error;
  }
  const double centre = mean(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - centre) * (value - centre);
  const auto n = static_cast<double>(values.size());
  return {centre, std::sqrt(std::max(squares / (n - 1.0) / n, claimed / (n * n)))};
}

/// What the runs of one setting gave together.
struct Outcome {
  std::string label;
  std::string failure{};
  double cpu_seconds = nan;  ///< of one run
  double wall_seconds = nan;
  double energy_residual = nan;
  std::vector<Measured> measured{};

  const Measured* find(const std::string& quantity) const {
    const auto found = std::ranges::find(measured, quantity, &Measured::quantity);
    return found == measured.end() ? nullptr : &*found;
  }
};

std::string why_unusable(const Run& run) {
  if (!run.data) return run.failure;
  return run.data->window.steady ? "" : "not steady: " + run.data->window.reason;
}

std::vector<Measured> combine(const std::vector<Run>& runs) {
  std::vector<std::vector<Measured>> all;
  for (const Run& run : runs) all.push_back(measure(run));
  std::vector<Measured> result = all.front();
  for (std::size_t k = 0; k < result.size(); ++k) {
    std::vector<Estimate> estimates;
    for (const auto& one : all) {
      if (!one[k].failure.empty()) result[k].failure = one[k].failure;
      estimates.push_back(one[k].estimate);
    }
    result[k].estimate = mean(estimates);
  }
  return result;
}

Outcome outcome_of(const std::string& label, const std::vector<Run>& runs) {
  Outcome outcome{.label = label};
  std::vector<double> cpu, wall, residual;
  for (const Run& run : runs) {
    cpu.push_back(run.cpu_seconds);
    if (outcome.failure.empty()) outcome.failure = why_unusable(run);
    if (!run.data) continue;
    wall.push_back(run.data->summary.wall_seconds);
    residual.push_back(run.data->summary.energy_residual);
  }
  outcome.cpu_seconds = mean(cpu);
  if (wall.size() == runs.size()) {
    outcome.wall_seconds = mean(wall);
    outcome.energy_residual = mean(residual);
  }
  if (outcome.failure.empty()) outcome.measured = combine(runs);
  return outcome;
}

std::vector<Outcome> run_settings(const std::vector<Setting>& settings, const Context& context) {
  std::vector<Outcome> outcomes;
  for (const Setting& setting : settings) {
    if (!setting.failure.empty()) {
      outcomes.push_back({.label = setting.label, .failure = setting.failure});
    } else {
      outcomes.push_back(outcome_of(setting.label, run_scenes(setting.scenes, context)));
    }
  }
  return outcomes;
}

Point point_of(const Outcome& outcome, const std::string& quantity) {
  Point point;
  point.quantity = quantity;
  point.series = quantity;
  point.setting = outcome.label;
  point.cost = outcome.cpu_seconds;
  point.cpu_seconds = outcome.cpu_seconds;
  point.wall_seconds = outcome.wall_seconds;
  point.failure = outcome.failure;
  return point;
}

/// |x / reference - 1| with the errors of both.
void add_error(Point& point, const Estimate& x, const Estimate& reference) {
  point.error = std::abs(x.value / reference.value - 1.0);
  point.error_bar =
      std::abs(std::hypot(x.error, x.value / reference.value * reference.error) / reference.value);
}

void add_energy(std::vector<Point>& points, const std::vector<Outcome>& outcomes) {
  for (const Outcome& outcome : outcomes) {
    Point point = point_of(outcome, "energy");
    if (std::isfinite(outcome.energy_residual)) {
      point.failure.clear();  // also a flow that is not steady has its ledger
      point.error = outcome.energy_residual;
    }
    points.push_back(point);
  }
}

void add_quantity(std::vector<Point>& points,
                  const std::vector<Outcome>& outcomes,
                  const Measured& reference) {
  for (const Outcome& outcome : outcomes) {
    if (&outcome == &outcomes.back()) break;
    Point point = point_of(outcome, reference.quantity);
    if (const Measured* measured = outcome.find(reference.quantity)) {
      point.failure = measured->failure;
      if (!point.failed()) add_error(point, measured->estimate, reference.estimate);
    }
    points.push_back(point);
  }
}

/// "t/100: mu = 0.3712 +- 0.0012, phi = ...".
std::string reference_text(const Outcome& finest) {
  std::string text = "the finest, " + finest.label;
  for (const Measured& one : finest.measured) {
    text +=
        fmt::format(", {} = {}",
                    one.quantity,
                    one.failure.empty() ? value_with_error(one.estimate.value, one.estimate.error)
                                        : "not measured");
  }
  return text + ".";
}

/// Why a value cannot be a reference; empty when it can.
std::string no_reference(const Measured& reference) {
  if (!reference.failure.empty()) return reference.failure;
  if (reference.estimate.value == 0.0) return "it is 0, the data need no such term";
  return {};
}

}  // namespace

Result compare_with_finest(const std::vector<Setting>& settings,
                           const io::StudyFile& file,
                           const Context& context) {
  const std::vector<Outcome> outcomes = run_settings(settings, context);
  const Outcome& finest = outcomes.back();
  if (!finest.failure.empty()) {
    throw NoAnswer(fmt::format("the finest setting, {}, is the reference and has no result: {}",
                               finest.label,
                               finest.failure));
  }
  Result result;
  result.reference = reference_text(finest);
  add_energy(result.points, outcomes);
  for (const Measured& reference : finest.measured) {
    const std::string missing = no_reference(reference);
    if (missing.empty()) {
      add_quantity(result.points, outcomes, reference);
    } else {
      result.remarks.push_back(fmt::format(
          "{}: {} gives nothing to compare with: {}", reference.quantity, finest.label, missing));
    }
  }
  result.remarks.emplace_back(
      "Energy: what the ledger leaves over, in parts of all dissipated energy; no reference is "
      "needed. Error bars of the others are standard errors of both runs together: a difference "
      "within two of them says nothing about the setting.");
  result.advice = advise(result.points, file.accuracy);
  return result;
}

}  // namespace grainlaw::study
