// The continuum solver, which integrates from rest to steady flow, against the steady quadrature.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "apps/exit_code.h"
#include "apps/io/case_input.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/study_kinds.h"
#include "apps/study_timing.h"
#include "calibration/comparison.h"
#include "continuum/chute_1d.h"
#include "continuum/layer.h"
#include "continuum/transient_segment.h"

namespace grainlaw::study {
namespace {

constexpr int most_panels = 32;       // of the quadrature as a method
constexpr int reference_panels = 64;  // and as the reference
constexpr int reference_rows = 20001;

struct Problem {
  continuum::ChuteCase chute;
  continuum::RheologyTable table;
  continuum::TransientOptions transient;
  continuum::Profile reference;
};

Problem read_problem(const io::SolverStudy& study) {
  const io::CaseFile file = io::read_case(study.question);
  if (!file.is_chute() || file.depth || file.mass_flow || file.tilt_sought || file.sweep) {
    throw io::InputError(io::case_message(
        file,
        "",
        "",
        "this study takes one chute with its inclination and mass_per_area, no sweep"));
  }
  Problem problem{.chute = file.chute,
                  .table = io::in_grain_units(io::read_table(study.table), file.units),
                  .transient = file.transient,
                  .reference = {}};
  continuum::validate(problem.table);
  const auto steady = continuum::steady_chute(
      problem.table, problem.chute, {.panels = reference_panels, .rows = reference_rows});
  if (!continuum::flows(steady.answer.outcome)) {
    throw NoAnswer("no steady flow to compare with: " + steady.answer.text);
  }
  problem.reference = steady.profile;
  return problem;
}

/// Largest difference of the velocity over the largest velocity.
double error_of(const continuum::Profile& profile, const continuum::Profile& reference) {
  double largest = 0.0;
  for (const continuum::ProfileRow& row : profile.rows) {
    const double there = calibration::velocity_at(reference, row.z);
    largest = std::max(largest, std::abs(row.velocity - there));
  }
  return largest / std::abs(reference.surface_velocity);
}

Point new_point(const std::string& quantity,
                const std::string& series,
                int size,
                const std::string& of) {
  Point point;
  point.quantity = quantity;
  point.series = series;
  point.setting = fmt::format("{} {}", size, of);
  point.mark = fmt::format("{}", size);
  return point;
}

void add_time(Point& point, const Seconds& seconds) {
  point.cost = point.cpu_seconds = seconds.cpu;
  point.wall_seconds = seconds.wall;
}

Point quadrature(const Problem& problem, int panels, int repeats) {
  Point point =
      new_point("steady velocity", "quadrature", panels, panels == 1 ? "panel" : "panels");
  // Two rows: every interval between rows takes a panel of its own at least.
  const continuum::SteadyOptions options{.panels = panels, .rows = 2};
  continuum::Profile profile;
  add_time(point, median_seconds(repeats, [&] {
             profile = continuum::steady_chute(problem.table, problem.chute, options).profile;
           }));
  point.error = std::abs(profile.surface_velocity / problem.reference.surface_velocity - 1.0);
  return point;
}

/// How the solver treats yield (continuum/chute_1d.h, transient_chute).
std::string treatment(const Problem& problem, double delta) {
  if (delta > 0.0) return fmt::format("delta {:.0e}", delta);
  const bool plug =
      continuum::may_rest_in_part(continuum::make_layer(problem.table, problem.chute));
  return plug ? "exact yield" : "scaled rate";
}

Point transient(const Problem& problem, double cells, double tolerance, double delta, int repeats) {
  Point point = new_point("velocity in time",
                          fmt::format("{}, rtol {:.0e}", treatment(problem, delta), tolerance),
                          static_cast<int>(cells),
                          "cells");
  continuum::TransientOptions options = problem.transient;
  options.cells = static_cast<int>(cells);
  options.relative_tolerance = tolerance;
  options.yield_regularisation = delta;
  continuum::TransientChute end;
  try {
    add_time(point, median_seconds(repeats, [&] {
               end = continuum::start_from_rest(problem.table, problem.chute, options);
             }));
  } catch (const std::invalid_argument& error) {  // a delta the tolerance does not resolve
    point.failure = error.what();
    return point;
  } catch (const continuum::SolverError& error) {
    point.failure = error.what();
    return point;
  }
  if (continuum::flows(end.answer.outcome)) {
    point.error = error_of(end.final_profile, problem.reference);
  } else {
    point.failure = fmt::format("{}: {}", name(end.answer.outcome), end.answer.text);
  }
  return point;
}

}  // namespace

Plan plan(const io::SolverStudy& study) {
  read_problem(study);
  const std::size_t runs =
      study.cells.size() * study.tolerances.size() * (1 + study.regularisations.size());
  return {.scenes = {}, .other = {fmt::format("{} starts from rest, some seconds", runs)}};
}

Result run(const io::SolverStudy& study, const io::StudyFile& file, const Context&) {
  const Problem problem = read_problem(study);
  Result result;
  for (int panels = 1; panels <= most_panels; panels *= 2) {
    result.points.push_back(quadrature(problem, panels, file.repeats));
  }
  std::vector<double> deltas = {0.0};
  deltas.insert(deltas.end(), study.regularisations.begin(), study.regularisations.end());
  for (const double delta : deltas) {
    for (const double tolerance : study.tolerances) {
      for (const double cells : study.cells) {
        result.points.push_back(transient(problem, cells, tolerance, delta, file.repeats));
      }
    }
  }
  result.reference = fmt::format(
      "the steady quadrature with {} panels, which knows nothing of the time integration.",
      reference_panels);
  result.error_label = "largest velocity error / surface velocity";
  result.remarks.emplace_back(
      "Quadrature: the surface velocity, at rounding mostly and then not in the figure. The "
      "others: CVODE from rest until steady, the largest "
      "error of the profile. Exact yield: velocity and stress are the state, as part of the layer "
      "may "
      "rest. Scaled rate: the shear rate is, as none can. Delta: the yield stress is smeared over "
      "shear rates of that size (Bercovier and Engelman 1980).");
  result.advice = advise(result.points, file.accuracy);
  return result;
}

}  // namespace grainlaw::study
