#include "continuum/shear_band_cells.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace grainlaw::continuum {
namespace {

/// Faces as fractions of the way from the moving wall to the other end.
using Faces = std::vector<double>;

/// Equal cells, three quarters of them up to `edge`, which becomes a face.
Faces split_at(double edge, int cells) {
  const int inside = edge < 1.0 ? std::max(1, 3 * cells / 4) : cells;
  const double end = std::min(edge, 1.0);
  Faces faces;
  for (int k = 0; k <= inside; ++k) faces.push_back(end * k / inside);
  for (int k = 1; k <= cells - inside; ++k)
    faces.push_back(end + (1.0 - end) * k / (cells - inside));
  return faces;
}

/// Length that the cells at the moving wall would span if all were equal to them [d]: 0.02 d each
/// for 400 cells. Fluidity falls within a few d from there.
constexpr double fine_length = 8.0;

/// x(s) = (e^(a s) - 1) / (e^a - 1), x'(0) = fine_length / length: cells that grow away from the
/// moving wall, the same map for every number of them.
Faces graded(double length, int cells) {
  const double slope = fine_length / length;
  double low = 0.0;
  double high = slope < 1.0 ? 700.0 : 0.0;
  for (int k = 0; k < 60; ++k) {  // a / (e^a - 1) falls with a
    const double a = 0.5 * (low + high);
    (a / std::expm1(a) > slope ? low : high) = a;
  }
  Faces faces;
  for (int k = 0; k <= cells; ++k) {
    const double s = static_cast<double>(k) / cells;
    faces.push_back(high > 0.0 ? std::expm1(high * s) / std::expm1(high) : s);
  }
  return faces;
}

/// Largest mass in [0, limit] at which the layer yields, which it does from 0 on.
double yielding_mass(const BandProblem& problem,
                     const PlaneShear& flow,
                     double stress,
                     double limit) {
  const auto yields = [&](double mass) {
    return stress > problem.curve(flow.load + flow.gravity * mass).yield_stress;
  };
  if (yields(limit)) return limit;
  double low = 0.0;
  for (;;) {
    const double middle = 0.5 * (low + limit);
    if (middle <= low || middle >= limit) return low;
    (yields(middle) ? low : limit) = middle;
  }
}

/// Mass of the layer between the walls for these volume fractions.
double total_mass(const Extent& extent, const Faces& faces, const std::vector<BandCell>& cells) {
  if (extent.mass_per_area) return *extent.mass_per_area;
  double height_per_mass = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i)
    height_per_mass += (faces[i + 1] - faces[i]) / cells[i].volume_fraction;
  return *extent.height / height_per_mass;
}

/// Masses, widths and positions of a slab.
void stack(std::vector<BandCell>& cells, const Faces& faces, double mass) {
  double along = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    BandCell& cell = cells[i];
    cell.mass = mass * (faces[i + 1] - faces[i]);
    cell.width = cell.mass / cell.volume_fraction;
    cell.along = along + 0.5 * cell.width;
    along += cell.width;
  }
}

double approximate_height(const BandProblem& problem, const Extent& extent, double pressure) {
  if (extent.height) return *extent.height;
  return *extent.mass_per_area / problem.curve(pressure).static_volume_fraction;
}

/// Puts the cells where the volume fractions they carry put them and gives them their stress and
/// pressure from the balance of forces.
void lay_out(const BandProblem& problem,
             const PlaneShear& flow,
             double stress,
             std::vector<BandCell>& cells) {
  const int n = static_cast<int>(cells.size());
  Faces faces;
  double mass = 0.0;
  if (problem.amplitude > 0.0) {
    faces = graded(approximate_height(problem, flow.extent, flow.load), n);
    mass = total_mass(flow.extent, faces, cells);
  } else {
    double known = 0.0;  // mass of the layer as it was laid out before
    for (const BandCell& cell : cells) known += cell.mass;
    if (known == 0.0) known = total_mass(flow.extent, split_at(1.0, n), cells);
    faces = split_at(yielding_mass(problem, flow, stress, known) / known, n);
    mass = total_mass(flow.extent, faces, cells);
  }
  stack(cells, faces, mass);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i].shear_stress = stress;
    cells[i].pressure = flow.load + flow.gravity * mass * 0.5 * (faces[i] + faces[i + 1]);
  }
}

/// A quarter of the period, from the largest stress at y = 0 to tau = 0.
void lay_out(const BandProblem&, const BodyForceBox& flow, double, std::vector<BandCell>& cells) {
  Extent quarter;
  if (flow.extent.height) quarter.height = 0.25 * *flow.extent.height;
  if (flow.extent.mass_per_area) quarter.mass_per_area = 0.25 * *flow.extent.mass_per_area;
  const Faces faces = split_at(1.0, static_cast<int>(cells.size()));
  stack(cells, faces, total_mass(quarter, faces, cells));
  const double length = cells.back().along + 0.5 * cells.back().width;
  double stress = 0.0;
  for (std::size_t i = cells.size(); i-- > 0;) {
    BandCell& cell = cells[i];
    const double force =
        cell.mass * flow.amplitude * std::sin(0.5 * std::numbers::pi * cell.along / length);
    cell.shear_stress = stress + 0.5 * force;
    cell.pressure = flow.pressure;
    stress += force;
  }
}

void lay_out(const BandProblem& problem,
             const AnnularShear& flow,
             double stress,
             std::vector<BandCell>& cells) {
  const int n = static_cast<int>(cells.size());
  const double gap = flow.outer_radius - flow.inner_radius;
  const double yield = problem.curve(flow.pressure).yield_stress;
  const double edge = flow.inner_radius * (std::sqrt(stress / yield) - 1.0) / gap;
  const Faces faces =
      problem.amplitude > 0.0 ? graded(gap, n) : split_at(edge > 0.0 ? edge : 1.0, n);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    BandCell& cell = cells[i];
    cell.width = gap * (faces[i + 1] - faces[i]);
    cell.along = flow.inner_radius + 0.5 * gap * (faces[i] + faces[i + 1]);
    cell.mass = cell.width * cell.volume_fraction;
    const double ratio = flow.inner_radius / cell.along;
    cell.shear_stress = stress * ratio * ratio;
    cell.pressure = flow.pressure;
  }
}

/// Stress and pressure at the moving wall; in the box at y = 0, where the stress is largest.
BandCell wall_of(const BandProblem& problem, double stress, const std::vector<BandCell>& cells) {
  if (const auto* shear = std::get_if<PlaneShear>(&problem.flow))
    return {.shear_stress = stress, .pressure = shear->load};
  if (const auto* annulus = std::get_if<AnnularShear>(&problem.flow))
    return {.along = annulus->inner_radius, .shear_stress = stress, .pressure = annulus->pressure};
  // the force vanishes at y = 0, so the stress is level there: half a cell changes it by O(h^2)
  const auto& box = std::get<BodyForceBox>(problem.flow);
  const double length = cells.back().along + 0.5 * cells.back().width;
  const double force =
      cells[0].mass * box.amplitude * std::sin(0.5 * std::numbers::pi * cells[0].along / length);
  return {.shear_stress = cells[0].shear_stress + 0.5 * force, .pressure = box.pressure};
}

BandGrid grid_of(const BandProblem& problem, const std::vector<BandCell>& cells) {
  const bool annular = std::holds_alternative<AnnularShear>(problem.flow);
  BandGrid grid;
  double half = 0.0;  // of the cell before the face
  const auto face = [&](double position, double next_half) {
    grid.area.push_back(annular ? position : 1.0);
    grid.distance.push_back(half + next_half);
    half = next_half;
  };
  for (const BandCell& cell : cells) {
    face(cell.along - 0.5 * cell.width, 0.5 * cell.width);
    grid.volume.push_back(cell.width * (annular ? cell.along : 1.0));
  }
  face(cells.back().along + 0.5 * cells.back().width, 0.0);
  return grid;
}

/// Why a cell has no state; the law itself says so.
BandFailure failure_of(const FlowCurve& curve, double stress) {
  const auto relative_I = curve.relative_inertial_number(stress);
  return relative_I && curve.linear > 0.0 ? BandFailure::no_dense_state : BandFailure::no_steady;
}

std::string failure_text(const FlowCurve& curve, const BandCell& cell) {
  const double mu = cell.shear_stress / cell.pressure;
  if (curve.linear <= 0.0 && curve.yield_stress <= 0.0)
    return fmt::format(
        "softness takes all friction, f_p <= 0, at p d / k_n of this band, where the law has no "
        "answer");
  if (failure_of(curve, cell.shear_stress) == BandFailure::no_dense_state)
    return fmt::format(
        "tau / p = {:.5g} would take I beyond I_phi = {:.4g}, where the volume fraction vanishes",
        mu,
        curve.I_phi);
  const double gain = curve.linear > 0.0 ? curve.linear / curve.kappa : 0.0;  // Coulomb: none
  return fmt::format("tau / p = {:.5g} is not below the largest friction {:.5g} of the law",
                     mu,
                     (curve.yield_stress + gain) / cell.pressure);
}

void fail(BandState& state, const FlowCurve& curve, const BandCell& cell) {
  state.failure = failure_of(curve, cell.shear_stress);
  state.text = failure_text(curve, cell);
}

/// Shear rate and volume fraction of a cell by the local law; false where it has no state.
bool shear_locally(const FlowCurve& curve, BandCell& cell) {
  const auto q = curve.scaled_rate(cell.shear_stress);
  if (!q || (curve.linear <= 0.0 && curve.yield_stress <= 0.0)) return false;
  cell.shear_rate = curve.shear_rate(*q);
  cell.volume_fraction = curve.volume_fraction(*q);
  return true;
}

/// The same from a fluidity.
bool shear_at(double fluidity, const FlowCurve& curve, BandCell& cell) {
  cell.shear_rate = fluidity * cell.shear_stress / cell.pressure;
  const double relative_I = cell.inertial_number() / curve.I_phi;
  if (relative_I >= 1.0) return false;
  cell.volume_fraction = curve.static_volume_fraction * (1.0 - relative_I);
  return true;
}

void shear_locally(const BandProblem& problem, BandState& state) {
  const auto shear = [&](BandCell& cell) {
    const FlowCurve curve = problem.curve(cell.pressure);
    if (state.failure == BandFailure::none && !shear_locally(curve, cell)) fail(state, curve, cell);
  };
  shear(state.wall);
  for (BandCell& cell : state.cells) shear(cell);
}

/// Fluidity of all cells; it has no flux through the ends. `guess` carries it from pass to pass.
void shear_nonlocally(const BandProblem& problem, BandState& state, std::vector<double>& guess) {
  std::vector<FlowCurve> curves;
  std::vector<FluidityTerms> terms;
  for (const BandCell& cell : state.cells) {
    curves.push_back(problem.curve(cell.pressure));
    const auto found = fluidity_terms(curves.back(), cell.shear_stress, cell.pressure);
    if (!found) return fail(state, curves.back(), cell);
    terms.push_back(*found);
  }
  const Fluidity fluidity =
      solve_fluidity(grid_of(problem, state.cells), terms, problem.amplitude, {}, {}, guess);
  state.iterations += fluidity.iterations;
  if (!fluidity.converged) {
    state.failure = BandFailure::not_converged;
    state.text = fmt::format("the fluidity still changed after {} steps", fluidity.iterations);
    return;
  }
  const auto shear = [&](double g, const FlowCurve& curve, BandCell& cell) {
    if (shear_at(g, curve, cell)) return;
    state.failure = BandFailure::no_dense_state;
    state.text =
        fmt::format("I = {:.4g} would exceed I_phi = {:.4g}, where the volume fraction vanishes",
                    cell.inertial_number(),
                    curve.I_phi);
  };
  shear(fluidity.g.front(), problem.curve(state.wall.pressure), state.wall);
  for (std::size_t i = 0; i < state.cells.size(); ++i)
    shear(fluidity.g[i], curves[i], state.cells[i]);
  guess = fluidity.g;
}

/// Distance from the moving wall up to which the stress exceeds the yield stress: linear between
/// the cells on either side of the edge.
double yielded_width(const BandProblem& problem, const BandState& state) {
  const auto excess = [&](const BandCell& cell) {
    return cell.shear_stress - problem.curve(cell.pressure).yield_stress;
  };
  if (excess(state.wall) <= 0.0) return 0.0;
  const BandCell* before = &state.wall;
  for (const BandCell& cell : state.cells) {
    if (const double here = excess(cell); here <= 0.0) {
      const double share = excess(*before) / (excess(*before) - here);
      return before->along + share * (cell.along - before->along) - state.wall.along;
    }
    before = &cell;
  }
  return before->along + 0.5 * before->width - state.wall.along;
}

/// Where phi follows from the flow and the flow from where phi puts the cells.
constexpr int most_passes = 400;
constexpr double pass_tolerance = 1e-13;

/// Shears the cells as they lie. Returns the largest change of a volume fraction, which has then
/// moved `share` of the way to its new value.
double pass(const BandProblem& problem,
            BandState& state,
            std::vector<double>& guess,
            double share) {
  std::vector<double> before;
  for (const BandCell& cell : state.cells) before.push_back(cell.volume_fraction);
  if (problem.amplitude > 0.0)
    shear_nonlocally(problem, state, guess);
  else
    shear_locally(problem, state);
  double change = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    double& phi = state.cells[i].volume_fraction;
    change = std::max(change, std::abs(phi - before[i]));
    phi = before[i] + share * (phi - before[i]);
  }
  return change;
}

/// Repeats passes until neither phi nor the extent changes. Full steps overshoot where I is near
/// I_phi: once a change is not half of the one before, steps go half way.
void settle(const BandProblem& problem, double wall_stress, BandState& state) {
  std::vector<double> guess;
  double change = 1.0;
  double extent = 0.0;
  double extent_change = 1.0;
  double share = 1.0;
  for (int k = 0; k < most_passes && (change > pass_tolerance || extent_change > pass_tolerance);
       ++k) {
    std::visit([&](const auto& flow) { lay_out(problem, flow, wall_stress, state.cells); },
               problem.flow);
    state.wall = wall_of(problem, wall_stress, state.cells);
    const double before = change;
    change = pass(problem, state, guess, share);
    if (state.failure != BandFailure::none) return;
    if (change > 0.5 * before) share = 0.5;
    const double end = state.cells.back().along;
    extent_change = std::abs(end - extent) / end;
    extent = end;
  }
  if (change <= 1e-9) return;
  state.failure = BandFailure::not_converged;
  state.text = fmt::format(
      "the volume fraction still changed by {:.2g} after {} passes", change, most_passes);
}

}  // namespace

double BandCell::inertial_number() const {
  return shear_rate / std::sqrt(pressure);
}

double wall_yield_stress(const BandProblem& problem) {
  const double pressure = std::visit(
      [](const auto& flow) {
        if constexpr (requires { flow.load; })
          return flow.load;
        else
          return flow.pressure;
      },
      problem.flow);
  return problem.curve(pressure).yield_stress;
}

double velocity_weight(const BandProblem& problem, const BandCell& cell) {
  const auto* annulus = std::get_if<AnnularShear>(&problem.flow);
  return annulus ? cell.width * annulus->inner_radius / cell.along : cell.width;
}

BandState band_state(const BandProblem& problem, double wall_stress, int cells) {
  BandState state;
  const double start = problem.law.volume_fraction.phi0;
  state.cells.assign(static_cast<std::size_t>(cells), {.volume_fraction = start});
  settle(problem, wall_stress, state);
  if (state.failure != BandFailure::none) return state;
  for (const BandCell& cell : state.cells)
    state.velocity += velocity_weight(problem, cell) * cell.shear_rate;
  state.yielded_width = yielded_width(problem, state);
  return state;
}

}  // namespace grainlaw::continuum
