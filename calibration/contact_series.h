#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibration/fit_summary.h"
#include "calibration/ratio_laws.h"
#include "continuum/rheology_table.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// Heights at which Xi is read, as shares of the flowing height (Brewster et al. 2008, fig. 2).
inline constexpr std::array<double, 3> ratio_heights{0.25, 0.5, 0.75};

/// What one chute says of its rheology and of its contacts, side by side. Lifetimes are those of
/// one definition of a contact (d_c), scaled with the shear rate gd of the slice; not a number
/// where contacts were not followed.
struct ContactPoint {
  std::string name;
  std::string series;                        ///< of runs that differ in one property
  double stiffness = 0.0;                    ///< k_n d / (m g)
  double shear_rate = 0.0;                   ///< gd of the slice [1/time]
  double attraction = 0.0;                   ///< f_a, the largest of a pair [m g]
  std::array<FittedCoefficient, 3> ratio{};  ///< Xi = b/(a gd) at the three heights
  std::optional<double> ratio_of_law{};      ///< Xi at h/2 of the flow a table predicts
  dem::Estimate mean{};                      ///< gd times the mean lifetime
  dem::Estimate mode{};                      ///< gd times the most probable lifetime
  dem::Estimate long_lifetime{};             ///< gd tau_l, where P(gd t) = 0.1 (eq. 13)
  dem::Estimate collision_rate{};            ///< N_c in sqrt(g/d), counted for both grains
  dem::Estimate coordination{};              ///< N_c times the mean lifetime
  double contacts = 0.0;                     ///< lifetimes that were seen whole
  bool tail_sampled = false;                 ///< gd tau_l rests on enough long contacts

  bool has_lifetimes() const { return contacts > 0.0; }
};

/// Spearman's rank correlation with Xi at half height, over the runs that have both.
struct RankCorrelation {
  std::string with;
  double value = 0.0;  ///< -1 to 1
  int runs = 0;
};

/// Runs of one series as functions of their stiffness.
struct StiffnessLaws {
  std::string series;
  std::array<std::optional<RatioLaw>, 3> ratio{};  ///< Xi = J (k_n d/mg)^alpha, per height (eq. 11)
  std::optional<RatioLaw> collision_rate{};        ///< N_c likewise (fig. 7)
  std::optional<RatioLaw> mean_lifetime{};         ///< gd-free mean lifetime in sqrt(d/g) (fig. 3)
};

/// What many chutes say together.
struct ContactSeries {
  std::vector<ContactPoint> points;
  std::vector<StiffnessLaws> stiffness;  ///< of every series with three stiffnesses or more
  std::optional<RatioLaw> lifetime_law;  ///< Xi = c1 exp(c2 gd tau_l), all series (eq. 14)
  std::vector<RankCorrelation> correlations;
  std::vector<std::string> left_out;  ///< sentences: runs and laws that could not be had
};

/// One run of a series.
struct SeriesRun {
  std::string series;
  const dem::LocalData* run = nullptr;
};

/// Fits the generalised Bagnold law to every run for its Xi, and the laws of Xi over all.
/// `distance` is the index of the contact definition among those of the runs. Runs that are not
/// steady or cannot be fitted are named. With a table, Xi of the flow it predicts stands beside the
/// measured one (see ratio_of_law). Never throws FitError.
ContactSeries contact_series(std::span<const SeriesRun> runs,
                             std::size_t distance,
                             const RatioRule& rule = {},
                             const continuum::RheologyTable* table = nullptr);

/// m g of a mean grain [force].
double grain_weight(const dem::ChuteConditions& grains);

/// Spearman's rank correlation; ties take their mean rank. NaN for fewer than 3 pairs,
/// and where one side has one value only.
double rank_correlation(std::span<const double> x, std::span<const double> y);

}  // namespace grainlaw::calibration
