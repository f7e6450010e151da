#pragma once

#include <span>
#include <vector>

#include "continuum/band_cholesky.h"
#include "continuum/flow_curve.h"
#include "continuum/ring_mesh.h"

namespace grainlaw::continuum {

/// The nonlocal fluidity g = gd / mu (see nonlocal_fluidity.h) of a given field of shear rates
/// instead of stresses: with tau = p gd / g in gain and loss,
///     0 = A^2 d^2 lap g + R(g, gd),     R = (b / p) g (e / (b - kappa e) - gd d sqrt(rho_p / p)),
/// e = p gd / g - tau_y and b, kappa, tau_y of the flow curve. R falls with g for every g above
/// gd over the largest friction, so there is one solution, and Newton's matrix is positive. No flux
/// through walls and surface. Units d = rho_p = 1.
class RingFluidity {
 public:
  /// `pressures`: of every row of cells. The law has to outlive this.
  RingFluidity(const RingMesh& mesh,
               const MuPhi& law,
               const GrainProperties& grains,
               std::vector<double> pressures,
               double amplitude);

  /// g of every cell; A = 0: that of the local law. `g` (may be empty) is where Newton starts.
  /// Throws SolverError where it does not converge.
  void solve(std::span<const double> shear_rates, std::vector<double>& g);

 private:
  struct Reaction {
    double value = 0.0;
    double slope = 0.0;  ///< dR/dg, negative
  };
  Reaction reaction(std::size_t row, double shear_rate, double g) const;
  double local(std::size_t row, double shear_rate) const;
  double least(std::size_t row, double shear_rate) const;
  template <class Visit>
  void visit_faces(Visit visit) const;
  bool newton_step(std::span<const double> shear_rates, std::vector<double>& g);

  const RingMesh& mesh_;
  const MuPhi& law_;
  GrainProperties grains_;
  std::vector<double> pressures_;
  std::vector<FlowCurve> curves_;  ///< of every row
  double amplitude_;
  BandCholesky matrix_;  ///< of Newton, cells up every column
};

}  // namespace grainlaw::continuum
