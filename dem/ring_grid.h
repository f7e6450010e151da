#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "dem/kernel.h"

namespace grainlaw::dem {

struct ChuteConditions;

/// Sums over the grains and contacts of one cell of a ring, from which its fields follow. They are
/// additive and extensive: their sums over all cells are those over all grains and contacts.
/// Vectors have the components azimuthal, axial, radial (x, y, z below); offsets are those of grain
/// centres from the centre of the cell, along r and z.
struct CellMoments {
  double mass = 0.0;
  double grains = 0.0;                         ///< number of centres
  double contacts = 0.0;                       ///< incidences: every contact once per grain
  std::array<double, 3> momentum{};            ///< sum m v
  std::array<double, 6> momentum_flux{};       ///< sum m v v: xx yy zz xy xz yz
  std::array<double, 2> mass_offset{};         ///< sum m o: r z
  std::array<double, 3> mass_offset_square{};  ///< sum m o o: rr zz rz
  std::array<double, 3> momentum_offset_r{};   ///< sum m o_r v
  std::array<double, 3> momentum_offset_z{};   ///< sum m o_z v
  std::array<double, 9> contact_stress{};      ///< sum of force times branch: xx yy zz xy xz yz yx
                                               ///< zx zy, compression positive
};

/// sum += factor * moments, of a cell whose centre lies at (shift_r, shift_z) from that of the sum.
void add_cell(
    CellMoments& sum, const CellMoments& moments, double shift_r, double shift_z, double factor);

/// Square cells over radius and height of a wedge, [z][r]. They reach beyond walls, bottom and
/// surface as far as the kernel does.
struct RingGrid {
  double wedge = 0.0;       ///< [rad]
  double r_begin = 0.0;     ///< [length]
  double z_begin = 0.0;     ///< [length]; z = 0: highest grain of the bottom + d/2
  double width = 1.0;       ///< of a cell, in r and z [length]
  std::size_t columns = 0;  ///< along r
  std::size_t rows = 0;     ///< along z
  Kernel kernel{};

  std::size_t size() const { return rows * columns; }
  std::size_t index(std::size_t column, std::size_t row) const { return row * columns + column; }
  double radius(std::size_t column) const {  ///< of the centre [length]
    return r_begin + (static_cast<double>(column) + 0.5) * width;
  }
  double height(std::size_t row) const {  ///< of the centre [length]
    return z_begin + (static_cast<double>(row) + 0.5) * width;
  }
  double volume(std::size_t column) const { return wedge * radius(column) * width * width; }
};

/// Averages over one stretch of time, of sums that are already smoothed.
struct RingFrame {
  int samples = 0;
  std::vector<CellMoments> cells{};  ///< of a RingGrid
};

/// Fields at one place (r, z). Numbers only, so that all are averaged and given errors alike.
struct RingField {
  double velocity = 0.0;          ///< azimuthal, v [length/time]
  double angular_velocity = 0.0;  ///< v / r [1/time]
  double shear_rate_r = 0.0;      ///< dv/dr - v/r [1/time]
  double shear_rate_z = 0.0;      ///< dv/dz [1/time]
  double shear_rate = 0.0;        ///< root of the sum of their squares [1/time]
  double volume_fraction = 0.0;   ///< phi
  double shear_stress_r = 0.0;    ///< -sigma_phi_r, contact + kinetic [stress]
  double shear_stress_z = 0.0;    ///< -sigma_phi_z, contact + kinetic [stress]
  double shear_stress = 0.0;      ///< tau, root of the sum of their squares [stress]
  double pressure = 0.0;          ///< p, a third of the trace, contact + kinetic [stress]
  double normal_stress = 0.0;     ///< sigma_zz, z the height, contact + kinetic [stress]
  double friction = 0.0;          ///< tau / p
  double inertial_number = 0.0;   ///< from p (Shi et al. 2020, eq. 10)
  double softness = 0.0;          ///< p* from p (Shi et al. 2020, eq. 11)
  double temperature = 0.0;       ///< mean square fluctuation per component [(length/time)^2]
  double coordination = 0.0;      ///< Z, every contact counted for both grains
};

/// Fields over the grid with their standard errors, [z][r]; not a number where hardly any grain is.
struct RingFields {
  RingGrid grid;
  std::vector<RingField> values;
  std::vector<RingField> errors;
};

/// Fields of the sums in a cell of given radius and volume. Velocity is a plane in (r, z) through
/// the velocities of the grains, weighted with mass and kernel: a flow v = a + b r + c z has
/// exactly its gradient, and no fluctuation, wherever grains are, so that a rigid rotation has
/// neither shear rate nor temperature. Fluctuations are those about that plane, at the grain. v = r
/// w(z) has the shear rate (r + s^2/r) |w'| in place of r |w'|, s^2 = variance of the kernel +
/// width^2 / 12. Roots of sums of squares are biased upwards where their errors are as large as
/// they are.
RingField ring_field(const CellMoments& cell,
                     double radius,
                     double volume,
                     const ChuteConditions& conditions);

/// Fields of the mean over frames; errors by block averages of what each frame adds to the field,
/// to first order in its distance from the mean (as for profiles). Empty without frames.
RingFields ring_fields(const RingGrid& grid,
                       std::span<const RingFrame> frames,
                       const ChuteConditions& conditions);

}  // namespace grainlaw::dem
