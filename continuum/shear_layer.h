#pragma once

#include <span>
#include <string>
#include <vector>

#include "continuum/layer.h"
#include "continuum/ode_solver.h"

namespace grainlaw::continuum {

/// Finite volumes in the mass above, faces at M1 (k/N)^grading. The grading 3/2 restores second
/// order where stress laws start with sqrt(M) at the free surface; centres at half-integer k keep
/// the error of the midpoint differences there small as well.
struct MassGrid {
  std::vector<double> face;      ///< lower one of every cell; the last is M1
  std::vector<double> centre;    ///< of the cells, M1 ((k + 1/2)/N)^grading
  std::vector<double> width;     ///< of the cells
  std::vector<double> distance;  ///< from a centre to the next one below, or to the base

  MassGrid(double mass, int cells, double grading);
  std::size_t cells() const { return width.size(); }
};

/// Momentum balance of a layer by the method of lines, units d = rho_p = g = 1:
///     du/dt = sin(theta) - dtau/dM   in cells,   q = K |du/dM|, tau = tau(q)   at faces,
/// with q as the state, since a tolerance on u would let noise set the shear rate near the surface:
///     dq_k/dt = K_k (acceleration above - acceleration below) / distance_k.
/// Unknown k belongs to the lower face of cell k; the base has u = 0. A yield stress is multiplied
/// by q / sqrt(q^2 + delta^2)  (Bercovier and Engelman 1980); delta = 0 keeps tau(q -> 0+) = tau_y,
/// which is right as long as every face shears forwards from the start.
class ShearLayer : public OdeSystem {
 public:
  ShearLayer(const Layer& layer, MassGrid grid, double delta);

  void rate(double t, std::span<const double> q, std::span<double> dqdt) const override;
  void jacobian(double t, std::span<const double> q, TridiagonalView matrix) const override;
  /// Crosses zero where I reaches I_phi (1 - 1e-3): the dense state is lost.
  double event(double t, std::span<const double> q) const override;
  std::string component_name(std::size_t i) const override;

  std::size_t size() const { return curves_.size(); }
  double acceleration(std::span<const double> q, std::size_t cell) const;
  double largest_acceleration(std::span<const double> q) const;  ///< max |du/dt| over the cells
  double surface_acceleration(std::span<const double> q) const { return acceleration(q, 0); }
  double largest_inertial_number(std::span<const double> q) const;

  double mean_velocity(std::span<const double> q) const;  ///< of the mass

  /// q at which tau(q) carries the layer without acceleration.
  std::vector<double> steady_state() const;
  /// Response of the surface velocity to the drive, du_s / d(g sin(theta)) = int M / (K tau') dM
  /// over the sheared part, without regularisation: the relaxation time to within 25 % (exact
  /// factor pi^2 / 8 for a linear law).
  double relaxation_time(std::span<const double> q) const;

  /// Rows at the base, the cell centres and the surface. `plug_mass` is passed on.
  Profile profile(std::span<const double> q, double plug_mass) const;
  Profile at_rest() const;  ///< with the static stress that balances the weight
  /// Mass above the face where the stress meets the yield stress, and half a cell there.
  struct PlugEdge {
    double mass = 0.0;
    double uncertainty = 0.0;
  };
  PlugEdge plug_edge(std::span<const double> q) const;

 private:
  double stress(std::size_t face, double q) const;
  double slope(std::size_t face, double q) const;
  Profile rows(std::span<const double> q, const std::vector<double>& stress) const;

  Layer layer_;
  MassGrid grid_;
  double delta_;
  std::vector<FlowCurve> curves_;  // at the lower face of every cell
};

/// Whether part of a layer rests while other parts shear: a yield stress that is not proportional
/// to the depth. A proportional one lets the whole layer start as one block.
bool needs_regularisation(const Layer& layer);

}  // namespace grainlaw::continuum
