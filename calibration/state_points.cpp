#include "calibration/state_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <sstream>
#include <tuple>

#include "calibration/material_laws.h"
#include "calibration/observations.h"

namespace grainlaw::calibration {
const dem::Estimate& measured(const StatePoint& point, Quantity quantity) {
  return quantity == Quantity::friction ? point.friction : point.volume_fraction;
}

namespace {

/// Why a point cannot be used; empty: it can.
std::string defect(const StatePoint& point, Quantity quantity) {
  if (!point.unfit.empty()) return point.unfit;
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

double error_of(const dem::Estimate& estimate) {
  return std::isfinite(estimate.error) ? estimate.error : 0.0;
}

/// Beyond a bound by more than two standard errors: a run held at the bound itself is inside.
bool below(const dem::Estimate& measured, double bound) {
  return measured.value + 2.0 * error_of(measured) < bound;
}
bool above(const dem::Estimate& measured, double bound) {
  return measured.value - 2.0 * error_of(measured) > bound;
}

/// Why a point lies outside the range of a law; empty: inside.
std::string outside(const StatePoint& point, Quantity quantity, const FitRange& range) {
  std::ostringstream text;
  text.precision(4);
  const dem::Estimate& I = point.inertial_number;
  const bool friction = quantity == Quantity::friction;
  const double softest = friction ? range.friction_softness : range.fraction_softness;
  const double largest_I =
      friction ? range.friction_inertial_number.upper : range.fraction_inertial_number;
  const double least_I = friction ? range.friction_inertial_number.lower : 0.0;
  if (below(point.volume_fraction, range.least_volume_fraction)) {
    text << "phi = " << point.volume_fraction.value << " is below " << range.least_volume_fraction;
  } else if (below(I, least_I)) {
    text << "I = " << I.value << " is below " << least_I;
  } else if (above(I, largest_I)) {
    text << "I = " << I.value << " is above " << largest_I;
  } else if (above(point.softness, softest)) {
    text << "p* = " << point.softness.value << " is above " << softest;
  }
  return text.str();
}

LawDatum datum_of(const StatePoint& point, Quantity quantity, bool flagged) {
  return {.state = {point.inertial_number.value, point.softness.value, point.bond_number.value},
          .error = {error_of(point.inertial_number),
                    error_of(point.softness),
                    error_of(point.bond_number)},
          .y = measured(point, quantity).value,
          .flagged = flagged};
}

void set_errors(std::span<const StatePoint> points, Quantity quantity, PointSelection& selection) {
  std::vector<dem::Estimate> measurements;
  for (const std::size_t i : selection.used) measurements.push_back(measured(points[i], quantity));
  const std::vector<double> errors = weight_errors(measurements);
  for (std::size_t k = 0; k < errors.size(); ++k) selection.data[k].y_error = errors[k];
}

void require_spread(const PointSelection& selection, Quantity quantity) {
  const std::string law = quantity == Quantity::friction ? "mu(I, p*, Bo)" : "phi(I, p*, Bo)";
  std::string reasons;
  for (std::size_t i = 0; i < selection.left_out.size() && i < 5; ++i) {
    reasons += "; " + selection.left_out[i];
  }
  if (selection.data.size() >= 2 && levels_of(selection.data).inertial_number >= 2) return;
  throw FitError(law + " needs points at two different I at least; usable: " +
                 std::to_string(selection.data.size()) + " at " +
                 std::to_string(levels_of(selection.data).inertial_number) + " different I" +
                 reasons);
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

}  // namespace

std::string label(const StatePoint& point, std::size_t index) {
  return point.name.empty() ? "point " + std::to_string(index + 1) : point.name;
}

PointSelection select_points(std::span<const StatePoint> points,
                             Quantity quantity,
                             const FitRange& range) {
  PointSelection selection;
  std::set<std::tuple<double, double, double, double>> seen;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const StatePoint& point = points[i];
    const State state{point.inertial_number.value, point.softness.value, point.bond_number.value};
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
    selection.data.push_back(datum_of(point, quantity, !beyond.empty()));
  }
  set_errors(points, quantity, selection);
  require_spread(selection, quantity);
  return selection;
}

PointSelection select_fitted(std::span<const StatePoint> points,
                             Quantity quantity,
                             const std::vector<double>& weights) {
  PointSelection selection;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(weights[i] > 0.0)) continue;
    selection.used.push_back(i);
    selection.data.push_back(datum_of(points[i], quantity, weights[i] < 1.0));
  }
  set_errors(points, quantity, selection);
  return selection;
}

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

Levels levels_of(const std::vector<LawDatum>& data) {
  std::vector<double> I, p, Bo, cohesive;
  for (const LawDatum& datum : data) {
    I.push_back(datum.state.inertial_number);
    p.push_back(datum.state.softness);
    Bo.push_back(datum.state.bond_number);
    if (datum.state.bond_number > 0.0) cohesive.push_back(datum.state.softness);
  }
  return {count_levels(I), count_levels(p), count_levels(Bo), count_levels(cohesive)};
}

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
  result.need("exponent of p* (cohesion)", levels.cohesive_softness, 2, "p* at Bo > 0");
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
  const std::array<const char*, 4> powers{"p1 of g_c", "p2 of g_c", "p3 of g_c", "p4 of g_c"};
  for (int order = 4; order >= 1; --order) {
    result.need(powers[static_cast<std::size_t>(order - 1)], levels.bond_number, order + 1, "Bo");
  }
  result.make_room(law, static_cast<int>(data));
  return result.terms();
}

std::vector<double> point_weights(std::span<const StatePoint> points,
                                  const PointSelection& selection,
                                  const SolvedLaw& solved,
                                  FitSummary& summary) {
  summary.left_out.insert(
      summary.left_out.end(), selection.left_out.begin(), selection.left_out.end());
  std::vector<double> weights(points.size(), 0.0);
  for (std::size_t k = 0; k < selection.used.size(); ++k) {
    const std::size_t i = selection.used[k];
    weights[i] = solved.kept[k];
    if (!selection.data[k].flagged) continue;
    std::ostringstream text;
    text.precision(2);
    text << label(points[i], i) << " is outside the range of the law and kept the weight "
         << solved.kept[k];
    summary.notes.push_back(text.str());
  }
  return weights;
}

}  // namespace grainlaw::calibration
