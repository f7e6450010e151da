#include "calibration/material_fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

#include "calibration/law_selection.h"
#include "calibration/material_laws.h"
#include "calibration/profile_likelihood.h"
#include "calibration/state_points.h"

namespace grainlaw::calibration {
namespace {

/// The family with the lowest AICc, written down in `families` where there are data enough to ask.
FrictionForm choose_family(const PointSelection& selection,
                           const Levels& levels,
                           std::vector<ModelScore>& families,
                           FitSummary& summary) {
  constexpr int fewest_softness = 4, fewest_bond = 5;
  if (levels.softness < fewest_softness || levels.bond_number < fewest_bond) {
    summary.notes.emplace_back(
        "family of the law: that of Shi et al. 2020, as the data have too few values of p* and Bo "
        "(4 and 5 are needed) to choose");
    return {};
  }
  const std::vector<FrictionForm> forms = friction_forms();
  std::vector<FittableLaw> laws;
  for (const FrictionForm& form : forms) laws.push_back(friction_law(form));
  // What the data cannot know is alike for all families but for the name of the term.
  families = score_families(
      laws, selection.data, unknowable_friction(laws.front(), levels, selection.data.size()));
  const auto best = std::min_element(families.begin(), families.end(), [](auto& one, auto& other) {
    return one.aicc < other.aicc;
  });
  best->chosen = true;
  summary.notes.push_back("family of the law, lowest AICc of " + std::to_string(forms.size()) +
                          ": " + best->name);
  return forms[static_cast<std::size_t>(best - families.begin())];
}

/// The problem with mu_inf in place of beta = (mu_inf - mu0) kappa.
LeastSquaresProblem with_limit_friction(const LeastSquaresProblem& problem, double limit) {
  LeastSquaresProblem result = problem;
  result.unknowns[1] = {.name = "mu_inf", .start = limit, .lower = 0.0};
  const std::size_t n = problem.unknowns.size();
  result.evaluate = [inner = problem.evaluate, n](std::span<const double> y,
                                                  std::span<double> r,
                                                  std::span<double> jacobian) {
    std::vector<double> x(y.begin(), y.end());
    x[1] = (y[1] - y[0]) * y[2];
    inner(x, r, jacobian);
    for (std::size_t i = 0; !jacobian.empty() && i < r.size(); ++i) {
      double* row = &jacobian[i * n];
      const double by_beta = row[1];
      row[0] -= y[2] * by_beta;
      row[1] = y[2] * by_beta;
      row[2] += (y[1] - y[0]) * by_beta;
    }
  };
  return result;
}

/// mu_inf = mu0 + beta / kappa, by profile likelihood: the pair is correlated above 0.95 wherever
/// the data end before the plateau.
FittedCoefficient limit_friction(const SolvedLaw& solved) {
  const std::vector<double>& x = solved.minimum.values;
  const double limit = x[0] + x[1] / x[2];
  const LeastSquaresProblem problem = with_limit_friction(solved.problem, limit);
  Minimum minimum = solved.minimum;
  minimum.values[1] = limit;
  problem.evaluate(minimum.values, minimum.residuals, minimum.jacobian.values);
  Uncertainty errors = uncertainty(problem, minimum);
  for (double& c : errors.covariance.values) c *= solved.scatter;
  return {.name = "mu_inf",
          .value = limit,
          .error = std::sqrt(errors.covariance(1, 1)),
          .interval = profile_interval(problem, minimum, errors.covariance, 1, solved.rise())};
}

void add_derived(const FittableLaw& law,
                 const std::vector<LawDatum>& data,
                 const SolvedLaw& solved,
                 FitSummary& summary) {
  const int kappa = solved.unknown(friction_slot::kappa);
  if (kappa == 2 && solved.minimum.values[2] > 0.0) {
    summary.derived.push_back(limit_friction(solved));
    const FittedCoefficient& c = summary["kappa"];
    summary.derived.push_back({.name = "I_mu",
                               .value = 1.0 / c.value,
                               .error = c.error / (c.value * c.value),
                               .interval = {.lower = 1.0 / c.interval.upper,
                                            .upper = 1.0 / std::max(0.0, c.interval.lower),
                                            .by_profile = c.interval.by_profile}});
  }
  if (solved.unknown(friction_slot::cohesion_exponent) < 0) return;
  std::vector<std::size_t> linear = solved.active;
  std::erase(linear, friction_slot::cohesion_exponent);
  const SolvedLaw fit = solve_law(law, data, linear);
  const int k = fit.unknown(friction_slot::cohesion);
  if (!fit.minimum.converged) return;
  summary.derived.push_back({.name = "alpha (linear in Bo)",
                             .value = fit.minimum.values[static_cast<std::size_t>(k)],
                             .error = std::sqrt(fit.uncertainty.covariance(k, k))});
}

std::optional<continuum::Range> spread(const std::vector<LawDatum>& data, double State::*variable) {
  continuum::Range range{data.front().state.*variable, data.front().state.*variable};
  for (const LawDatum& datum : data) {
    range.lower = std::min(range.lower, datum.state.*variable);
    range.upper = std::max(range.upper, datum.state.*variable);
  }
  if (range.upper > 0.0) return range;
  return std::nullopt;
}

struct Part {
  std::vector<std::string> names;
  Matrix covariance;
};

Part part_of(const FittableLaw& law, const SolvedLaw& solved) {
  Part part;
  for (const std::size_t slot : solved.active) part.names.push_back(law.slots[slot].name);
  part.covariance = table_covariance(law, solved);
  return part;
}

/// Both laws have errors of their own; their data share the runs, which is not in the covariance.
continuum::Covariance join(const Part& one, const Part& other) {
  continuum::Covariance joint;
  joint.names = one.names;
  joint.names.insert(joint.names.end(), other.names.begin(), other.names.end());
  const std::size_t n = joint.names.size();
  joint.matrix.assign(n * n, 0.0);
  std::size_t first = 0;
  for (const Part* part : {&one, &other}) {
    for (int i = 0; i < part->covariance.rows; ++i) {
      for (int j = 0; j < part->covariance.columns; ++j) {
        joint.matrix[(first + static_cast<std::size_t>(i)) * n + first +
                     static_cast<std::size_t>(j)] = part->covariance(i, j);
      }
    }
    first += part->names.size();
  }
  return joint;
}

/// One of the two laws, fitted.
struct LawFit {
  FittableLaw law;
  PointSelection points;
  SelectedLaw selected;
};

LawFit fit_law(const FittableLaw& law,
               PointSelection points,
               const std::vector<DroppedTerm>& unknowable,
               const std::string& name) {
  LawFit fit{.law = law, .points = std::move(points), .selected = {}};
  fit.selected = select_terms(fit.law, fit.points.data, unknowable);
  require_converged(fit.selected.solved.minimum, name);
  return fit;
}

LawFit fit_friction_law(std::span<const StatePoint> points,
                        const MaterialFitOptions& options,
                        MaterialFit& fit,
                        continuum::MuPhi& law) {
  PointSelection selection = select_points(points, Quantity::friction, options.range);
  const Levels levels = levels_of(selection.data);
  FitSummary words;
  const FrictionForm form = choose_family(selection, levels, fit.families, words);
  const FittableLaw family = friction_law(form);
  const auto unknowable = unknowable_friction(family, levels, selection.data.size());
  LawFit found = fit_law(family, std::move(selection), unknowable, "mu(I, p*, Bo)");
  const SolvedLaw& solved = found.selected.solved;
  fit.friction = summarise(family, found.selected);
  fit.friction.notes.insert(fit.friction.notes.begin(), words.notes.begin(), words.notes.end());
  add_derived(family, found.points.data, solved, fit.friction);
  fit.friction_weight = point_weights(points, found.points, solved, fit.friction);
  fit.friction_models = found.selected.scores;
  set_friction(law, form, solved.slots, solved.active);
  return found;
}

LawFit fit_fraction_law(std::span<const StatePoint> points,
                        const MaterialFitOptions& options,
                        MaterialFit& fit,
                        continuum::MuPhi& law) {
  PointSelection selection = select_points(points, Quantity::volume_fraction, options.range);
  const FittableLaw family = volume_fraction_law();
  const auto unknowable =
      unknowable_fraction(family, levels_of(selection.data), selection.data.size());
  LawFit found = fit_law(family, std::move(selection), unknowable, "phi(I, p*, Bo)");
  const SolvedLaw& solved = found.selected.solved;
  fit.volume_fraction = summarise(family, found.selected);
  fit.fraction_weight = point_weights(points, found.points, solved, fit.volume_fraction);
  fit.fraction_models = found.selected.scores;
  set_volume_fraction(law, solved.slots, solved.active);
  return found;
}

void describe_table(const LawFit& friction,
                    const LawFit& fraction,
                    const MaterialFitOptions& options,
                    continuum::RheologyTable& table) {
  table.contact_friction = options.contact_friction;
  const SolvedLaw& mu = friction.selected.solved;
  const SolvedLaw& phi = fraction.selected.solved;
  if (mu.uncertainty.null_space.empty() && phi.uncertainty.null_space.empty()) {
    table.covariance = join(part_of(friction.law, mu), part_of(fraction.law, phi));
  }
  const std::vector<LawDatum>& data = friction.points.data;
  table.range = {.inertial_number = spread(data, &State::inertial_number),
                 .softness = spread(data, &State::softness),
                 .bond_number = spread(data, &State::bond_number)};
  if (table.range.bond_number) {
    table.definitions.bond_number =
        "Bo = f_a / (p d^2), largest attraction of a pair of mean diameter" +
        (options.cohesion.empty() ? std::string() : ": " + options.cohesion);
  }
  table.provenance.source = "grainlaw, mu(I, p*, Bo) and phi(I, p*, Bo) fit; " + friction.law.name;
}

}  // namespace

MaterialFit fit_material(std::span<const StatePoint> points, const MaterialFitOptions& options) {
  const auto clock = std::chrono::steady_clock::now();
  MaterialFit fit;
  continuum::MuPhi law;
  const LawFit friction = fit_friction_law(points, options, fit, law);
  const LawFit fraction = fit_fraction_law(points, options, fit, law);
  fit.table.law = law;
  describe_table(friction, fraction, options, fit.table);
  for (const std::size_t i : friction.points.used) {
    fit.table.provenance.data.push_back(label(points[i], i));
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - clock;
  fit.friction.wall_seconds = elapsed.count();
  return fit;
}

}  // namespace grainlaw::calibration
