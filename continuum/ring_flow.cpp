#include "continuum/ring_flow.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "continuum/fixed_point.h"
#include "continuum/nonlocal_fluidity.h"
#include "continuum/range_flags.h"
#include "continuum/ring_fluidity.h"
#include "continuum/ring_mesh.h"
#include "continuum/torque_balance.h"

namespace grainlaw::continuum {
namespace {

/// What rests creeps at this share of Omega R_s / d.
constexpr double creep = 1e-6;

/// A ring cell in units d = rho_p = g = 1.
struct Problem {
  const MuPhi& law;
  GrainProperties grains;
  double inner = 0.0;
  double split = 0.0;
  double outer = 0.0;
  double depth = 0.0;
  double rotation_rate = 0.0;
  double amplitude = 0.0;
};

void require_between(const char* name, double value, double lower, double upper) {
  if (!(value > lower && value < upper))
    throw std::invalid_argument(
        fmt::format("{} = {:g} must lie between {:g} and {:g}", name, value, lower, upper));
}

Problem dimensionless(const MuPhi& law, const RingFlowCase& ring) {
  const SplitBottomCase& cell = ring.cell;
  const double d = cell.grains.diameter;
  return {.law = law,
          .grains = dimensionless_grains(cell),
          .inner = ring.inner_radius / d,
          .split = cell.split_radius / d,
          .outer = ring.outer_radius / d,
          .depth = cell.depth / d,
          .rotation_rate = cell.rotation_rate * std::sqrt(d / cell.gravity),
          .amplitude = ring.nonlocal_amplitude.value_or(0.0)};
}

void check(const RingFlowCase& ring, const RingFlowOptions& options) {
  check(ring.cell);
  const double d = ring.cell.grains.diameter;
  require_between("inner radius", ring.inner_radius, 0.0, ring.cell.split_radius);
  require_between("split radius", ring.cell.split_radius, ring.inner_radius, ring.outer_radius);
  constexpr double most = 1e9;  // squares of rates, and products of them, stay numbers
  require_between("rotation rate in sqrt(g/d)",
                  ring.cell.rotation_rate * std::sqrt(d / ring.cell.gravity),
                  1.0 / most,
                  most);
  const double amplitude = ring.nonlocal_amplitude.value_or(0.0);
  constexpr double longest = 1e3;  // A is about 0.5 for grains
  if (!(amplitude >= 0.0 && amplitude <= longest))
    throw std::invalid_argument(fmt::format(
        "the nonlocal amplitude A = {:g} must lie between 0 and {:g}", amplitude, longest));
  if (!(options.cell_width > 0.0)) throw std::invalid_argument("cells must have a width");
  constexpr double most_cells = 2e5;  // a minute, 1 GB
  const double area = (ring.outer_radius - ring.inner_radius) * ring.cell.depth / (d * d);
  if (!(area / (options.cell_width * options.cell_width) < most_cells))
    throw std::invalid_argument(
        fmt::format("the cross-section of this cell is {:.3g} d^2: with cells of {:g} d at most "
                    "{:.3g} can be solved",
                    area,
                    options.cell_width,
                    most_cells * options.cell_width * options.cell_width));
}

/// Of the weight at rest, in the middle of every row of cells.
std::vector<double> pressures(const Problem& problem, const RingMesh& mesh) {
  std::vector<double> result(mesh.rows());
  double above = 0.0;
  for (std::size_t k = mesh.rows(); k-- > 0;) {
    const Confinement at = confinement(problem.grains, std::max(above, 1e-30));
    const double part = static_volume_fraction(problem.law, at) * mesh.thickness();
    result[k] = above + 0.5 * part;
    above += part;
  }
  return result;
}

struct Solution {
  RingMesh mesh;
  std::vector<double> pressure;    ///< of the rows of cells
  std::vector<double> rotation;    ///< of the nodes
  std::vector<double> shear_rate;  ///< of the cells
  std::vector<double> stress;      ///< of the cells
  FixedPoint found;
};

double rotation_at(const Solution& solution, double radius, double height) {
  return interpolate(solution.mesh.r(), solution.mesh.z(), solution.rotation, radius, height);
}

/// Starts from the rotation of a coarser mesh, if there is one.
Solution solve_on(const Problem& problem, double cell_width, const Solution* coarser) {
  RingMesh mesh(problem.inner, problem.split, problem.outer, problem.depth, cell_width);
  Solution result{.mesh = std::move(mesh),
                  .pressure = {},
                  .rotation = {},
                  .shear_rate = {},
                  .stress = {},
                  .found = {}};
  const RingMesh& m = result.mesh;
  result.pressure = pressures(problem, m);
  TorqueBalance balance(m, problem.split);
  RingFluidity fluidity(m, problem.law, problem.grains, result.pressure, problem.amplitude);
  std::vector<double> viscosity(m.cells(), 1.0), g;
  const auto update = [&](std::span<const double> rotation) {
    result.shear_rate = balance.shear_rates(rotation);
    for (double& rate : result.shear_rate)
      rate = problem.rotation_rate * std::hypot(rate, creep * problem.split);
    fluidity.solve(result.shear_rate, g);
    for (std::size_t cell = 0; cell < m.cells(); ++cell)
      viscosity[cell] = result.pressure[cell / m.columns()] / g[cell];
  };
  std::vector<double> start(balance.unknowns());
  if (coarser != nullptr) {
    std::vector<double> rotation;
    for (const double z : m.z())
      for (const double r : m.r()) rotation.push_back(rotation_at(*coarser, r, z));
    start = balance.gather(rotation);
  } else {
    balance.solve(viscosity, start);
  }
  const auto map = [&](std::span<const double> unknowns, std::span<double> image) {
    update(balance.scatter(unknowns));
    balance.solve(viscosity, image);
  };
  result.found = solve_fixed_point(map, start);
  result.rotation = balance.scatter(result.found.x);
  update(result.rotation);
  for (std::size_t cell = 0; cell < m.cells(); ++cell)
    result.stress.push_back(viscosity[cell] * result.shear_rate[cell]);
  return result;
}

/// Dissipation over Omega.
double torque(const Problem& problem, const Solution& solution) {
  double sum = 0.0;
  for (std::size_t cell = 0; cell < solution.mesh.cells(); ++cell)
    sum += solution.stress[cell] * solution.shear_rate[cell] *
           solution.mesh.volume(cell % solution.mesh.columns());
  return 2.0 * std::numbers::pi * sum / problem.rotation_rate;
}

/// The radius at which a share of Omega is reached first, between nodes of one height.
double radius_of_share(const Solution& solution, double height, double share) {
  const std::vector<double>& r = solution.mesh.r();
  double before = 0.0;
  for (std::size_t i = 1; i < r.size(); ++i) {
    const double here = rotation_at(solution, r[i], height);
    if (here >= share) return std::lerp(r[i - 1], r[i], (share - before) / (here - before));
    before = here;
  }
  return r.back();
}

RingFlowRow row_of(const Problem& problem, const Solution& solution, std::size_t k) {
  const RingMesh& mesh = solution.mesh;
  RingFlowRow row{.z = mesh.height(k), .pressure = solution.pressure[k]};
  const double half = 0.5 * std::erf(0.5);
  row.centre = radius_of_share(solution, row.z, 0.5);
  row.width =
      radius_of_share(solution, row.z, 0.5 + half) - radius_of_share(solution, row.z, 0.5 - half);
  const auto first = solution.shear_rate.begin() + static_cast<long>(mesh.cell(0, k));
  const auto largest = std::max_element(first, first + static_cast<long>(mesh.columns()));
  row.shear_rate = *largest;
  row.friction = solution.stress[static_cast<std::size_t>(largest - solution.shear_rate.begin())] /
                 row.pressure;
  row.inertial_number = row.shear_rate / std::sqrt(row.pressure);
  row.volume_fraction = std::max(
      0.0,
      volume_fraction(problem.law, row.inertial_number, confinement(problem.grains, row.pressure)));
  return row;
}

/// Relative L2 distance of the velocities of two meshes, over the nodes of the finer one.
double distance(const Solution& fine, const Solution& coarse) {
  double difference = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < fine.mesh.z().size(); ++k) {
    for (std::size_t i = 0; i < fine.mesh.r().size(); ++i) {
      const double r = fine.mesh.r()[i];
      const double share = fine.rotation[fine.mesh.node(i, k)];
      const double other = rotation_at(coarse, r, fine.mesh.z()[k]);
      difference += std::pow(r * (share - other), 2);
      sum += std::pow(r * share, 2);
    }
  }
  return std::sqrt(difference / sum);
}

/// Softness takes the friction of the lowest row first.
bool friction_left(const Problem& problem) {
  const RingMesh mesh(problem.inner, problem.split, problem.outer, problem.depth, problem.depth);
  const double p = pressures(problem, mesh).front();
  return std::isfinite(p) && friction_factor(problem.law, confinement(problem.grains, p)) > 0.0;
}

const MuPhi& law_of(const RheologyTable& table, const RingFlowCase& ring) {
  const auto* law = std::get_if<MuPhi>(&table.law);
  if (law == nullptr)
    throw TableError(
        "a generalised Bagnold law holds at its own tilt only: a ring cell needs a table of mu(I) "
        "and phi(I)");
  if (ring.nonlocal_amplitude.value_or(0.0) > 0.0) require_linear_onset(law->friction);
  return *law;
}

/// Where omega is half of Omega only at the inner cylinder, the band has closed into a dome.
std::string where(const Problem& problem, const RingFlowRow& top) {
  if (top.centre < problem.inner + 1.0)
    return "the band does not reach the surface, all of which turns with the outer part";
  return fmt::format(
      "the band ends at R_c / R_s = {:.4f} at the surface and is {:.3g} d wide there",
      top.centre / problem.split,
      top.width);
}

Answer answer_of(const Problem& problem,
                 const Solution& solution,
                 const std::vector<RingFlowRow>& rows) {
  if (!solution.found.converged)
    return {.text = fmt::format("rotation and viscosity of the ring cell do not settle within {} "
                                "iterations: the band of a slow local law is thinner than the "
                                "cells, a nonlocal one settles in a few",
                                solution.found.iterations)};
  const double I_phi = problem.law.volume_fraction.I_phi;
  const auto dilute = std::ranges::count_if(
      rows, [&](const RingFlowRow& row) { return row.inertial_number >= I_phi; });
  if (2 * dilute > static_cast<long>(rows.size()))
    return {.outcome = Outcome::no_dense_state,
            .text = fmt::format("I exceeds I_phi = {:.3g}, where phi would vanish, at {} of {} "
                                "heights",
                                I_phi,
                                dilute,
                                rows.size())};
  return {.outcome = Outcome::steady, .text = where(problem, rows.back())};
}

void to_case_units(const SplitBottomCase& cell, RingFlow& flow) {
  const double d = cell.grains.diameter;
  const double stress = cell.grains.density * cell.gravity * d;
  for (double& r : flow.r) r *= d;
  for (double& z : flow.z) z *= d;
  for (RingFlowRow& row : flow.rows) {
    row.z *= d;
    row.centre *= d;
    row.width *= d;
    row.shear_rate /= std::sqrt(d / cell.gravity);
    row.pressure *= stress;
  }
  flow.torque *= stress * d * d * d;
}

}  // namespace

double RingFlow::rotation_at(double radius, double height) const {
  return interpolate(r, z, rotation, radius, height);
}

RingFlow ring_flow(const RheologyTable& table,
                   const RingFlowCase& ring,
                   const RingFlowOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  validate(table);
  check(ring, options);
  const Problem problem = dimensionless(law_of(table, ring), ring);
  RingFlow flow;
  if (!friction_left(problem)) {
    flow.answer = {.outcome = Outcome::no_steady,
                   .text =
                       "softness takes all friction, f_p <= 0, at the bottom of this filling, "
                       "where the law has no answer"};
    return flow;
  }
  const Solution coarse = solve_on(problem, 2.0 * options.cell_width, nullptr);
  const Solution fine = solve_on(problem, options.cell_width, &coarse);
  flow.iterations = fine.found.iterations;
  flow.discretisation_error = distance(fine, coarse);
  flow.torque = torque(problem, fine);
  for (std::size_t k = 0; k < fine.mesh.rows(); ++k) flow.rows.push_back(row_of(problem, fine, k));
  flow.local_band_collapse =
      problem.amplitude == 0.0 && std::ranges::all_of(flow.rows, [](const RingFlowRow& row) {
        return row.width < thinnest_credible_band;
      });
  flow.answer = answer_of(problem, fine, flow.rows);
  flow.answer.out_of_domain =
      filling_flags(problem.law, problem.grains, table, problem.depth, flow.rows);
  flow.r = fine.mesh.r();
  flow.z = fine.mesh.z();
  flow.rotation = fine.rotation;
  to_case_units(ring.cell, flow);
  flow.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return flow;
}

}  // namespace grainlaw::continuum
