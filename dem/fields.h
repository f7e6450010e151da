#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "dem/profile_frames.h"

namespace grainlaw::dem {

struct ChuteConditions;

/// All coarse-grained fields at one place. Numbers only, so that all are averaged and given errors
/// alike. Components: x y z; xx yy zz xy xz yz; and of contact stress in addition yx zx zy, force
/// first, branch second. A ring cell has azimuthal, axial, radial for x, y, z.
struct FieldRow {
  double velocity = 0.0;             ///< v_x [length/time]
  double shear_rate = 0.0;           ///< d v_x along the axis; imposed, in a sheared box [1/time]
  double volume_fraction = 0.0;      ///< phi
  double shear_stress = 0.0;         ///< contact + kinetic, positive down the slope [stress]
  double normal_stress = 0.0;        ///< sigma_zz or sigma_yy, contact + kinetic [stress]
  double pressure = 0.0;             ///< a third of the trace, contact + kinetic [stress]
  double temperature = 0.0;          ///< mean square fluctuation per component [(length/time)^2]
  double inertial_number = 0.0;      ///< from normal_stress (Shi et al. 2020, eq. 10)
  double softness = 0.0;             ///< from normal_stress (Shi et al. 2020, eq. 11)
  double friction = 0.0;             ///< shear_stress / normal_stress
  double coordination = 0.0;         ///< Z, contacts of a grain, each counted for both
  double dissipation = 0.0;          ///< of a contact [power]
  double sliding_share = 0.0;        ///< of contacts; NaN for grains without friction
  double sliding_dissipation = 0.0;  ///< share of the dissipation that is by sliding; or NaN
  double mass_above = 0.0;           ///< per area, averaged as stress is [mass/length^2]
  double density = 0.0;              ///< [mass/length^3]
  std::array<double, 3> momentum{};  ///< density
  std::array<double, 3> velocity_gradient{};  ///< d v_a along the axis [1/time]
  std::array<double, 9> contact_stress{};     ///< compression positive [stress]
  std::array<double, 6> kinetic_stress{};     ///< compression positive [stress]
  std::array<double, 3> wall_force{};         ///< of walls on grains [force/length^3]
  std::array<double, 3> wall_force_above{};   ///< per area, averaged as stress is [stress]
  std::array<double, 6> fabric{};             ///< mean of n n over contacts, trace 1
};

/// What a frame, or a mean over frames, holds of all bins.
struct FrameMoments {
  std::vector<BinMoments> bins;
  std::vector<SlidingMoments> sliding;
};
FrameMoments mean_moments(std::span<const ProfileFrame> frames);

/// Rows of fields beyond the bins, below and above, into which the kernel smears them.
std::size_t margin_rows(const ProfileFrames& grid, const Kernel& kernel);

/// Coarse graining (Goldhirsch, Granular Matter 12 (2010) 239) of moments in fine bins with a
/// kernel along the axis; every row is the average over its height, so that sums over rows are the
/// sums over all grains and contacts. Row k of the result is row k - margin_rows of the grid.
///  - Density, momentum and stress are not renormalised at walls. Stress of contacts with walls
///    runs from the centre to the contact point, where the wall_force t enters: rho Dv/Dt =
///    rho g + t - div sigma, compression positive (Weinhart et al., Granular Matter 14 (2012) 289,
///    eqs. 20-24). In steady flow stress along the axis, mass_above g and wall_force_above balance
///    in every row, exactly in the mean.
///  - Velocity and its gradient: straight line through the velocities, weighted with mass and
///    kernel. In a flow v = a + b z it is exact wherever grains are, next to walls too.
///  - Kinetic stress and temperature: fluctuations about that line of the grain's own bin, at the
///    grain. So no part of the gradient enters; a curved profile leaves
///    rho (v'' s^2 / 2)^2, s^2 the variance of the kernel.
std::vector<FieldRow> coarse_grain(const FrameMoments& moments,
                                   const ProfileFrames& grid,
                                   const Kernel& kernel,
                                   const ChuteConditions& conditions);

}  // namespace grainlaw::dem
