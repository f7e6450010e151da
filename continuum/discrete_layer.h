#pragma once

#include <span>
#include <vector>

#include "continuum/layer.h"

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

/// What a layer does at one time: velocity in the cells, scaled shear rate q = K |du/dM| and stress
/// at their lower faces.
struct Motion {
  std::vector<double> velocity;
  std::vector<double> rate;
  std::vector<double> stress;
};

/// A layer on its grid, units d = rho_p = g = 1: everything that does not depend on how its motion
/// is integrated. Faces are named by the cell above them; the last one is the base.
class DiscreteLayer {
 public:
  DiscreteLayer(const Layer& layer, MassGrid grid);

  const Layer& layer() const { return layer_; }
  const MassGrid& grid() const { return grid_; }
  std::size_t cells() const { return curves_.size(); }
  const FlowCurve& curve(std::size_t face) const { return curves_[face]; }

  /// Velocity of the cells whose faces shear with q, from the base up: every sum has terms of one
  /// sign, no difference of large numbers.
  std::vector<double> velocity(std::span<const double> q) const;
  /// The layer carried without acceleration by tau(q).
  Motion steady() const;
  /// At rest under a stress that the yield stress can hold, and that moves the layer as the rigid
  /// material would start to move: the largest convex stress below yield whose slope the drive can
  /// carry. A convex stress is an acceleration that nowhere falls towards the surface, and uniform
  /// wherever the stress stays below yield.
  Motion rest() const;

  /// Velocity of the lowest cell over a base face that shears with q, slip included, its slope, and
  /// the inverse.
  double base_velocity(double q) const;
  double base_velocity_slope(double q) const;
  double base_rate(double velocity) const;

  double mean_velocity(const Motion& motion) const;  ///< of the mass
  double largest_inertial_number(std::span<const double> q) const;
  /// Response of the surface velocity to the drive, du_s / d(g sin(theta)) = int M / (K tau') dM
  /// over the sheared part: the relaxation time to within 25 % (exact factor pi^2 / 8 for a linear
  /// law).
  double relaxation_time(std::span<const double> q) const;

  /// Rows at the base, the cell centres and the surface; the plug edge is that of the stress.
  Profile profile(const Motion& motion) const;
  /// Mass above the face where the stress meets the yield stress, and half a cell there.
  struct PlugEdge {
    double mass = 0.0;
    double uncertainty = 0.0;
  };
  PlugEdge plug_edge(std::span<const double> stress) const;

 private:
  Layer layer_;
  MassGrid grid_;
  std::vector<FlowCurve> curves_;  // at the lower face of every cell
};

}  // namespace grainlaw::continuum
