#include "calibration/material_fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <tuple>

#include "calibration/law_selection.h"
#include "calibration/material_laws.h"
#include "calibration/observations.h"
#include "calibration/profile_likelihood.h"

namespace grainlaw::calibration {
namespace {

/// Which of the two laws.
enum class Quantity { friction, volume_fraction };

const dem::Estimate& measured(const StatePoint& point, Quantity quantity) {
  return quantity == Quantity::friction ? point.friction : point.volume_fraction;
}

std::string label(const StatePoint& point, std::size_t index) {
  return point.name.empty() ? "point " + std::to_string(index + 1) : point.name;
}

/// Why a point cannot be used; empty: it can.
std::string defect(const StatePoint& point, Quantity quantity) {
  const double I = point.inertial_number.value;
  const double p = point.softness.value;
  const double Bo = point.bond_number.value;
  if (!(std::isfinite(I) && I >= 0.0)) return "I is not a number or negative";
  if (!(std::isfinite(p) && p >= 0.0)) return "p* is not a number or negative";
  if (!(std::isfinite(Bo) && Bo >= 0.0)) return "Bo is not a number or negative";
  const double y = measured(point, quantity).value;
  if (!(std::isfinite(y) && y > 0.0)) return "the measured value is not a number or not positive";
  return "";
}

/// Why a point lies outside the range of a law; empty: inside.
std::string outside(const StatePoint& point, Quantity quantity, const FitRange& range) {
  std::ostringstream text;
  const double I = point.inertial_number.value;
  const bool friction = quantity == Quantity::friction;
  const double softest = friction ? range.friction_softness : range.fraction_softness;
  const double largest_I =
      friction ? range.friction_inertial_number.upper : range.fraction_inertial_number;
  const double least_I = friction ? range.friction_inertial_number.lower : 0.0;
  if (point.volume_fraction.value < range.least_volume_fraction) {
    text << "phi = " << point.volume_fraction.value << " is below " << range.least_volume_fraction;
  } else if (I < least_I) {
    text << "I = " << I << " is below " << least_I;
  } else if (I > largest_I) {
    text << "I = " << I << " is above " << largest_I;
  } else if (point.softness.value > softest) {
    text << "p* = " << point.softness.value << " is above " << softest;
  }
  return text.str();
}

/// The points of one law.
struct Selection {
  std::vector<std::size_t> used;  ///< indices of the points
  std::vector<LawDatum> data;
  std::vector<std::string> left_out;
};

double error_of(const dem::Estimate& estimate) {
  return std::isfinite(estimate.error) ? estimate.error : 0.0;
}

void set_errors(std::span<const StatePoint> points, Quantity quantity, Selection& selection) {
  std::vector<dem::Estimate> measurements;
  for (const std::size_t i : selection.used) measurements.push_back(measured(points[i], quantity));
  const std::vector<double> errors = weight_errors(measurements);
  for (std::size_t k = 0; k < errors.size(); ++k) selection.data[k].y_error = errors[k];
}

Selection select_points(std::span<const StatePoint> points,
                        Quantity quantity,
                        const FitRange& range) {
  Selection selection;
  std::set<std::tuple<double, double, double, double>> seen;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const StatePoint& point = points[i];
    const State state{
        point.inertial_number.value, point.softness.value, point.bond_number.value};
    const double y = measured(point, quantity).value;
    std::string reason = defect(point, quantity);
    const std::string beyond =
        reason.empty() && range.outside != OutOfRange::keep ? outside(point, quantity, range) : "";
    if (reason.empty() && range.outside == OutOfRange::leave_out) reason = beyond;
    if (reason.empty() &&
        !seen.insert({state.inertial_number, state.softness, state.bond_number, y}).second) {
      reason = "the same numbers stand there before, they count once";
    }
    if (!reason.empty()) {
      selection.left_out.push_back(label(point, i) + " is left out: " + reason);
      continue;
    }
    selection.used.push_back(i);
    selection.data.push_back({.state = state,
                              .error = {error_of(point.inertial_number),
                                        error_of(point.softness),
                                        error_of(point.bond_number)},
                              .y = y,
                              .flagged = !beyond.empty()});
  }
  set_errors(points, quantity, selection);
  return selection;
}

/// How many values of each variable the data have.
struct Levels {
  int inertial_number = 0;
  int softness = 0;
  int bond_number = 0;
};

Levels levels_of(const std::vector<LawDatum>& data) {
  std::vector<double> I, p, Bo;
  for (const LawDatum& datum : data) {
    I.push_back(datum.state.inertial_number);
    p.push_back(datum.state.softness);
    Bo.push_back(datum.state.bond_number);
  }
  return {count_levels(I), count_levels(p), count_levels(Bo)};
}

/// Collects the terms of a law that the data cannot know.
class Unknowable {
 public:
  void need(const std::string& term, int there, int needed, const std::string& of_what) {
    if (there >= needed) return;
    std::ostringstream text;
    text << "it needs " << needed << " different values of " << of_what << " at least, there "
         << (there == 1 ? "is " : "are ") << there;
    add(term, text.str());
  }

  /// Every coefficient needs a datum, and one more to test the law: what is asked last goes first.
  void make_room(const FittableLaw& law, int data) {
    const auto count = [&] {
      int left = static_cast<int>(law.possible.size());
      for (const LawTerm& term : law.terms) left -= has(term.name) ? own_slots(law, term) : 0;
      return left;
    };
    for (auto term = law.terms.rbegin(); term != law.terms.rend() && count() >= data; ++term) {
      if (data > 2 || count() > data) add(term->name, "too few points for so many coefficients");
    }
  }

  const std::vector<DroppedTerm>& terms() const { return terms_; }

 private:
  bool has(const std::string& term) const {
    return std::any_of(
        terms_.begin(), terms_.end(), [&](const DroppedTerm& d) { return d.name == term; });
  }
  void add(const std::string& term, const std::string& reason) {
    if (!has(term)) terms_.push_back({term, reason});
  }
  /// Slots that go with this term alone.
  int own_slots(const FittableLaw& law, const LawTerm& term) const {
    int own = 0;
    for (const std::size_t slot : term.slots) {
      const bool possible =
          std::find(law.possible.begin(), law.possible.end(), slot) != law.possible.end();
      const bool counted = std::any_of(law.terms.begin(), law.terms.end(), [&](const LawTerm& t) {
        return &t < &term && has(t.name) &&
               std::find(t.slots.begin(), t.slots.end(), slot) != t.slots.end();
      });
      own += possible && !counted ? 1 : 0;
    }
    return own;
  }
  std::vector<DroppedTerm> terms_;
};

/// Four values of I tell a curve from a line, three of Bo a power from a line.
std::vector<DroppedTerm> unknowable_friction(const FittableLaw& law,
                                             const Levels& levels,
                                             std::size_t data) {
  Unknowable result;
  for (const char* term : {"kappa", "exponent of I"}) {
    result.need(term, levels.inertial_number, 4, "I");
  }
  result.need("f_p (softness)", levels.softness, 2, "p*");
  result.need("exponent of Bo", levels.bond_number, 3, "Bo");
  for (const char* term : {"f_B (cohesion)", "c0 (cohesion)"}) {
    result.need(term, levels.bond_number, 2, "Bo");
  }
  result.make_room(law, static_cast<int>(data));
  return result.terms();
}

std::vector<DroppedTerm> unknowable_fraction(const FittableLaw& law,
                                             const Levels& levels,
                                             std::size_t data) {
  Unknowable result;
  result.need("g_I (inertia)", levels.inertial_number, 2, "I");
  result.need("g_p (softness)", levels.softness, 2, "p*");
  for (int order = 4; order >= 1; --order) {
    result.need("p" + std::to_string(order) + " of g_c", levels.bond_number, order + 1, "Bo");
  }
  result.make_room(law, static_cast<int>(data));
  return result.terms();
}

/// The family with the lowest AICc, written down in `families` where there are data enough to ask.
FrictionForm choose_family(const Selection& selection,
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
  result.evaluate = [inner = problem.evaluate, n](
                        std::span<const double> y, std::span<double> r, std::span<double> jacobian) {
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
    summary.derived.push_back(
        {.name = "I_mu",
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

std::vector<double> point_weights(std::size_t points,
                                  const Selection& selection,
                                  const SolvedLaw& solved) {
  std::vector<double> weights(points, 0.0);
  for (std::size_t k = 0; k < selection.used.size(); ++k) {
    weights[selection.used[k]] = solved.kept[k];
  }
  return weights;
}

void note_points(std::span<const StatePoint> points,
                 const Selection& selection,
                 const SolvedLaw& solved,
                 FitSummary& summary) {
  summary.left_out.insert(
      summary.left_out.end(), selection.left_out.begin(), selection.left_out.end());
  for (std::size_t k = 0; k < selection.used.size(); ++k) {
    if (!selection.data[k].flagged) continue;
    std::ostringstream text;
    text.precision(2);
    text << label(points[selection.used[k]], selection.used[k])
         << " is outside the range of the law and kept the weight " << solved.kept[k];
    summary.notes.push_back(text.str());
  }
}

void require_spread(const Selection& selection, const std::string& law) {
  std::string reasons;
  for (std::size_t i = 0; i < selection.left_out.size() && i < 5; ++i) {
    reasons += "; " + selection.left_out[i];
  }
  if (selection.data.size() >= 2 && levels_of(selection.data).inertial_number >= 2) return;
  throw FitError(law + " needs points at two different I at least, " +
                 std::to_string(selection.data.size()) + " usable points are not enough" + reasons);
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

}  // namespace

int count_levels(std::vector<double> values) {
  constexpr double alike = 1.1;
  std::sort(values.begin(), values.end());
  int levels = 0;
  double first = -1.0;
  for (const double value : values) {
    if (first >= 0.0 && value <= alike * first) continue;
    first = value;
    ++levels;
  }
  return levels;
}

MaterialFit fit_material(std::span<const StatePoint> points, const MaterialFitOptions& options) {
  const auto clock = std::chrono::steady_clock::now();
  MaterialFit fit;
  continuum::MuPhi law;

  const Selection mu = select_points(points, Quantity::friction, options.range);
  require_spread(mu, "mu(I, p*, Bo)");
  const Levels levels = levels_of(mu.data);
  FitSummary words;
  const FrictionForm form = choose_family(mu, levels, fit.families, words);
  const FittableLaw friction = friction_law(form);
  const SelectedLaw chosen =
      select_terms(friction, mu.data, unknowable_friction(friction, levels, mu.data.size()));
  require_converged(chosen.solved.minimum, "mu(I, p*, Bo)");
  fit.friction = summarise(friction, chosen);
  fit.friction.notes.insert(
      fit.friction.notes.begin(), words.notes.begin(), words.notes.end());
  add_derived(friction, mu.data, chosen.solved, fit.friction);
  note_points(points, mu, chosen.solved, fit.friction);
  fit.friction_models = chosen.scores;
  fit.friction_weight = point_weights(points.size(), mu, chosen.solved);
  set_friction(law, form, chosen.solved.slots, chosen.solved.active);

  const Selection phi = select_points(points, Quantity::volume_fraction, options.range);
  require_spread(phi, "phi(I, p*, Bo)");
  const FittableLaw fraction = volume_fraction_law();
  const SelectedLaw dense = select_terms(
      fraction, phi.data, unknowable_fraction(fraction, levels_of(phi.data), phi.data.size()));
  require_converged(dense.solved.minimum, "phi(I, p*, Bo)");
  fit.volume_fraction = summarise(fraction, dense);
  note_points(points, phi, dense.solved, fit.volume_fraction);
  fit.fraction_models = dense.scores;
  fit.fraction_weight = point_weights(points.size(), phi, dense.solved);
  set_volume_fraction(law, dense.solved.slots, dense.solved.active);

  fit.table.law = law;
  fit.table.contact_friction = options.contact_friction;
  if (chosen.solved.uncertainty.null_space.empty() && dense.solved.uncertainty.null_space.empty()) {
    fit.table.covariance =
        join(part_of(friction, chosen.solved), part_of(fraction, dense.solved));
  }
  fit.table.range = {.inertial_number = spread(mu.data, &State::inertial_number),
                     .softness = spread(mu.data, &State::softness),
                     .bond_number = spread(mu.data, &State::bond_number)};
  if (fit.table.range.bond_number) {
    fit.table.definitions.bond_number =
        "Bo = f_a / (p d^2), largest attraction of a pair of mean diameter" +
        (options.cohesion.empty() ? std::string() : ": " + options.cohesion);
  }
  fit.table.provenance.source = "grainlaw, mu(I, p*, Bo) and phi(I, p*, Bo) fit; " + friction.name;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (fit.friction_weight[i] > 0.0) fit.table.provenance.data.push_back(label(points[i], i));
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - clock;
  fit.friction.wall_seconds = elapsed.count();
  return fit;
}

}  // namespace grainlaw::calibration
