#include "calibration/law_selection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "calibration/profile_likelihood.h"

namespace grainlaw::calibration {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double most_chance = 0.05;  // F test at 95 %

Slots<double> fill(const FittableLaw& law,
                   const std::vector<std::size_t>& active,
                   std::span<const double> x) {
  Slots<double> slots{};
  for (std::size_t j = 0; j < law.slots.size(); ++j) slots[j] = law.slots[j].inactive;
  for (std::size_t k = 0; k < active.size(); ++k) slots[active[k]] = x[k];
  return slots;
}

double effective_error(const FittableLaw& law, const Slots<double>& slots, const LawDatum& datum) {
  const State& s = datum.error;
  if (s.inertial_number == 0.0 && s.softness == 0.0 && s.bond_number == 0.0) return datum.y_error;
  const auto slope = law.by_state(slots, datum.state);
  double variance = datum.y_error * datum.y_error;
  const std::array<double, 3> errors{s.inertial_number, s.softness, s.bond_number};
  for (std::size_t i = 0; i < 3; ++i) {
    if (errors[i] > 0.0) variance += std::pow(slope[i] * errors[i], 2);
  }
  return std::sqrt(variance);
}

/// Huber's weight of a residual in standard errors.
double kept_weight(const LawDatum& datum, double residual) {
  constexpr double turning = 2.5;
  return datum.flagged ? std::min(1.0, turning / std::abs(residual)) : 1.0;
}

struct Weights {
  std::vector<double> errors;  ///< that weigh the residuals
  std::vector<double> kept;
};

Weights weights_at(const FittableLaw& law,
                   const std::vector<LawDatum>& data,
                   const Slots<double>& slots) {
  Weights result;
  for (const LawDatum& datum : data) {
    const double error = effective_error(law, slots, datum);
    const double kept = kept_weight(datum, (law.value(slots, datum.state) - datum.y) / error);
    result.kept.push_back(kept);
    result.errors.push_back(error / std::sqrt(kept));
  }
  return result;
}

Residuals residuals(const FittableLaw& law,
                    const std::vector<LawDatum>& data,
                    const std::vector<std::size_t>& active,
                    const std::vector<double>& errors) {
  return [=, points = std::span<const LawDatum>(data)](
             std::span<const double> x, std::span<double> r, std::span<double> jacobian) {
    const Slots<double> slots = fill(law, active, x);
    Slots<double> slopes{};
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double y = jacobian.empty() ? law.value(slots, points[i].state)
                                        : law.by_slots(slots, points[i].state, slopes);
      r[i] = (y - points[i].y) / errors[i];
      for (std::size_t k = 0; !jacobian.empty() && k < active.size(); ++k) {
        jacobian[i * active.size() + k] = slopes[active[k]] / errors[i];
      }
    }
  };
}

LeastSquaresProblem problem_with(const FittableLaw& law,
                                 const std::vector<LawDatum>& data,
                                 const std::vector<std::size_t>& active,
                                 std::span<const double> x,
                                 const std::vector<double>& errors) {
  LeastSquaresProblem problem;
  for (std::size_t k = 0; k < active.size(); ++k) {
    const Slot& slot = law.slots[active[k]];
    problem.unknowns.push_back({.name = slot.name, .start = x[k], .lower = slot.lower});
  }
  problem.residuals = static_cast<int>(data.size());
  problem.evaluate = residuals(law, data, active, errors);
  return problem;
}

std::vector<double> start_of(const FittableLaw& law, const std::vector<std::size_t>& active) {
  std::vector<double> start;
  for (const std::size_t slot : active) start.push_back(law.slots[slot].start);
  return start;
}

/// A minimum under given weights, from the start of the law.
Minimum minimise_weighted(const FittableLaw& law,
                          const std::vector<LawDatum>& data,
                          const std::vector<std::size_t>& active,
                          const std::vector<double>& errors) {
  return minimise(problem_with(law, data, active, start_of(law, active), errors));
}

bool contains(const std::vector<std::size_t>& slots, std::size_t slot) {
  return std::find(slots.begin(), slots.end(), slot) != slots.end();
}

std::vector<std::size_t> without(const std::vector<std::size_t>& active, const LawTerm& term) {
  std::vector<std::size_t> rest;
  for (const std::size_t slot : active) {
    if (!contains(term.slots, slot)) rest.push_back(slot);
  }
  return rest;
}

bool can_go(const LawTerm& term, const std::vector<std::size_t>& active) {
  const bool waits = term.after >= 0 && contains(active, static_cast<std::size_t>(term.after));
  return !waits && contains(active, term.slots.front());
}

std::vector<std::size_t> knowable(const FittableLaw& law,
                                  const std::vector<DroppedTerm>& unknowable) {
  std::vector<std::size_t> active = law.possible;
  for (const LawTerm& term : law.terms) {
    const bool out = std::any_of(unknowable.begin(), unknowable.end(), [&](const DroppedTerm& d) {
      return d.name == term.name;
    });
    if (out) active = without(active, term);
  }
  return active;
}

ModelScore score(const std::string& name, const Minimum& minimum) {
  const int k = static_cast<int>(minimum.values.size());
  const int n = static_cast<int>(minimum.residuals.size());
  const double chi = minimum.converged ? minimum.chi_squared : infinity;
  return {.name = name,
          .coefficients = k,
          .chi_squared = chi,
          .aicc = minimum.converged ? corrected_akaike(chi, n, k) : infinity};
}

std::string why_dropped(double chance, const ModelScore& small, const ModelScore& large) {
  std::ostringstream text;
  text.precision(3);
  text << "F test: its gain is chance with probability " << chance;
  if (std::isfinite(large.aicc))
    text << "; AICc " << small.aicc << " without it, " << large.aicc << " with it";
  return text.str();
}

/// The law without one of its terms.
struct Candidate {
  const LawTerm* term = nullptr;
  std::vector<std::size_t> active;
  ModelScore score;
  double chance = 0.0;
};

/// The term that is least needed; none where all are.
std::optional<Candidate> least_needed(const FittableLaw& law,
                                      const std::vector<LawDatum>& data,
                                      const std::vector<double>& errors,
                                      const std::vector<std::size_t>& active,
                                      const ModelScore& now) {
  std::optional<Candidate> result;
  for (const LawTerm& term : law.terms) {
    if (!can_go(term, active)) continue;
    Candidate candidate{.term = &term, .active = without(active, term), .score = {}};
    candidate.score =
        score("without " + term.name, minimise_weighted(law, data, candidate.active, errors));
    if (!std::isfinite(candidate.score.chi_squared)) continue;
    candidate.chance = chance_of_gain(candidate.score, now, static_cast<int>(data.size()));
    const bool tied = !std::isfinite(now.chi_squared);  // the fuller law has no minimum
    const bool needed = candidate.chance <= most_chance || candidate.score.aicc > now.aicc;
    if (needed && !tied) continue;
    if (!result || candidate.chance > result->chance) result = candidate;
  }
  return result;
}

/// chi^2 per degree of freedom where chance would exceed it in less than 5 %, otherwise 1: errors
/// that are right stay as they are.
double excess_scatter(double chi_squared, int freedom) {
  if (freedom <= 0) return 1.0;
  const double scatter = chi_squared / freedom;
  constexpr double very_many = 1e6;  // F with so many degrees below is chi^2
  return scatter > 1.0 && f_survival(scatter, freedom, very_many) < most_chance ? scatter : 1.0;
}

double powered(double x, int power) {
  return std::pow(x, power);
}

/// An interval of the number of the fit as one of the coefficient of the table.
Interval to_table(const Interval& interval, int power) {
  if (power == 1) return interval;
  const double low = std::max(0.0, interval.lower);
  return {.lower = powered(interval.upper, power),
          .upper = low > 0.0 ? powered(low, power) : infinity,
          .by_profile = interval.by_profile};
}

Interval interval_of(const SolvedLaw& solved, int k) {
  const Matrix& c = solved.uncertainty.covariance;
  if (!solved.uncertainty.identifiable[static_cast<std::size_t>(k)]) return {};
  if (needs_profile(solved.minimum, c, k)) {
    return profile_interval(solved.problem, solved.minimum, c, k, solved.rise());
  }
  const double value = solved.minimum.values[static_cast<std::size_t>(k)];
  const double half = std::sqrt(c(k, k) * solved.rise() / solved.scatter);
  return {.lower = value - half, .upper = value + half};
}

void note_scatter(const SolvedLaw& solved, FitSummary& summary) {
  std::ostringstream text;
  text.precision(3);
  if (solved.freedom() <= 0) {
    text << "as many points as coefficients: the law goes through them exactly and is not tested";
  } else if (solved.scatter > 1.0) {
    text << "the points scatter about the law by " << std::sqrt(solved.scatter)
         << " times their errors; all errors are enlarged by this factor";
  } else {
    return;
  }
  summary.notes.push_back(text.str());
}

}  // namespace

int SolvedLaw::unknown(std::size_t slot) const {
  const auto found = std::find(active.begin(), active.end(), slot);
  return found == active.end() ? -1 : static_cast<int>(found - active.begin());
}

double SolvedLaw::rise() const {
  return std::pow(interval_half_width(scatter > 1.0, freedom()), 2) * scatter;
}

SolvedLaw solve_law(const FittableLaw& law,
                    const std::vector<LawDatum>& data,
                    const std::vector<std::size_t>& active) {
  const auto problem_at = [&](std::span<const double> x) {
    return problem_with(law, data, active, x, weights_at(law, data, fill(law, active, x)).errors);
  };
  SolvedLaw solved;
  solved.active = active;
  solved.minimum = minimise_reweighted(problem_at, start_of(law, active));
  solved.slots = fill(law, active, solved.minimum.values);
  solved.problem = problem_at(solved.minimum.values);
  Weights weights = weights_at(law, data, solved.slots);
  solved.kept = std::move(weights.kept);
  solved.errors = std::move(weights.errors);
  solved.uncertainty = uncertainty(solved.problem, solved.minimum);
  solved.scatter = excess_scatter(solved.minimum.chi_squared, solved.freedom());
  for (double& c : solved.uncertainty.covariance.values) c *= solved.scatter;
  return solved;
}

Slots<double> solve_weighted(const FittableLaw& law,
                             const std::vector<LawDatum>& data,
                             const std::vector<std::size_t>& active,
                             const std::vector<double>& errors,
                             const Slots<double>& start) {
  std::vector<double> x;
  for (const std::size_t slot : active) x.push_back(start[slot]);
  const Minimum minimum = minimise(problem_with(law, data, active, x, errors));
  require_converged(minimum, law.name);
  return fill(law, active, minimum.values);
}

SelectedLaw select_terms(const FittableLaw& law,
                         const std::vector<LawDatum>& data,
                         const std::vector<DroppedTerm>& unknowable) {
  SelectedLaw selected;
  selected.dropped = unknowable;
  std::vector<std::size_t> active = knowable(law, unknowable);
  const SolvedLaw full = solve_law(law, data, active);
  const std::vector<double> errors = weights_at(law, data, full.slots).errors;
  ModelScore now = score("all terms the data can know", full.minimum);
  selected.scores.push_back(now);
  while (const auto candidate = least_needed(law, data, errors, active, now)) {
    selected.dropped.push_back(
        {candidate->term->name, why_dropped(candidate->chance, candidate->score, now)});
    active = candidate->active;
    now = candidate->score;
    selected.scores.push_back(now);
  }
  selected.scores.back().chosen = true;
  selected.solved = active == full.active ? full : solve_law(law, data, active);
  return selected;
}

std::vector<ModelScore> score_families(const std::vector<FittableLaw>& laws,
                                       const std::vector<LawDatum>& data,
                                       const std::vector<DroppedTerm>& unknowable) {
  std::vector<ModelScore> scores;
  std::vector<double> errors;
  for (const FittableLaw& law : laws) {
    const std::vector<std::size_t> active = knowable(law, unknowable);
    if (errors.empty()) errors = weights_at(law, data, solve_law(law, data, active).slots).errors;
    scores.push_back(score(law.name, minimise_weighted(law, data, active, errors)));
  }
  return scores;
}

std::vector<double> table_factors(const FittableLaw& law, const SolvedLaw& solved) {
  std::vector<double> factor;
  for (std::size_t k = 0; k < solved.active.size(); ++k) {
    const int power = law.slots[solved.active[k]].power;
    factor.push_back(power == 1 ? 1.0 : power * powered(solved.minimum.values[k], power - 1));
  }
  return factor;
}

Matrix table_covariance(const FittableLaw& law, const SolvedLaw& solved) {
  const int n = static_cast<int>(solved.active.size());
  const std::vector<double> factor = table_factors(law, solved);
  Matrix result(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      result(i, j) = factor[static_cast<std::size_t>(i)] * factor[static_cast<std::size_t>(j)] *
                     solved.uncertainty.covariance(i, j);
    }
  }
  return result;
}

FitSummary summarise(const FittableLaw& law, const SelectedLaw& selected) {
  const SolvedLaw& solved = selected.solved;
  std::vector<std::string> names;
  for (const std::size_t slot : solved.active) names.push_back(law.slots[slot].name);
  Minimum minimum = solved.minimum;
  Uncertainty errors = solved.uncertainty;
  errors.covariance = table_covariance(law, solved);
  for (std::size_t k = 0; k < names.size(); ++k) {
    minimum.values[k] = powered(minimum.values[k], law.slots[solved.active[k]].power);
  }
  FitSummary summary = describe(names, minimum, errors);
  for (std::size_t k = 0; k < names.size() && solved.minimum.converged; ++k) {
    summary.coefficients[k].interval =
        to_table(interval_of(solved, static_cast<int>(k)), law.slots[solved.active[k]].power);
    if (!minimum.at_bound[k]) continue;
    summary.notes.push_back(names[k] + " is at its bound, the free optimum lies beyond");
  }
  for (const DroppedTerm& term : selected.dropped) {
    summary.left_out.push_back(term.name + " is dropped: " + term.reason);
  }
  note_scatter(solved, summary);
  return summary;
}

}  // namespace grainlaw::calibration
