#pragma once

#include <optional>
#include <span>
#include <vector>

#include "continuum/flow_curve.h"

namespace grainlaw::continuum {

/// Finite volumes along one coordinate: a slab (all areas 1) or an annulus (areas r).
struct BandGrid {
  std::vector<double> area;      ///< of the faces, one more than cells
  std::vector<double> distance;  ///< across each face, of the values on its sides [d]
  std::vector<double> volume;    ///< of the cells

  std::size_t cells() const { return volume.size(); }
};

/// Terms of the fluidity equation in one cell, see below.
struct FluidityTerms {
  double gain = 0.0;
  double loss = 0.0;
};

/// Nonlocal granular fluidity in its primitive form  (Kamrin & Koval 2012; Henann & Kamrin 2014):
///     0 = A^2 d^2 lap g + gain g - loss g^2,      gd = g mu,
///     gain = Dmu (mu - mu_s) / (mu_2 - mu),       loss = (Dmu / I0) sqrt(rho_p d^2 / p) mu,
/// with mu_s, mu_2, Dmu = mu_2 - mu_s and I0 of mu(I) = mu_s + Dmu I / (I + I0); A = 0 is that law.
/// The form without cooperativity length has no singularity at mu = mu_s. Softness and cohesion
/// scale mu_s and mu_2 by f_p f_B, an extension without published test. Absent where mu >= mu_2.
/// Units d = rho_p = 1.
std::optional<FluidityTerms> fluidity_terms(const FlowCurve& curve, double tau, double pressure);

/// The equation above is that of a law linear in I where flow begins: throws TableError for a power
/// of I and a tabulated mu(I).
void require_linear_onset(const InertialFriction& law);

/// xi(mu) = A d sqrt((mu_2 - mu) / (Dmu |mu - mu_s|)), over which flow reaches into parts below
/// yield; infinite at mu = mu_s [d].
double cooperativity_length(double amplitude, const InertialFriction& law, double mu);

/// Depth below which a layer on a rough base (g = 0 there) does not flow at tan(theta) = mu,
/// pi/2 xi(mu): the first mode that grows; infinite for mu <= mu_s [d]  (Kamrin & Henann 2015).
double stop_depth(double amplitude, const InertialFriction& law, double mu);

/// What holds at an end of the grid; absent: no flux, dg/dn = 0.
using EndValue = std::optional<double>;

struct Fluidity {
  std::vector<double> g;  ///< per cell [1/time]; 0 everywhere: only the state at rest solves
  int iterations = 0;
  bool converged = false;
};

/// Largest solution g >= 0 of the equation above (g = 0 is always one, unless an end drives).
/// Newton from above: the equation is concave in g, so from any g above the solution every step
/// stays above it and descends: pseudo-transient continuation whose first time step may be
/// infinite. `guess` (may be empty) is used if it lies on that side after one step.
Fluidity solve_fluidity(const BandGrid& grid,
                        std::span<const FluidityTerms> terms,
                        double amplitude,
                        EndValue first = {},
                        EndValue last = {},
                        std::span<const double> guess = {});

}  // namespace grainlaw::continuum
