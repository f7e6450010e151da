#pragma once

#include <optional>
#include <vector>

#include "continuum/answer.h"
#include "continuum/rheology_table.h"

namespace grainlaw::continuum {

/// Ring cell whose bottom is split at R_s: the part outside turns with the outer wall. All of this
/// is geometry of a given shape of band, not a solution of the flow, for which see ring_flow.h.
struct SplitBottomCase {
  double split_radius = 0.0;   ///< R_s [length]
  double depth = 0.0;          ///< H of the filling [length]
  double rotation_rate = 0.0;  ///< Omega of the outer part [rad/time]
  double gravity = 1.0;        ///< [length/time^2]
  /// W at the free surface; absent: d (H/d)^(2/3), the trend of experiments with prefactor 1
  /// [length]
  std::optional<double> surface_width{};
  GrainProperties grains{};
};

/// Throws std::invalid_argument for a cell without meaning.
void check(const SplitBottomCase& cell);

/// Grains in units d = rho_p = g = 1.
GrainProperties dimensionless_grains(const SplitBottomCase& cell);

/// Paths r(z) of least torque int r^2 p sqrt(1 + r'^2) dz from the split to the free surface, with
/// p of the weight (Unger, Toeroek, Kertesz & Wolf 2004). In units of R_s.
struct BandPaths {
  std::vector<double> surface_radius;  ///< of every open path that ends at the split, largest first
};

BandPaths least_torque_paths(double depth_over_split_radius);

/// R_c / R_s = 1 - (H/R_s)^(5/2) at the free surface  (Fenistein, van de Meent & van Hecke 2004).
double measured_surface_radius(double depth_over_split_radius);

/// Share of Omega at r: 1/2 + 1/2 erf((r - R_c) / W).
double rotation_share(double radius, double centre, double width);

/// W(z) inside the filling, W_top sqrt(1 - (1 - z/H)^2): a quarter ellipse  (Ries, Wolf & Unger
/// 2007).
double inner_width(double height_over_depth, double surface_width);

/// The centre of the band at one height.
struct SplitBottomRow {
  double z = 0.0;                ///< above the bottom [length]
  double radius = 0.0;           ///< R_c [length]
  double width = 0.0;            ///< W [length]
  double pressure = 0.0;         ///< of the weight above [stress]
  double shear_rate = 0.0;       ///< R_c Omega / (W sqrt(pi)) there [1/time]
  double inertial_number = 0.0;  ///< I
  double friction = 0.0;         ///< mu(I, p*, Bo) of the table; 0: the table has none there
  double volume_fraction = 0.0;  ///< phi(I, p*, Bo)
};

struct SplitBottom {
  Answer answer;
  double path_radius = 0.0;          ///< R_c of the least torque at the free surface [length]
  double measured_radius = 0.0;      ///< R_c of the experimental power law there [length]
  double surface_width = 0.0;        ///< W there [length]
  double torque = 0.0;               ///< on the outer part, over the whole circle [force length]
  std::vector<SplitBottomRow> rows;  ///< bottom to top; empty where the answer is not STEADY
};

/// Band centre, profile and the state of the material at its centre. No open path, or more than
/// one: NOT_CONVERGED with the sentence, nothing is picked. So soft that no friction is left at the
/// bottom: NO_STEADY. Throws TableError and
/// std::invalid_argument like shear_band.
SplitBottom split_bottom(const RheologyTable& table, const SplitBottomCase& cell, int rows = 101);

}  // namespace grainlaw::continuum
