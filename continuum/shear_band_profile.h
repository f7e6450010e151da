#pragma once

#include "continuum/shear_band_cells.h"

namespace grainlaw::continuum {

/// Distance from the moving wall within which this share of the velocity is taken.
double width_of(const BandProblem& problem, const BandState& state, double share);

/// Rows as ShearBand::profile has them, at most `most_rows` per quarter of a box or between walls.
Profile profile_of(const BandProblem& problem, const BandState& state, int most_rows);

/// The part of the band that takes 99 % of the velocity, for flags of range: beyond it creep has no
/// rate to speak of, and a range of I says nothing about it.
Profile shearing_part(const BandProblem& problem, const BandState& state, double height);

Profile in_case_units(Profile profile, const BandUnits& units);

}  // namespace grainlaw::continuum
