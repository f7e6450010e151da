#pragma once

#include <span>
#include <string>
#include <vector>

#include "calibration/fit_summary.h"
#include "calibration/model_choice.h"
#include "continuum/rheology_table.h"
#include "dem/estimate.h"

namespace grainlaw::calibration {

/// One measured state of flow with one I, p*, Bo each: a run of simple shear, or one slice of a
/// heterogeneous flow that is independent of the other slices.
struct StatePoint {
  std::string name;
  dem::Estimate inertial_number;
  dem::Estimate softness{0.0, 0.0};     ///< p*; 0: rigid grains
  dem::Estimate bond_number{0.0, 0.0};  ///< Bo; 0: cohesionless
  dem::Estimate friction{};             ///< mu
  dem::Estimate volume_fraction{};      ///< phi
  double correlation = 0.0;             ///< of the errors of mu and phi, which share their run
  std::string run{};                    ///< it was measured in; empty: one of its own
  double place = 0.0;                   ///< of its row in that run [length]
  double wall_seconds = 0.0;            ///< that run cost; 0: not known
  std::string unfit{};                  ///< why no law is fitted to it; empty: it may be
};

/// What happens to points outside the range of a law.
enum class OutOfRange {
  leave_out,
  weigh_less,  ///< Huber's loss beyond 2.5 standard errors, for these points only
  keep,
};

/// Where the laws were found to hold: Shi et al. 2020, section 3.1 (phi) and appendix 1 (mu).
struct FitRange {
  double least_volume_fraction = 0.5;
  continuum::Range friction_inertial_number{0.005, 0.5};
  double friction_softness = 0.1;  ///< p* below
  double fraction_inertial_number = 0.25;
  double fraction_softness = 0.03;
  OutOfRange outside = OutOfRange::leave_out;
};

struct MaterialFitOptions {
  FitRange range;
  double contact_friction = 0.0;  ///< mu_p of the grains, for the table
  std::string cohesion;           ///< mechanism that Bo measures, in words; empty: none
};

/// mu(I, p*, Bo) and phi(I, p*, Bo) of one kind of grains.
struct MaterialFit {
  continuum::RheologyTable table;
  /// mu0, beta and what the data need of kappa, exponent, p_mu, cohesion_alpha, cohesion_beta,
  /// cohesion_factor, cohesion_bond_exponent, cohesion_softness_exponent; derived: mu_inf, I_mu,
  /// and alpha of the law linear in Bo.
  FitSummary friction;
  FitSummary volume_fraction;               ///< phi0 and what the data need of I_phi, p_phi, p1..p4
  std::vector<ModelScore> families;         ///< of the friction law; empty: too few p* or Bo to ask
  std::vector<ModelScore> friction_models;  ///< terms dropped one at a time
  std::vector<ModelScore> fraction_models;
  std::vector<double> friction_weight;  ///< per point: 1 used, below 1 weighs less, 0 left out
  std::vector<double> fraction_weight;
};

/// Fits both laws by effective variance. Terms that the data cannot know or do not need are
/// dropped, with a sentence each. The family of the friction law is chosen by AICc where there are
/// at least 4 values of p* and 5 of Bo, and is that of Shi et al. 2020 otherwise. Throws FitError
/// when fewer than two different I are left or a law does not converge.
MaterialFit fit_material(std::span<const StatePoint> points,
                         const MaterialFitOptions& options = {});

/// How many different values a quantity takes: those within 10 % of each other count once.
int count_levels(std::vector<double> values);

}  // namespace grainlaw::calibration
