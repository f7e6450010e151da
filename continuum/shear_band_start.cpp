#include "continuum/shear_band_start.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <stdexcept>

#include "continuum/band_layer.h"
#include "continuum/shear_band_profile.h"

namespace grainlaw::continuum {
namespace {

constexpr long most_steps = 1'000'000;
constexpr long steps_of_chatter = 20'000;  // see Segment
constexpr double times_allowed = 100.0;    // e^-100: nothing of the start is left
constexpr double steady_within = 0.01;

void check(const ShearBandCase& band, const BandStartOptions& options) {
  if (std::holds_alternative<AnnularShear>(band.flow))
    throw std::invalid_argument("an annulus has its steady flow only: no start");
  if (band.nonlocal_amplitude.value_or(0.0) > 0.0)
    throw std::invalid_argument("a start follows the local law: leave out the nonlocal amplitude");
  if (options.cells < 2) throw std::invalid_argument("at least 2 cells are needed");
  if (!(options.relative_tolerance > 0.0 && options.relative_tolerance <= 0.1))
    throw std::invalid_argument("the relative tolerance must be positive and at most 0.1");
}

/// Faces over the mass from the moving wall, closer there where a band under gravity lies; over a
/// quarter of the box even.
std::vector<double> faces_of(const BandProblem& problem, double mass, int cells) {
  const double grading = std::holds_alternative<PlaneShear>(problem.flow) ? 1.5 : 1.0;
  std::vector<double> faces;
  for (int k = 0; k <= cells; ++k)
    faces.push_back(mass * std::pow(static_cast<double>(k) / cells, grading));
  return faces;
}

/// The steady band a start leads to, d = rho_p = 1.
struct Goal {
  double stress = 0.0;    ///< on the moving wall, in the box at y = 0
  double velocity = 0.0;  ///< of the moving wall, or the largest
  double mass = 0.0;      ///< between the walls, or of a quarter of the box
  double time = 0.0;      ///< momentum over the stress above yield: what the start takes
};

Goal goal_of(const BandProblem& problem, const ShearBand& steady, const BandUnits& units) {
  const bool box = std::holds_alternative<BodyForceBox>(problem.flow);
  Goal goal{.stress = steady.driving_stress / units.stress,
            .velocity = steady.driving_velocity / units.length};
  const auto& rows = steady.profile.rows;
  const double whole =
      std::max(rows.front().mass_above, rows.back().mass_above) / units.mass_per_area;
  goal.mass = box ? 0.25 * whole : whole;
  const double momentum = steady.profile.flux / (units.length * units.length) * (box ? 0.5 : 1.0);
  goal.time = momentum / (goal.stress - wall_yield_stress(problem));
  return goal;
}

BandLayer layer_of(const BandProblem& problem, const Goal& goal, int cells) {
  const std::vector<double> faces = faces_of(problem, goal.mass, cells);
  const double elastic_time = 5e-4 * goal.time;
  const BandEnd at_rest{.velocity = 0.0};
  if (const auto* shear = std::get_if<PlaneShear>(&problem.flow)) {
    const BandEnd wall{.velocity = shear->drive.velocity,
                       .stress = shear->drive.stress.value_or(0.0)};
    return {problem, faces, wall, at_rest, goal.stress, elastic_time};
  }
  return {problem, faces, at_rest, BandEnd{}, goal.stress, elastic_time};
}

/// Follows one start, in units d = rho_p = 1 and the time of the case.
class Start {
 public:
  Start(const BandProblem& problem,
        const Goal& goal,
        const BandUnits& units,
        const BandStartOptions& options,
        BandStart& result)
      : problem_(problem),
        goal_(goal),
        units_(units),
        options_(options),
        layer_(layer_of(problem, goal, options.cells)),
        result_(result) {}

  /// True once steady.
  bool run();
  BandState last;

 private:
  double limit() const {
    if (options_.time_limit > 0.0) return options_.time_limit;
    const double needed = times_allowed * goal_.time;
    return options_.output_times.empty() ? needed : std::max(needed, options_.output_times.back());
  }
  bool follow(OdeSolver& solver);
  void take_snapshots(const OdeSolver& solver);
  double time_to_steady() const;

  const BandProblem& problem_;
  Goal goal_;
  const BandUnits& units_;
  const BandStartOptions& options_;
  BandLayer layer_;
  BandStart& result_;
  struct Momentum {
    double time, value;
  };
  std::vector<Momentum> history_;  // after every step
};

void Start::take_snapshots(const OdeSolver& solver) {
  while (result_.snapshots.size() < options_.output_times.size()) {
    const double next = options_.output_times[result_.snapshots.size()];
    if (next > solver.time()) return;
    const BandState state = layer_.band_state(solver.interpolate(next));
    result_.snapshots.push_back(
        {next, in_case_units(profile_of(problem_, state, options_.cells), units_)});
  }
}

/// After the last step whose momentum was off by more than 1 % of what it became.
double Start::time_to_steady() const {
  const double final = history_.back().value;
  double time = 0.0;
  for (const Momentum& m : history_)
    if (std::abs(m.value - final) > steady_within * final) time = m.time;
  return time;
}

bool Start::run() {
  const std::vector<double> rest = layer_.rest();
  OdeSolver solver(layer_,
                   rest,
                   {.relative_tolerance = options_.relative_tolerance,
                    .absolute_tolerance =
                        1e-4 * options_.relative_tolerance * std::min(goal_.velocity, goal_.stress),
                    .end_time = limit(),
                    .stop_at_event = false});
  bool steady = false;
  try {
    steady = follow(solver);
  } catch (const SolverError& error) {
    result_.answer.text += fmt::format("; {}", error.what());
  }
  result_.end_time = solver.time();
  result_.statistics = solver.statistics();
  if (steady) result_.time_to_steady = time_to_steady();
  last = layer_.band_state(solver.state());
  return steady;
}

bool Start::follow(OdeSolver& solver) {
  for (long steps = 1; steps < most_steps; ++steps) {
    const bool at_end = solver.step() == OdeSolver::Step::end;
    take_snapshots(solver);
    history_.push_back({solver.time(), layer_.momentum(solver.state())});
    const bool steady =
        solver.time() > goal_.time && layer_.largest_acceleration(solver.derivative()) <=
                                          options_.steady_residual * goal_.stress / goal_.mass;
    const bool all_taken = result_.snapshots.size() == options_.output_times.size();
    if (at_end || (steady && all_taken)) return steady;
    if (steps % steps_of_chatter == 0) solver.tighten(0.1);
  }
  return false;
}

}  // namespace

BandStart start_band(const RheologyTable& table,
                     const ShearBandCase& band,
                     const BandStartOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  check(band, options);
  require_continuous_yield(table.law);
  const ShearBand steady = shear_band(table, band, {.discretisation = 1e-6});
  BandStart result;
  result.answer = steady.answer;
  if (!flows(steady.answer.outcome)) return result;
  const BandUnits units(band.grains);
  const BandProblem problem = make_problem(table, band, units);
  Start start(problem, goal_of(problem, steady, units), units, options, result);
  if (!start.run()) {
    const bool asked = options.time_limit > 0.0 && result.end_time >= options.time_limit;
    result.answer.outcome = asked ? Outcome::time_reached : Outcome::not_converged;
    result.answer.text += fmt::format("; not steady at t = {:.4g}", result.end_time);
  }
  result.final_profile = in_case_units(profile_of(problem, start.last, options.cells), units);
  result.driving_stress = start.last.wall.shear_stress * units.stress;
  result.driving_velocity = start.last.velocity * units.length;
  result.difference = steady.sought == ShearBand::Sought::stress
                          ? result.driving_stress / steady.driving_stress - 1.0
                          : result.driving_velocity / steady.driving_velocity - 1.0;
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  result.statistics.wall_seconds = taken.count();
  return result;
}

}  // namespace grainlaw::continuum
