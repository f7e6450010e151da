#include "continuum/homogeneous_shear.h"

namespace grainlaw::continuum {
namespace {

bool inside(const std::optional<Range>& range, double value) {
  return !range || (value >= range->lower && value <= range->upper);
}

/// Towards p* = 0 softness drops out of a law, so only the upper end of its range can be left;
/// unless cohesion fades with it.
bool inside(const ValidRange& range, const MuPhi& law, const HomogeneousState& state) {
  const bool fades =
      law.cohesion_stress && law.cohesion_stress->softness_exponent && state.bond_number > 0.0;
  return inside(range.inertial_number, state.inertial_number) &&
         (fades ? inside(range.softness, state.softness)
                : !range.softness || state.softness <= range.softness->upper) &&
         inside(range.bond_number, state.bond_number);
}

HomogeneousState state_at(
    const RheologyTable& table, const MuPhi& law, double I, double p, double Bo) {
  HomogeneousState state{.inertial_number = I, .softness = p, .bond_number = Bo};
  const Confinement at{.softness = (1.0 + Bo) * p, .bond_number = Bo};
  if (table.has_friction && friction_factor(law, at) > 0.0) state.friction = friction(law, I, at);
  if (const double phi = volume_fraction(law, I, at); phi > 0.0 && phi < 1.0)
    state.volume_fraction = phi;
  state.in_range = inside(table.range, law, state);
  return state;
}

}  // namespace

std::vector<HomogeneousState> homogeneous_shear(const RheologyTable& table,
                                                const std::vector<double>& inertial_numbers,
                                                const std::vector<double>& softnesses,
                                                const std::vector<double>& bond_numbers) {
  validate_coefficients(table);
  const auto* law = std::get_if<MuPhi>(&table.law);
  if (law == nullptr)
    throw TableError("a generalised Bagnold law has no mu(I): its stress is a gd^2 + b gd + tau_c");
  std::vector<HomogeneousState> states;
  for (const double I : inertial_numbers)
    for (const double p : softnesses)
      for (const double Bo : bond_numbers) states.push_back(state_at(table, *law, I, p, Bo));
  return states;
}

}  // namespace grainlaw::continuum
