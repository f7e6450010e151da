#pragma once

#include "continuum/shear_band.h"

namespace grainlaw::continuum {

/// Fills velocity_error of every row of the profile by linear propagation of the table's
/// covariance, at a fixed place (of a box: a fixed part of its period). Leaves 0 when the table
/// states no errors, or when a step of a coefficient leaves the steady flows.
void add_velocity_band(ShearBand& band, const RheologyTable& table, const ShearBandCase& of);

}  // namespace grainlaw::continuum
