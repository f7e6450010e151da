#include "continuum/thin_layer.h"

#include <cmath>

#include "continuum/nonlocal_fluidity.h"

namespace grainlaw::continuum {
namespace {

/// mu(I) as it is under the pressure at the base.
InertialFriction friction_at_base(const MuPhi& law, const Confinement& base) {
  const double factor = friction_factor(law, base);
  InertialFriction friction = law.friction;
  friction.mu0 *= factor;
  friction.beta *= factor;
  if (law.cohesion_stress) friction.mu0 += cohesion_friction(*law.cohesion_stress, base);
  return friction;
}

/// Lowest row that moves over another: below, side walls hold the grains.
const ProfileRow& lowest_moving(const Profile& profile) {
  for (std::size_t i = 0; i + 1 < profile.rows.size(); ++i)
    if (profile.rows[i].shear_rate != 0.0) return profile.rows[i];
  return profile.rows.front();
}

}  // namespace

std::optional<ThinLayer> thin_layer(const RheologyTable& table,
                                    const ChuteCase& chute,
                                    const Profile& profile) {
  const auto* law = std::get_if<MuPhi>(&table.law);
  if (!law || law->friction.tabulated || profile.rows.empty()) return std::nullopt;
  const ProfileRow& base = lowest_moving(profile);
  const InertialFriction friction =
      friction_at_base(*law, confinement(chute.grains, base.pressure));
  const double mu = std::tan(std::abs(chute.inclination));
  return ThinLayer{
      .flowing_depth = profile.height - base.z,
      .stop_depth = chute.grains.diameter * stop_depth(glass_bead_amplitude, friction, mu)};
}

}  // namespace grainlaw::continuum
