#pragma once

#include <optional>
#include <vector>

#include "continuum/answer.h"
#include "continuum/rheology_table.h"
#include "continuum/shear_band.h"
#include "continuum/split_bottom.h"

namespace grainlaw::continuum {

/// A ring cell with a split bottom between two rough cylinders: the inner one and the bottom inside
/// the split rest, the outer ones turn. Depth, rotation rate, gravity and grains as in the cell;
/// its surface width plays no part here.
struct RingFlowCase {
  SplitBottomCase cell{};
  double inner_radius = 0.0;  ///< [length]
  double outer_radius = 0.0;  ///< [length]
  /// A of the nonlocal granular fluidity; absent or 0: the local law.
  std::optional<double> nonlocal_amplitude{};
};

struct RingFlowOptions {
  double cell_width = 0.25;  ///< of the mesh [d]
};

/// The band at one height.
struct RingFlowRow {
  double z = 0.0;       ///< above the bottom [length]
  double centre = 0.0;  ///< R_c, where omega is half of Omega [length]
  /// W, the distance between the radii where an error function has omega / Omega = 1/2 +- 1/2
  /// erf(1/2) [length]
  double width = 0.0;
  // at the largest shear rate of this height
  double shear_rate = 0.0;       ///< [1/time]
  double pressure = 0.0;         ///< [stress]
  double friction = 0.0;         ///< tau / p
  double inertial_number = 0.0;  ///< I
  double volume_fraction = 0.0;  ///< phi(I, p*, Bo)
};

struct RingFlow {
  Answer answer;
  std::vector<double> r;          ///< of the nodes [length]
  std::vector<double> z;          ///< of the nodes, 0: the bottom [length]
  std::vector<double> rotation;   ///< omega / Omega of the nodes, z by z; empty without an answer
  std::vector<RingFlowRow> rows;  ///< bottom to top
  /// Local law, and a band thinner than thinnest_credible_band at all heights.
  bool local_band_collapse = false;
  double torque = 0.0;  ///< on the outer part, over the whole circle [force length]
  /// Relative L2 distance of the velocities from those on cells twice as wide: the jump at the
  /// split makes the method one of first order, so that this is the error itself.
  double discretisation_error = 0.0;
  int iterations = 0;  ///< on the finer cells
  double wall_seconds = 0.0;

  /// omega / Omega at a place, bilinear between nodes.
  double rotation_at(double radius, double height) const;
};

/// Steady rotation omega(r, z) by a law mu(I, p*, Bo), local or nonlocal: torque balance
/// div(r^3 eta grad omega) = 0 with tau = eta gd along the shear rate, gd = r |grad omega|, p the
/// weight at phi(I -> 0) (Jop, Phys. Rev. E 77 (2008) 032301; Henann & Kamrin, PNAS 110 (2013)
/// 6730). No slip at cylinders and bottom; no flux of fluidity through them. What rests is sheared
/// at 1e-6 Omega R_s / d, where the friction of the law is met by any rate. Bilinear elements; the
/// fixed point of "viscosity from shear rate, rotation from viscosity" by Anderson's acceleration:
/// the local one descends in the dissipation potential, which is convex.
/// No friction left at the bottom: NO_STEADY. I beyond I_phi at half of the heights:
/// NO_DENSE_STATE. Too many iterations: NOT_CONVERGED. Throws TableError and std::invalid_argument
/// like shear_band.
RingFlow ring_flow(const RheologyTable& table,
                   const RingFlowCase& ring,
                   const RingFlowOptions& options = {});

}  // namespace grainlaw::continuum
