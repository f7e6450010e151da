#pragma once

#include <optional>
#include <vector>

#include "continuum/profile.h"
#include "continuum/rheology_table.h"

namespace grainlaw::continuum {

// May a law be used in a code that resolves two or three dimensions? For tau_ij = T(p, gd) D_ij/|D|
// in incompressible plane shear a short wave in the direction e, with a = e.D.e/|D| in [-1, 1],
// grows at the rate
//     -k^2 (T / 2|D|) (1 - (1 - q) (1 - a^2) / (1 - r a)),  q = dlnT/dln gd,  r = dT/dp at fixed
//     gd,
// so no direction grows without bound if and only if |r| < 1 and
//     F = min over a of q - r a + (1 - q) a^2 >= 0.
// For mu(I) this is the condition of Barker et al. 2015 (J. Fluid Mech. 779, 794). A wave
// vector out of the plane of shear has e1^2 + e2^2 - a^2 <= 1 - a^2 in place of 1 - a^2 and is
// never worse: F decides for plane shear in three dimensions too. The one-dimensional flows of this
// program have a = 0 and need only q > 0.

/// A dimensionless state of flowing grains.
struct FlowState {
  double inertial_number = 0.0;  ///< I
  double softness = 0.0;         ///< p*; 0: rigid
  double bond_number = 0.0;      ///< Bo; 0: cohesionless
};

struct WellPosedness {
  double rate_exponent = 0.0;   ///< q
  double pressure_slope = 0.0;  ///< r
  double margin = 0.0;          ///< F; negative: ill-posed
  double direction = 0.0;       ///< a of the worst direction

  /// F >= 0 leaves |r| = 1 with q = 1/2 only, where a wave grows at an indefinite rate.
  bool holds() const { return margin >= 0.0 && pressure_slope < 1.0 && pressure_slope > -1.0; }
};

/// F and its worst direction for given q and r.
WellPosedness well_posedness(double rate_exponent, double pressure_slope);

/// F of the law at a state; absent where softness takes all friction and no law is left. Under
/// generalised Bagnold, whose stress knows no pressure, give the shear rate in the units of a and b
/// in place of I.
std::optional<WellPosedness> well_posedness(const RheologyTable& table, const FlowState& at);

/// Limits of the search for intervals of I: below and above, nobody has data.
inline constexpr Range searched_inertial_numbers{1e-8, 1e4};

/// The intervals of I in which the law is well-posed at one p* and Bo, ascending, ends to 1e-10
/// relative. 0 or infinity: to the end of the search. Empty: nowhere.
std::vector<Range> well_posed_intervals(const RheologyTable& table,
                                        double softness,
                                        double bond_number);

struct CertifiedConfinement {
  double softness = 0.0;
  double bond_number = 0.0;
  std::vector<Range> intervals;  ///< of I
};

/// The map of a table: rigid or cohesionless grains and the decades of p* and small whole Bo up to
/// the end of the table's range; only those numbers that the law depends on. Of generalised Bagnold
/// one entry, well-posed at all rates: r = 0 and q > 0.
std::vector<CertifiedConfinement> well_posedness_map(const RheologyTable& table);

/// The certificate at one state, with what the table's covariance leaves open.
struct CertifiedState {
  FlowState at;
  WellPosedness well_posedness;
  std::optional<double> margin_error{};  ///< one standard error of F; absent: no covariance
  std::optional<double> ill_posed_probability{};  ///< P[F < 0], F taken as normal
};

/// Absent where well_posedness() is.
std::optional<CertifiedState> certify(const RheologyTable& table, const FlowState& at);

/// The certificate of a predicted flow.
struct CertifiedFlow {
  CertifiedState worst;             ///< of the sheared rows, by margin
  double ill_posed_fraction = 0.0;  ///< of the sheared rows, those at F < 0
};

/// Absent where nothing shears.
std::optional<CertifiedFlow> certify(const RheologyTable& table,
                                     const Profile& profile,
                                     const GrainProperties& grains);

}  // namespace grainlaw::continuum
