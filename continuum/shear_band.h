#pragma once

#include <optional>
#include <variant>

#include "continuum/answer.h"
#include "continuum/profile.h"
#include "continuum/rheology_table.h"

namespace grainlaw::continuum {

/// What turns a wall: exactly one of its speed and the shear stress on it.
struct WallDrive {
  std::optional<double> velocity{};  ///< [length/time]
  std::optional<double> stress{};    ///< [stress]
};

/// How much material lies between the walls: exactly one of the two.
struct Extent {
  std::optional<double> height{};         ///< [length]
  std::optional<double> mass_per_area{};  ///< [mass/length^2]
};

/// A layer on a wall at rest, sheared by the loaded wall above it: tau is uniform and p = load + g
/// M with M the mass above.
struct PlaneShear {
  WallDrive drive{};
  Extent extent{};
  double load = 0.0;     ///< normal stress on the moving wall [stress]
  double gravity = 0.0;  ///< towards the wall at rest [length/time^2]
};

/// A periodic box without walls driven by the force per mass F sin(2 pi y / height) along x, under
/// uniform sigma_yy; dtau/dy = -rho F sin(2 pi y / height). Two bands per period, around y = 0 and
/// y = height / 2.
struct BodyForceBox {
  Extent extent{};         ///< of one period
  double amplitude = 0.0;  ///< F [length/time^2]
  double pressure = 0.0;   ///< sigma_yy [stress]
};

/// Between two upright cylinders, the inner one turning: tau = tau_i (R_i / r)^2, p uniform. The
/// velocity of the drive is that of the inner wall.
struct AnnularShear {
  WallDrive drive{};
  double inner_radius = 0.0;  ///< [length]
  double outer_radius = 0.0;  ///< [length]
  double pressure = 0.0;      ///< [stress]
};

struct ShearBandCase {
  std::variant<PlaneShear, BodyForceBox, AnnularShear> flow;
  GrainProperties grains{};
  /// A of the nonlocal granular fluidity; absent or 0: the local law.
  std::optional<double> nonlocal_amplitude{};
};

struct ShearBandOptions {
  int cells = 400;  ///< to begin with; doubled until the error is small enough
  int most_cells = 12800;
  double discretisation = 1e-4;  ///< largest discretisation error that is accepted
  int rows = 401;                ///< of the profile, at most
};

/// A local law gives bands as thin as the drive is slow; grains make them 5 to 10 d wide. Below
/// this thickness the local answer is no prediction of a width.
inline constexpr double thinnest_credible_band = 5.0;  // [d]

struct ShearBand {
  Answer answer;
  /// From the wall at rest up (plane shear, z), over one period (box, z for y), from the inner to
  /// the outer wall (annulus, z for r). Height and surface_velocity are those of the moving wall
  /// (annulus: outer radius), of the box its period and its largest velocity; flux of the box is
  /// that of half a period. mass_above of the annulus: towards the outer wall. Empty without flow.
  Profile profile;
  enum class Sought { velocity, stress };
  Sought sought = Sought::velocity;  ///< which of the two below was not given
  double error = 0.0;                ///< of the one sought, one standard error; see add_error
  double driving_stress = 0.0;    ///< largest tau: on the moving wall, in the box at y = 0 [stress]
  double driving_velocity = 0.0;  ///< of the moving wall; of the box the largest [length/time]
  double yielded_width = 0.0;     ///< thickness where tau exceeds the yield stress [length]
  double band_width = 0.0;        ///< thickness that takes 90 % of the velocity [length]
  bool local_band_collapse = false;  ///< local law, yielded_width below thinnest_credible_band
  /// Estimated and relative: of the velocity, or where that is given of the driving stress.
  double discretisation_error = 0.0;
  int cells = 0;
  int iterations = 0;  ///< Newton steps of the fluidity at the stress found; 0: local law
  double wall_seconds = 0.0;
};

/// Steady shear band. The stress follows from the force balance alone (in the box and under gravity
/// together with phi, by fixed-point iteration); where the wall speed is given its stress is found
/// from the velocity, which grows with it. Midpoint quadrature over the band, its edge at a cell
/// face (second order); with A the fluidity equation on cells graded towards the moving wall.
/// Throws TableError for a table that validate() refuses or that is no mu(I) law, and
/// std::invalid_argument for a case without meaning.
ShearBand shear_band(const RheologyTable& table,
                     const ShearBandCase& band,
                     const ShearBandOptions& options = {});

/// Fills `error` by linear propagation of the table's covariance; leaves 0 when the table states no
/// errors or a step of a coefficient leaves the steady flows, which is then said in the answer.
void add_error(ShearBand& band, const RheologyTable& table, const ShearBandCase& of);

}  // namespace grainlaw::continuum
