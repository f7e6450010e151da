#include "continuum/shear_band.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "continuum/layer.h"
#include "continuum/range_flags.h"
#include "continuum/shear_band_profile.h"

namespace grainlaw::continuum {
namespace {

const WallDrive* drive_of(const BandProblem& problem) {
  if (const auto* shear = std::get_if<PlaneShear>(&problem.flow)) return &shear->drive;
  if (const auto* annulus = std::get_if<AnnularShear>(&problem.flow)) return &annulus->drive;
  return nullptr;
}

ShearBand::Sought sought(const BandProblem& problem) {
  const WallDrive* drive = drive_of(problem);
  return drive != nullptr && drive->velocity ? ShearBand::Sought::stress
                                             : ShearBand::Sought::velocity;
}

struct Solution {
  BandState state;
  double stress = 0.0;  ///< on the moving wall
};

/// Interval of wall stresses whose velocities bracket a given one.
struct Bracket {
  Solution low;
  Solution high;
};

bool exists(const Solution& solution) {
  return solution.state.failure == BandFailure::none;
}

/// Doubles the step above the yield stress until the velocity is passed or no state is left.
template <class At>
Bracket bracket(At at, double yield, double velocity) {
  Bracket found{.low = {.state = {}, .stress = yield}, .high = {}};
  double step = 1e-6 * (yield > 0.0 ? yield : 1.0);
  for (;; step *= 2.0) {
    found.high = at(found.low.stress + step);
    if (!exists(found.high) || found.high.state.velocity >= velocity) return found;
    found.low = std::move(found.high);
  }
}

/// Stress at which the wall moves at `velocity`, which grows with it: false position with the
/// Illinois rule, bisection where the upper end has no state. Without a solution the state returned
/// says why.
Solution at_velocity(const BandProblem& problem, double velocity, int cells) {
  const auto at = [&](double stress) {
    return Solution{band_state(problem, stress, cells), stress};
  };
  auto [low, high] = bracket(at, std::max(wall_yield_stress(problem), 0.0), velocity);
  double below = low.state.velocity - velocity;
  double above = high.state.velocity - velocity;
  int kept = 0;  // times in a row that the lower end stayed (negative), or the upper one
  for (int k = 0; k < 200; ++k) {
    const double share = exists(high) ? below / (below - above) : 0.5;
    const double stress = low.stress + share * (high.stress - low.stress);
    if (stress <= low.stress || stress >= high.stress) break;
    Solution middle = at(stress);
    const double excess = middle.state.velocity - velocity;
    if (exists(middle) && std::abs(excess) <= 1e-12 * velocity) return middle;
    if (!exists(middle) || excess > 0.0) {
      high = std::move(middle);
      above = excess;
      kept = std::min(kept, 0) - 1;
      if (kept < -1) below *= 0.5;
    } else {
      low = std::move(middle);
      below = excess;
      kept = std::max(kept, 0) + 1;
      if (kept > 1) above *= 0.5;
    }
  }
  if (exists(high) && high.state.velocity > (1.0 + 1e-6) * velocity) {
    high.state.failure = BandFailure::not_converged;
    high.state.text = fmt::format(
        "the velocity jumps over the one asked at tau = {:.6g} rho_p d^2 / time^2", high.stress);
  }
  return high;
}

Solution solve(const BandProblem& problem, int cells) {
  const WallDrive* drive = drive_of(problem);
  if (drive != nullptr && drive->velocity) return at_velocity(problem, *drive->velocity, cells);
  const double stress = drive != nullptr ? *drive->stress : 0.0;
  return {band_state(problem, stress, cells), stress};
}

/// Relative difference from the solution on half the cells, a third of which is the error of a
/// second-order scheme: of the velocity where the stress is given, else of the stress.
double error_of(const BandProblem& problem, const Solution& fine, int cells) {
  const Solution coarse = solve(problem, cells / 2);
  const bool stress_sought = sought(problem) == ShearBand::Sought::stress;
  const double a = stress_sought ? fine.stress : fine.state.velocity;
  const double b = stress_sought ? coarse.stress : coarse.state.velocity;
  return std::abs(a - b) / (3.0 * a);
}

/// Doubles the cells until the error is small enough.
Solution refine(const BandProblem& problem, const ShearBandOptions& options, ShearBand& result) {
  for (result.cells = options.cells;; result.cells *= 2) {
    Solution found = solve(problem, result.cells);
    if (!found.state.flows()) return found;
    result.discretisation_error = error_of(problem, found, result.cells);
    if (result.discretisation_error <= options.discretisation ||
        2 * result.cells > options.most_cells)
      return found;
  }
}

Outcome outcome_of(BandFailure failure) {
  switch (failure) {
    case BandFailure::no_steady:
      return Outcome::no_steady;
    case BandFailure::no_dense_state:
      return Outcome::no_dense_state;
    default:
      return Outcome::not_converged;
  }
}

/// Softness or cohesion change the thresholds of the nonlocal law.
bool experimental(const BandProblem& problem) {
  return problem.amplitude > 0.0 &&
         ((problem.law.softness_friction && problem.grains.stiffness) ||
          (problem.law.cohesion_friction && problem.grains.adhesion.value_or(0.0) > 0.0));
}

std::string band_text(const BandProblem& problem, const BandState& state, double width) {
  const BandCell& wall = state.wall;
  const bool box = std::holds_alternative<BodyForceBox>(problem.flow);
  std::string text = fmt::format(
      "tau / p = {:.5g} {}, above the yield friction {:.5g}; I = {:.4g} there; 90 % of the "
      "velocity within {:.3g} d",
      wall.shear_stress / wall.pressure,
      box ? "where the force vanishes" : "on the moving wall",
      problem.curve(wall.pressure).yield_stress / wall.pressure,
      wall.inertial_number(),
      width);
  if (problem.amplitude > 0.0)
    text += fmt::format("; nonlocal with A = {:.4g}, the flowing one of its two solutions",
                        problem.amplitude);
  if (experimental(problem))
    text += "; experimental: mu_s and mu_2 times f_p f_B in the nonlocal law";
  return text;
}

std::string rest_text(const BandProblem& problem, const BandState& state) {
  const double mu = state.wall.shear_stress / state.wall.pressure;
  const double yield = problem.curve(state.wall.pressure).yield_stress / state.wall.pressure;
  if (mu > yield)
    return fmt::format(
        "tau / p = {:.5g} exceeds the yield friction {:.5g}, but over too little thickness for a "
        "flow with A = {:.4g}: only rest solves the nonlocal law",
        mu,
        yield,
        problem.amplitude);
  return fmt::format(
      "tau / p = {:.5g} is nowhere above the yield friction {:.5g}: the material rests", mu, yield);
}

/// d ln I / d ln mu of the law at the largest stress; without meaning where the speed is given.
double condition_number(const BandProblem& problem, const BandState& state) {
  if (sought(problem) == ShearBand::Sought::stress) return 0.0;
  const FlowCurve curve = problem.curve(state.wall.pressure);
  const double tau = state.wall.shear_stress;
  const double excess = tau - curve.yield_stress;
  if (excess <= 0.0) return 0.0;
  return tau / excess * curve.linear / (curve.linear - curve.kappa * excess);
}

void describe(const BandProblem& problem,
              const RheologyTable& table,
              const Solution& found,
              const ShearBandOptions& options,
              ShearBand& result) {
  const BandState& state = found.state;
  result.profile = profile_of(problem, state, options.rows);
  const double sides = std::holds_alternative<BodyForceBox>(problem.flow) ? 2.0 : 1.0;
  result.band_width = sides * width_of(problem, state, 0.9);
  result.yielded_width = sides * state.yielded_width;
  result.local_band_collapse =
      problem.amplitude == 0.0 && result.yielded_width < thinnest_credible_band;
  result.answer = {.outcome = Outcome::steady,
                   .text = band_text(problem, state, result.band_width),
                   .condition_number = condition_number(problem, state)};
  if (result.discretisation_error > options.discretisation)
    result.answer.text += fmt::format(
        "; {} cells leave a relative error of {:.2g}", result.cells, result.discretisation_error);
  const Layer layer{.law = problem.law, .grains = problem.grains};
  result.answer.out_of_domain =
      range_flags(layer, table, shearing_part(problem, state, result.profile.height));
}

}  // namespace

ShearBand shear_band(const RheologyTable& table,
                     const ShearBandCase& band,
                     const ShearBandOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  validate(table);
  if (options.cells < 8 || options.rows < 2)
    throw std::invalid_argument("at least 8 cells and 2 rows are needed");
  const BandUnits units(band.grains);
  const BandProblem problem = make_problem(table, band, units);
  ShearBand result;
  result.sought = sought(problem);
  const Solution found = refine(problem, options, result);
  const BandState& state = found.state;
  if (state.flows()) {
    describe(problem, table, found, options, result);
  } else if (state.failure == BandFailure::none) {
    result.answer = {.outcome = Outcome::arrested, .text = rest_text(problem, state)};
  } else {
    result.answer = {.outcome = outcome_of(state.failure), .text = state.text};
  }
  result.iterations = state.iterations;
  result.driving_stress = state.wall.shear_stress * units.stress;
  result.driving_velocity = state.velocity * units.length;
  result.band_width *= units.length;
  result.yielded_width *= units.length;
  result.profile = in_case_units(std::move(result.profile), units);
  result.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace grainlaw::continuum
