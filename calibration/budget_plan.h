#pragma once

#include <span>
#include <string>
#include <vector>

#include "calibration/design.h"
#include "calibration/fittable_law.h"
#include "continuum/chute_1d.h"
#include "continuum/rheology_table.h"
#include "dem/estimate.h"

namespace grainlaw::calibration {

/// The order in which places cover the space they span: the two farthest apart, then always the one
/// farthest from all before it. Coordinates count relative to their span; equal distances go to the
/// first in the list. Throws std::invalid_argument for places of different length.
std::vector<std::size_t> spread_order(const std::vector<std::vector<double>>& places);

/// How many coordinates of the places vary.
int varied_coordinates(const std::vector<std::vector<double>>& places);

/// The coefficients of mu(I, p*, Bo) that further runs can improve: those the table states errors
/// of, and kappa where a fit left it out (a law without exponent): data too few to tell a curvature
/// do not make the law straight. Empty for a table without errors.
std::vector<std::string> friction_coefficients(const continuum::RheologyTable& table);

/// Derivatives of mu at a state by these coefficients of the table.
std::vector<double> friction_gradient(const continuum::RheologyTable& table,
                                      const std::vector<std::string>& coefficients,
                                      const State& state);

/// Relative derivatives of the surface velocity of a steady chute by these coefficients, d ln u_s /
/// d c: large where the condition number is. Empty where the chute does not flow.
std::vector<double> velocity_gradient(const continuum::RheologyTable& table,
                                      const std::vector<std::string>& coefficients,
                                      const continuum::ChuteCase& chute);

/// Surface velocity of a steady chute with its standard error by the covariance of the table
/// [length/time]; not a number where the chute does not flow.
dem::Estimate surface_velocity(const continuum::RheologyTable& table,
                               const continuum::ChuteCase& chute);

/// The error that mu alone would have to have to tell the law as little as the errors of mu and I
/// do together: sqrt(s_mu^2 + (dmu/dI s_I)^2) (effective variance).
double effective_friction_error(const continuum::RheologyTable& table,
                                const State& state,
                                double friction_error,
                                double inertial_number_error);

/// A setting at which a run may be made.
struct Candidate {
  State state;
  double run = 0.0;      ///< that would be made, warm-up included [s]
  double warm_up = 0.0;  ///< before averaging begins [s]
  double noise = 0.0;    ///< effective standard error of mu after averaging for one second
};

/// What a finished run told.
struct Observation {
  State state;
  double error = 0.0;  ///< effective, of mu
};

/// Sum of g g^T / s^2 over the observations (row-major), g the gradients of mu. Of a kappa that the
/// fit left out no more is known beforehand than that it is 0 within 4: 1/I_mu is 1.4 for spheres
/// of mu_p = 0.5 (Shi et al. 2020, Table 7), 3.6 for glass beads (Jop et al., Nature 441 (2006)
/// 727).
std::vector<double> information_of(const continuum::RheologyTable& table,
                                   const std::vector<std::string>& coefficients,
                                   std::span<const Observation> observations);

/// The candidate with the largest V-optimal share of `seconds` of DEM, of which every run loses its
/// warm-up: the one the predictions miss most. `targets` are gradients of what will be predicted.
/// Candidates whose warm-up takes all of their run are passed over. Throws
/// std::invalid_argument where none is left.
std::size_t most_wanted(const continuum::RheologyTable& table,
                        const std::vector<std::string>& coefficients,
                        std::span<const Candidate> candidates,
                        std::span<const std::vector<double>> targets,
                        const std::vector<double>& known,
                        double seconds);

}  // namespace grainlaw::calibration
