#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/fittable_law.h"
#include "calibration/least_squares.h"
#include "calibration/model_choice.h"

namespace grainlaw::calibration {

/// A law at the minimum with the active slots as unknowns.
struct SolvedLaw {
  std::vector<std::size_t> active;
  Slots<double> slots{};
  LeastSquaresProblem problem;  ///< with the weights of the minimum
  Minimum minimum;
  Uncertainty uncertainty;     ///< of the numbers of the fit, enlarged by `scatter`
  double scatter = 1.0;        ///< factor on the variances, see solve_law
  std::vector<double> kept;    ///< weight each datum kept, 1 unless flagged and far off
  std::vector<double> errors;  ///< of each datum as they weigh it, effective and enlarged by `kept`

  int unknown(std::size_t slot) const;  ///< its place among the active ones; -1: none
  int freedom() const { return static_cast<int>(minimum.residuals.size() - active.size()); }
  /// Rise of chi^2 at the end of a 95 % interval.
  double rise() const;
};

/// Effective variance in all three variables, s_y^2 + sum (dy/dx s_x)^2, and Huber's weight at 2.5
/// standard errors (Huber 1964) for flagged data only. Data of different runs are independent;
/// where they scatter about the law by more than their errors allow (5 % of chi^2), the errors are
/// enlarged to match (Birge 1932). The elements of `data` must stay as long as the
/// result is used.
SolvedLaw solve_law(const FittableLaw& law,
                    const std::vector<LawDatum>& data,
                    const std::vector<std::size_t>& active);

/// The law at the minimum under given weights, 1/error^2, from a start close to it. Throws FitError
/// where there is none.
Slots<double> solve_weighted(const FittableLaw& law,
                             const std::vector<LawDatum>& data,
                             const std::vector<std::size_t>& active,
                             const std::vector<double>& errors,
                             const Slots<double>& start);

/// A term that is not in the law, and why.
struct DroppedTerm {
  std::string name;
  std::string reason;
};

/// The smallest law that the data support.
struct SelectedLaw {
  SolvedLaw solved;
  std::vector<DroppedTerm> dropped;
  std::vector<ModelScore> scores;  ///< every law tried, with equal weights
};

/// Starts from the possible terms less those that `data` cannot know (`unknowable`), then drops one
/// at a time the term that is least needed, while the F test would give its gain to chance with
/// more than 5 % and AICc does not ask to keep it. All are compared with the weights of the fullest
/// law.
SelectedLaw select_terms(const FittableLaw& law,
                         const std::vector<LawDatum>& data,
                         const std::vector<DroppedTerm>& unknowable);

/// AICc of several laws with all their terms but the unknowable ones, with the weights of the
/// first.
std::vector<ModelScore> score_families(const std::vector<FittableLaw>& laws,
                                       const std::vector<LawDatum>& data,
                                       const std::vector<DroppedTerm>& unknowable);

/// Coefficients as the table has them, with 95 % intervals (profile likelihood where a value is
/// correlated or close to zero, the covariance elsewhere).
FitSummary summarise(const FittableLaw& law, const SelectedLaw& selected);

/// d(coefficient of the table) / d(number of the fit), in the order of `active`.
std::vector<double> table_factors(const FittableLaw& law, const SolvedLaw& solved);

/// Covariance of the coefficients of the table, in the order of `active`.
Matrix table_covariance(const FittableLaw& law, const SolvedLaw& solved);

}  // namespace grainlaw::calibration
