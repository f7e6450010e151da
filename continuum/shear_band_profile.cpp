#include "continuum/shear_band_profile.h"

#include <algorithm>

namespace grainlaw::continuum {
namespace {

/// Velocity of the material at the centre of every cell in the frame of the wall at rest; in the
/// box from y = 0 on.
std::vector<double> velocities(const BandProblem& problem, const BandState& state) {
  std::vector<double> result;
  const bool box = std::holds_alternative<BodyForceBox>(problem.flow);
  double passed = 0.0;
  for (const BandCell& cell : state.cells) {
    const double drop = velocity_weight(problem, cell) * cell.shear_rate;
    const double here = passed + 0.5 * drop;
    passed += drop;
    result.push_back(box ? here : std::max(0.0, state.velocity - here));
  }
  if (const auto* annulus = std::get_if<AnnularShear>(&problem.flow))  // was R_i omega
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] *= state.cells[i].along / annulus->inner_radius;
  return result;
}

ProfileRow row_of(const BandCell& cell, double position, double velocity, double mass_above) {
  return {.z = position,
          .mass_above = mass_above,
          .velocity = velocity,
          .shear_rate = cell.shear_rate,
          .shear_stress = cell.shear_stress,
          .pressure = cell.pressure,
          .volume_fraction = cell.volume_fraction,
          .inertial_number = cell.inertial_number()};
}

/// Rows from the moving wall to the wall at rest, both included; every `stride`-th cell.
std::vector<ProfileRow> rows_from_wall(const BandProblem& problem,
                                       const BandState& state,
                                       std::size_t stride) {
  const auto velocity = velocities(problem, state);
  const bool box = std::holds_alternative<BodyForceBox>(problem.flow);
  std::vector<ProfileRow> rows{
      row_of(state.wall, state.wall.along, box ? 0.0 : state.velocity, 0.0)};
  double mass = 0.0;
  for (std::size_t i = 0; i < state.cells.size(); ++i) {
    const BandCell& cell = state.cells[i];
    if (i % stride == stride / 2)
      rows.push_back(row_of(cell, cell.along, velocity[i], mass + 0.5 * cell.mass));
    mass += cell.mass;
  }
  const BandCell& last = state.cells.back();
  rows.push_back(row_of(last, last.along + 0.5 * last.width, box ? state.velocity : 0.0, mass));
  return rows;
}

ProfileRow reversed(ProfileRow row, double velocity_sign) {
  row.velocity *= velocity_sign;
  row.shear_rate = -row.shear_rate;
  row.shear_stress = -row.shear_stress;
  return row;
}

/// A whole period from its first quarter: mirrored about a quarter, then turned about a half.
std::vector<ProfileRow> unfolded(std::vector<ProfileRow> rows) {
  const double half = 2.0 * rows.back().z;
  const double mass = 4.0 * rows.back().mass_above;
  for (std::size_t i = rows.size() - 1; i-- > 0;) {
    rows.push_back(reversed(rows[i], 1.0));
    rows.back().z = half - rows[i].z;
    rows.back().mass_above = 0.5 * mass - rows[i].mass_above;
  }
  const std::size_t n = rows.size();
  for (std::size_t i = 1; i < n; ++i) {
    rows.push_back(reversed(rows[i], -1.0));
    rows.back().z += half;
    rows.back().mass_above += 0.5 * mass;
  }
  for (ProfileRow& row : rows) row.mass_above = mass - row.mass_above;
  return rows;
}

double flux_of(const BandProblem& problem, const BandState& state) {
  const auto velocity = velocities(problem, state);
  double flux = 0.0;
  for (std::size_t i = 0; i < velocity.size(); ++i) flux += velocity[i] * state.cells[i].mass;
  return std::holds_alternative<BodyForceBox>(problem.flow) ? 2.0 * flux : flux;
}

}  // namespace

double width_of(const BandProblem& problem, const BandState& state, double share) {
  double left = share * state.velocity;
  for (const BandCell& cell : state.cells) {
    const double drop = velocity_weight(problem, cell) * cell.shear_rate;
    if (drop >= left) return cell.along + cell.width * (left / drop - 0.5) - state.wall.along;
    left -= drop;
  }
  return state.cells.back().along + 0.5 * state.cells.back().width - state.wall.along;
}

Profile profile_of(const BandProblem& problem, const BandState& state, int most_rows) {
  const std::size_t stride = (state.cells.size() - 1) / static_cast<std::size_t>(most_rows) + 1;
  Profile profile;
  profile.rows = rows_from_wall(problem, state, stride);
  const double end = profile.rows.back().z;
  const double mass = profile.rows.back().mass_above;
  profile.height = end;
  profile.surface_velocity = state.velocity;
  profile.flux = flux_of(problem, state);
  if (std::holds_alternative<BodyForceBox>(problem.flow)) {
    profile.rows = unfolded(std::move(profile.rows));
    profile.height = 4.0 * end;
  } else if (std::holds_alternative<PlaneShear>(problem.flow)) {
    for (ProfileRow& row : profile.rows) row.z = end - row.z;
    std::reverse(profile.rows.begin(), profile.rows.end());
  } else {
    for (ProfileRow& row : profile.rows) row.mass_above = mass - row.mass_above;
  }
  return profile;
}

Profile shearing_part(const BandProblem& problem, const BandState& state, double height) {
  const double end = state.wall.along + width_of(problem, state, 0.99);
  Profile part;
  part.height = height;
  double mass = 0.0;
  for (const BandCell& cell : state.cells) {
    if (cell.along > end && !part.rows.empty()) break;
    mass += cell.mass;
    part.rows.push_back(row_of(cell, cell.along, 0.0, mass));
  }
  std::reverse(part.rows.begin(), part.rows.end());
  return part;
}

Profile in_case_units(Profile profile, const BandUnits& units) {
  for (ProfileRow& row : profile.rows) {
    row.z *= units.length;
    row.mass_above *= units.mass_per_area;
    row.velocity *= units.length;
    row.shear_stress *= units.stress;
    row.pressure *= units.stress;
  }
  profile.height *= units.length;
  profile.surface_velocity *= units.length;
  profile.flux *= units.length * units.length;
  return profile;
}

}  // namespace grainlaw::continuum
