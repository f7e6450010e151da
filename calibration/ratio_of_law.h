#pragma once

#include <optional>

#include "continuum/rheology_table.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// Xi = b/(a gd) at half the flowing height (Brewster et al. 2008, eq. 10) of the steady flow that
/// a table of mu(I, p*, Bo) predicts for the chute of a run: stress and shear rate at the masses of
/// the measured rows, with their weights, fitted like measured ones, tau_c too for grains that
/// attract each other. The stress of such a law knows no lifetimes of contacts: this is the linear
/// part that softness and a yield dependent on pressure make by themselves. Nothing where fewer
/// than four rows flow. Throws FitError like fit_bagnold.
std::optional<double> ratio_of_law(const dem::LocalData& run,
                                   const continuum::RheologyTable& table);

}  // namespace grainlaw::calibration
