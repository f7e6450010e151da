#pragma once

#include <vector>

#include "continuum/layer.h"

namespace grainlaw::continuum {

/// Flags of a profile in units d = rho_p = g = 1, resolved to the mass between its rows. An empty
/// profile (no flow) can still have the wrong inclination.
std::vector<RangeFlag> range_flags(const Layer& layer,
                                   const RheologyTable& table,
                                   const Profile& profile);

/// The same of rows with z, pressure, shear_rate, volume_fraction and inertial_number each, bottom
/// to top: the centre of a band in a filling, whose pressure is the weight above.
template <class Rows>
std::vector<RangeFlag> filling_flags(const MuPhi& law,
                                     const GrainProperties& grains,
                                     const RheologyTable& table,
                                     double depth,
                                     const Rows& rows) {
  Profile profile;
  profile.height = depth;
  for (const auto& row : rows)
    profile.rows.push_back({.z = row.z,
                            .mass_above = row.pressure,
                            .shear_rate = row.shear_rate,
                            .pressure = row.pressure,
                            .volume_fraction = row.volume_fraction,
                            .inertial_number = row.inertial_number});
  return range_flags({.law = law, .grains = grains}, table, profile);
}

}  // namespace grainlaw::continuum
