#include "calibration/material_fit.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "calibration/law_selection.h"
#include "calibration/material_laws.h"
#include "calibration/profile_likelihood.h"
#include "calibration/state_points.h"

namespace grainlaw::calibration {
namespace {

/// Families that the data cannot tell from the best one: AICc within 2 of it (Burnham and Anderson
/// 2002, section 2.6).
std::string rivals(const std::vector<ModelScore>& families, const ModelScore& best) {
  constexpr double alike = 2.0;
  std::string names;
  for (const ModelScore& family : families) {
    if (&family == &best || !(family.aicc < best.aicc + alike)) continue;
    names += (names.empty() ? "" : "; ") + family.name;
  }
  return names.empty() ? names : " (not told apart from it, AICc within 2: " + names + ")";
}

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
  std::vector<FrictionForm> forms = friction_forms();
  if (levels.cohesive_softness < 2) {
    std::erase_if(forms,
                  [](const auto& form) { return form.cohesion == CohesionForm::additive_power; });
  }
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
                          ": " + best->name + rivals(families, *best));
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
  const int exponent = solved.unknown(friction_slot::cohesion_exponent);
  if (exponent < 0 || law.slots[friction_slot::cohesion_exponent].name != "cohesion_beta") return;
  std::vector<std::size_t> linear = solved.active;
  std::erase(linear, friction_slot::cohesion_exponent);
  const SolvedLaw fit = solve_law(law, data, linear);
  const int k = fit.unknown(friction_slot::cohesion);
  if (!fit.minimum.converged) return;
  const double alpha = fit.minimum.values[static_cast<std::size_t>(k)];
  const double error = std::sqrt(fit.uncertainty.covariance(k, k));
  const double half = error * std::sqrt(fit.rise() / fit.scatter);
  summary.derived.push_back({.name = "alpha (linear in Bo)",
                             .value = alpha,
                             .error = error,
                             .interval = {.lower = alpha - half, .upper = alpha + half}});
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

/// The coefficients of one law as the table has them.
struct Part {
  std::vector<std::string> names;
  std::vector<double> factor;  ///< d(coefficient of the table) / d(number of the fit)
  Matrix covariance;
};

Part part_of(const FittableLaw& law, const SolvedLaw& solved) {
  Part part;
  for (const std::size_t slot : solved.active) part.names.push_back(law.slots[slot].name);
  part.factor = table_factors(law, solved);
  part.covariance = table_covariance(law, solved);
  return part;
}

/// Row i of a matrix times a symmetric one.
std::vector<double> row_times(const Matrix& matrix, std::size_t i, const Matrix& symmetric) {
  std::vector<double> product(static_cast<std::size_t>(symmetric.rows), 0.0);
  for (int k = 0; k < symmetric.rows; ++k) {
    for (int l = 0; l < symmetric.columns; ++l) {
      product[static_cast<std::size_t>(k)] += matrix(static_cast<int>(i), l) * symmetric(l, k);
    }
  }
  return product;
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

/// Covariance of the weighted residuals of one point in both laws: its errors of mu and phi are
/// correlated, those of I, p* and Bo are the same.
double shared_noise(const StatePoint& point,
                    const LawFit& friction,
                    std::size_t i,
                    const LawFit& fraction,
                    std::size_t j) {
  const SolvedLaw& mu = friction.selected.solved;
  const SolvedLaw& phi = fraction.selected.solved;
  const LawDatum& a = friction.points.data[i];
  const LawDatum& b = fraction.points.data[j];
  double covariance = point.correlation * a.y_error * b.y_error;
  const auto mu_slope = friction.law.by_state(mu.slots, a.state);
  const auto phi_slope = fraction.law.by_state(phi.slots, b.state);
  const std::array<double, 3> errors{
      a.error.inertial_number, a.error.softness, a.error.bond_number};
  for (std::size_t k = 0; k < 3; ++k) {
    if (errors[k] > 0.0) covariance += mu_slope[k] * phi_slope[k] * errors[k] * errors[k];
  }
  return covariance / (mu.errors[i] * phi.errors[j]);
}

/// Covariance of the coefficients of both laws, C_mu J_mu' S J_phi C_phi, S of the residuals of
/// points that both were fitted to. In the numbers of the fits.
Matrix cross_covariance(std::span<const StatePoint> points,
                        const LawFit& friction,
                        const LawFit& fraction) {
  const SolvedLaw& mu = friction.selected.solved;
  const SolvedLaw& phi = fraction.selected.solved;
  const Matrix& C = mu.uncertainty.covariance;
  const Matrix& D = phi.uncertainty.covariance;
  Matrix result(C.rows, D.rows);
  const double scale = 1.0 / std::sqrt(mu.scatter * phi.scatter);  // C and D have it each, squared
  for (std::size_t i = 0; i < friction.points.used.size(); ++i) {
    const auto& others = fraction.points.used;
    const auto found = std::find(others.begin(), others.end(), friction.points.used[i]);
    if (found == others.end()) continue;
    const auto j = static_cast<std::size_t>(found - others.begin());
    const double noise =
        scale * shared_noise(points[friction.points.used[i]], friction, i, fraction, j);
    const std::vector<double> left = row_times(mu.minimum.jacobian, i, C);
    const std::vector<double> right = row_times(phi.minimum.jacobian, j, D);
    for (int k = 0; k < C.rows; ++k) {
      for (int l = 0; l < D.rows; ++l) {
        result(k, l) +=
            noise * left[static_cast<std::size_t>(k)] * right[static_cast<std::size_t>(l)];
      }
    }
  }
  return result;
}

/// Covariance of all coefficients that the table has.
continuum::Covariance join(std::span<const StatePoint> points,
                           const LawFit& friction,
                           const LawFit& fraction,
                           const continuum::RheologyTable& table) {
  const Part mu = part_of(friction.law, friction.selected.solved);
  const Part phi = part_of(fraction.law, fraction.selected.solved);
  const Matrix cross = cross_covariance(points, friction, fraction);
  std::vector<std::string> names = mu.names;
  names.insert(names.end(), phi.names.begin(), phi.names.end());
  const int split = mu.covariance.rows;
  const auto entry = [&](int i, int j) {
    if (i > j) std::swap(i, j);
    if (j < split) return mu.covariance(i, j);
    if (i >= split) return phi.covariance(i - split, j - split);
    return mu.factor[static_cast<std::size_t>(i)] *
           phi.factor[static_cast<std::size_t>(j - split)] * cross(i, j - split);
  };
  const std::vector<std::string> known = continuum::coefficient_names(table);
  std::vector<int> kept;  // a term at its bound is not in the table
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(known.begin(), known.end(), names[i]) != known.end()) {
      kept.push_back(static_cast<int>(i));
    }
  }
  continuum::Covariance joint;
  for (const int i : kept) {
    joint.names.push_back(names[static_cast<std::size_t>(i)]);
    for (const int j : kept) joint.matrix.push_back(entry(i, j));
  }
  return joint;
}

void describe_table(std::span<const StatePoint> points,
                    const LawFit& friction,
                    const LawFit& fraction,
                    const MaterialFitOptions& options,
                    continuum::RheologyTable& table) {
  table.contact_friction = options.contact_friction;
  const SolvedLaw& mu = friction.selected.solved;
  const SolvedLaw& phi = fraction.selected.solved;
  if (mu.uncertainty.null_space.empty() && phi.uncertainty.null_space.empty()) {
    table.covariance = join(points, friction, fraction, table);
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
  table.provenance.source = "grainlaw, mu(I, p*, Bo) and phi(I, p*, Bo) fit; " +
                            words(std::get<continuum::MuPhi>(table.law));
}

}  // namespace

MaterialFit fit_material(std::span<const StatePoint> points, const MaterialFitOptions& options) {
  const auto clock = std::chrono::steady_clock::now();
  MaterialFit fit;
  continuum::MuPhi law;
  const LawFit friction = fit_friction_law(points, options, fit, law);
  const LawFit fraction = fit_fraction_law(points, options, fit, law);
  fit.table.law = law;
  describe_table(points, friction, fraction, options, fit.table);
  for (const std::size_t i : friction.points.used) {
    fit.table.provenance.data.push_back(label(points[i], i));
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - clock;
  fit.friction.wall_seconds = elapsed.count();
  return fit;
}

}  // namespace grainlaw::calibration
