#include "apps/compare_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "continuum/sampled_band.h"

namespace grainlaw {
namespace {

calibration::BagnoldFit fit_own_bagnold(const dem::LocalData& data) {
  return calibration::fit_bagnold(data, {.cohesive = data.conditions.attraction > 0.0});
}

using std::chrono::duration;
using std::chrono::steady_clock;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double seconds_since(steady_clock::time_point start) {
  return duration<double>(steady_clock::now() - start).count();
}

bool has_profile(const continuum::SteadyChute& steady) {
  return !steady.profile.rows.empty();
}

/// The tilts that follow the first as the continuum takes them, with snapshots in the middle of the
/// frames; of a steady flow at one tilt, begun in motion, the start from rest alone.
continuum::TransientOptions history_of(const dem::LocalData& data) {
  continuum::TransientOptions options;
  const std::vector<dem::TiltStep> tilts = calibration::tilts_of(data);
  if (!data.frames.from_rest && tilts.size() == 1) return options;
  if (!data.frames.from_rest) options.inclination_before = tilts.front().inclination;
  for (std::size_t k = 1; k < tilts.size(); ++k)
    options.tilts.push_back({tilts[k].time, tilts[k].inclination});
  for (const dem::ProfileFrame& frame : data.frames.frames)
    options.output_times.push_back(0.5 * (frame.begin + frame.end));
  return options;
}

const dem::LocalData* nearest_tilt(std::span<const dem::LocalData> runs, double inclination) {
  const auto distance = [&](const dem::LocalData& run) {
    return std::abs(run.conditions.inclination - inclination);
  };
  const auto best = std::min_element(runs.begin(), runs.end(), [&](const auto& a, const auto& b) {
    return distance(a) < distance(b);
  });
  return best == runs.end() ? nullptr : &*best;
}

std::vector<double> tilts(std::span<const dem::LocalData> runs) {
  std::vector<double> values;
  for (const dem::LocalData& run : runs) values.push_back(run.conditions.inclination);
  return values;
}

bool is_chute(const dem::LocalData& run) {
  return run.conditions.geometry == dem::ChuteConditions{}.geometry;
}

/// Flows of another geometry have no tilt to lie between.
calibration::SampleKind kind_of(const dem::LocalData& data,
                                const continuum::RheologyTable& table,
                                std::span<const dem::LocalData> fitted) {
  const std::string& geometry =
      fitted.empty() ? table.provenance.geometry : fitted.front().conditions.geometry;
  if (!geometry.empty() && geometry != data.conditions.geometry) {
    return calibration::SampleKind::cross_geometry;
  }
  return calibration::sample_kind(data.conditions.inclination, tilts(fitted));
}

std::optional<calibration::ProfileError> error_of(const dem::LocalData& data,
                                                  const continuum::SteadyChute& steady) {
  if (!data.window.steady || !has_profile(steady)) return std::nullopt;
  return calibration::profile_error(data, steady.profile);
}

void add_naive_guess(report::RunComparison& run, const dem::LocalData& nearest) {
  run.naive_source = nearest.name;
  run.naive_error =
      calibration::profile_error(run.data, calibration::naive_guess(nearest, run.data.conditions));
}

/// A fit that the data of a run may not allow: absent then, and noted.
template <class Fit>
auto fit_or_note(report::RunComparison& run, const Fit& fit) -> std::optional<decltype(fit())> {
  try {
    return fit();
  } catch (const calibration::FitError& error) {
    const std::string note = error.what();
    if (std::ranges::find(run.notes, note) == run.notes.end()) run.notes.push_back(note);
    return std::nullopt;
  }
}

/// Closure A: fitted to this run (its own tilt), and taken from the nearest fitted tilt.
void add_bagnold(report::RunComparison& run, std::span<const dem::LocalData> fitted) {
  const continuum::ChuteCase chute = chute_case(run.data.conditions);
  run.own_bagnold = fit_or_note(run, [&] { return fit_own_bagnold(run.data); });
  if (run.own_bagnold) {
    run.own_bagnold_error =
        error_of(run.data, continuum::steady_chute(run.own_bagnold->table, chute));
  }
  std::vector<dem::LocalData> others;
  for (const dem::LocalData& other : fitted) {
    if (is_chute(other) && other.conditions.inclination != run.data.conditions.inclination)
      others.push_back(other);
  }
  const dem::LocalData* other = nearest_tilt(others, run.data.conditions.inclination);
  if (other == nullptr) return;
  const auto foreign = fit_or_note(run, [&] { return fit_own_bagnold(*other); });
  if (!foreign) return;
  run.foreign_bagnold_source = other->name;
  run.foreign_bagnold_error = error_of(run.data, continuum::steady_chute(foreign->table, chute));
}

/// The table with the no-slip height that the run itself shows.
continuum::RheologyTable with_own_base(continuum::RheologyTable table,
                                       const calibration::FlowPoint& point) {
  table.base = calibration::effective_base(point);
  table.covariance.reset();
  return table;
}

/// The same chute with what the table cannot know of it taken from the run: the no-slip height, or,
/// when the table comes from another geometry, the whole law (closure A of this very run).
continuum::Profile informed(const report::RunComparison& run,
                            const continuum::RheologyTable& table) {
  const continuum::ChuteCase chute = chute_case(run.data.conditions);
  const bool foreign = run.kind == calibration::SampleKind::cross_geometry;
  if (foreign && run.own_bagnold) {
    return continuum::steady_chute(run.own_bagnold->table, chute).profile;
  }
  if (!run.point || !(run.point->mass_below.value >= 0.0)) return {};
  return continuum::steady_chute(with_own_base(table, *run.point), chute).profile;
}

void add_budget(report::RunComparison& run, const continuum::RheologyTable& table) {
  if (!run.error) return;
  run.budget.total = run.error->velocity.value;
  run.budget.statistics = run.error->statistics;
  run.budget.law = run.error->law;
  run.budget.numerics = run.steady_against_transient;
  const continuum::Profile other = informed(run, table);
  if (other.rows.empty()) return;
  run.budget.geometry = calibration::velocity_distance(run.data, run.steady.profile, other);
}

/// A table says for which grains and which base it holds.
void note_mismatch(report::RunComparison& run, const continuum::RheologyTable& table) {
  const dem::ChuteConditions& grains = run.data.conditions;
  if (grains.contact_friction != table.contact_friction) {
    run.notes.push_back(
        fmt::format("{}: contact friction {} of the grains, {} of the table: the law "
                    "is not that of these grains",
                    run.data.name,
                    grains.contact_friction,
                    table.contact_friction));
  }
  if (table.base && table.base->recipe != grains.base) {
    run.notes.push_back(
        fmt::format("{}: the no-slip height of the table was measured on another "
                    "base ({}; here: {})",
                    run.data.name,
                    table.base->recipe,
                    grains.base));
  }
  for (const continuum::RangeFlag& flag : run.steady.answer.out_of_domain) {
    if (flag.quantity != "inclination") continue;
    run.notes.push_back(run.data.name +
                        ": a closure (A) table holds at its own tilt only, this is another");
  }
}

/// Largest difference of a profile from the steady quadrature, over the surface velocity.
double solver_difference(const continuum::RheologyTable& table,
                         const continuum::ChuteCase& chute,
                         const continuum::Profile& profile) {
  // Many rows: the comparison shall see the solvers, not the interpolation between rows.
  const continuum::Profile steady = continuum::steady_chute(table, chute, {.rows = 4001}).profile;
  double largest = 0.0;
  for (const continuum::ProfileRow& row : profile.rows) {
    const double difference = calibration::velocity_at(steady, row.z) - row.velocity;
    largest = std::max(largest, std::abs(difference) / steady.surface_velocity);
  }
  return largest;
}

/// The same run as if it had been stopped after a share of its averaging time.
dem::LocalData shortened(const dem::LocalData& data, double share) {
  dem::LocalData part = data;
  part.window.end = data.window.begin + share * (data.window.end - data.window.begin);
  part.rows = dem::average(part.frames, part.conditions, part.window);
  return part;
}

double wall_seconds(const dem::LocalData& data, double share) {
  const dem::RunSummary& run = data.summary;
  return run.startup_wall_seconds + share * (run.wall_seconds - run.startup_wall_seconds);
}

/// I of the steady flow at a tilt, for rigid grains: the inverse of mu(I) = tan(theta).
double inertial_number(const continuum::RheologyTable& table, double inclination) {
  const auto& law = std::get<continuum::MuPhi>(table.law).friction;
  const double excess = std::tan(inclination) - law.mu0;
  return excess / (law.beta - law.kappa * excess);
}

double standard_error_of_I(const calibration::MuPhiFit& fit, double inclination) {
  const dem::Estimate I = calibration::propagated(
      fit.table,
      [&](const continuum::RheologyTable& table) { return inertial_number(table, inclination); });
  return I.error / I.value;
}

void add_errors(report::TimeErrorPoint& point,
                const calibration::MuPhiFit& fit,
                const continuum::RheologyTable& final_table,
                std::span<const dem::LocalData> fitted,
                std::span<const dem::LocalData> all) {
  for (const double theta : tilts(fitted)) {
    const double reference = inertial_number(final_table, theta);
    const double error = std::abs(inertial_number(fit.table, theta) / reference - 1.0);
    if (error < point.law_error) continue;
    point.law_error = error;
    point.law_standard_error = standard_error_of_I(fit, theta);
  }
  point.mu0 = {fit.friction["mu0"].value, fit.friction["mu0"].error};
  for (const dem::LocalData& run : all) {
    const auto steady = continuum::steady_chute(fit.table, chute_case(run.conditions));
    const auto error = error_of(run, steady);
    point.profile_error.push_back(error ? error->velocity.value : nan);
    point.profile_standard_error.push_back(error ? error->velocity.error : nan);
  }
}

}  // namespace

bool same_grains(const dem::ChuteConditions& a, const dem::ChuteConditions& b) {
  return a.grain_diameter == b.grain_diameter && a.grain_density == b.grain_density &&
         a.stiffness == b.stiffness && a.contact_friction == b.contact_friction &&
         a.attraction == b.attraction && a.base == b.base;
}

Prediction predict_chute(const continuum::RheologyTable& table, const dem::LocalData& data) {
  const auto start = steady_clock::now();
  const continuum::ChuteCase chute = chute_case(data.conditions);
  const continuum::TransientOptions history = history_of(data);
  Prediction prediction;
  prediction.steady = continuum::steady_chute(table, chute);
  const bool flows = has_profile(prediction.steady);
  if (flows) continuum::add_error_band(prediction.steady, table, chute);
  continuum::ChuteCase first = chute;
  first.inclination = calibration::tilts_of(data).front().inclination;
  const bool begins =
      !history.inclination_before || has_profile(continuum::steady_chute(table, first));
  if (begins && (flows || !history.tilts.empty()))
    prediction.transient = continuum::transient_chute(table, first, history);
  if (flows && prediction.transient) {
    prediction.steady_against_transient =
        solver_difference(table, chute, prediction.transient->final_profile);
  }
  prediction.wall_seconds = seconds_since(start);
  return prediction;
}

/// The band shown is that of linear propagation; where draws of the coefficients say another.
void note_band(report::RunComparison& run, const continuum::RheologyTable& table) {
  const auto band =
      continuum::sample_error_band(run.steady, table, chute_case(run.data.conditions));
  if (band && !band->agrees) run.notes.push_back(run.data.name + ", band: " + band->text);
}

report::RunComparison compare_run(const dem::LocalData& data,
                                  const continuum::RheologyTable& table,
                                  std::span<const dem::LocalData> fitted) {
  report::RunComparison run;
  run.data = data;
  run.kind = kind_of(data, table, fitted);
  Prediction prediction = predict_chute(table, data);
  run.steady = std::move(prediction.steady);
  run.transient = std::move(prediction.transient);
  run.steady_against_transient = prediction.steady_against_transient;
  run.predict_seconds = prediction.wall_seconds;
  note_mismatch(run, table);
  note_band(run, table);
  run.error = error_of(data, run.steady);
  if (run.transient) run.in_time = calibration::compare_in_time(data, *run.transient);
  if (!data.window.steady) return run;
  const bool predicted = run.kind == calibration::SampleKind::interpolation ||
                         run.kind == calibration::SampleKind::extrapolation;
  if (predicted) {
    if (const dem::LocalData* near = nearest_tilt(fitted, data.conditions.inclination)) {
      add_naive_guess(run, *near);
    }
  }
  run.point = fit_or_note(run, [&] { return calibration::flow_point(data); });
  add_bagnold(run, fitted);
  add_budget(run, table);
  return run;
}

std::vector<report::RunComparison> leave_one_out(std::span<const dem::LocalData> fitted) {
  std::vector<report::RunComparison> result;
  for (const dem::LocalData& run : fitted) {
    std::vector<dem::LocalData> others;
    for (const dem::LocalData& other : fitted) {
      if (other.conditions.inclination != run.conditions.inclination) others.push_back(other);
    }
    if (others.size() < 2) continue;
    try {
      const continuum::RheologyTable table = calibration::fit_mu_phi(others).table;
      result.push_back(compare_run(run, table, others));
      result.back().kind = calibration::SampleKind::leave_one_out;
    } catch (const calibration::FitError&) {
      continue;  // two tilts alone may not fix a law; the scores then lack this run
    }
  }
  return result;
}

std::vector<report::TimeErrorPoint> error_against_time(
    std::span<const dem::LocalData> fitted,
    std::span<const dem::LocalData> all,
    const continuum::RheologyTable& final_table) {
  std::vector<report::TimeErrorPoint> points;
  const auto averages_only = [](const dem::LocalData& run) { return run.frames.frames.empty(); };
  if (!std::ranges::all_of(fitted, is_chute)) return points;      // tilts are asked
  if (std::ranges::any_of(fitted, averages_only)) return points;  // no shorter time to average over
  for (const double share : {1.0 / 16, 1.0 / 8, 1.0 / 4, 1.0 / 2, 1.0}) {
    report::TimeErrorPoint point;
    std::vector<dem::LocalData> part;
    for (const dem::LocalData& run : fitted) {
      part.push_back(shortened(run, share));
      point.averaging_time +=
          (part.back().window.end - part.back().window.begin) / static_cast<double>(fitted.size());
      point.dem_wall_seconds += wall_seconds(run, share);
    }
    try {
      add_errors(point, calibration::fit_mu_phi(part), final_table, fitted, all);
    } catch (const calibration::FitError& error) {
      point.failure = error.what();
    }
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace grainlaw
