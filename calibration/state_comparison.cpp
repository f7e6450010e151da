#include "calibration/state_comparison.h"

#include <cmath>
#include <functional>
#include <limits>

#include "calibration/fittable_law.h"
#include "continuum/homogeneous_shear.h"

namespace grainlaw::calibration {
namespace {

using continuum::HomogeneousState;
using continuum::RheologyTable;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

HomogeneousState law_at(const RheologyTable& table, const State& s) {
  return continuum::homogeneous_shear(table, {s.inertial_number}, {s.softness}, {s.bond_number})
      .front();
}

/// One number of the law at a state.
using Number = std::function<double(const RheologyTable&, const State&)>;

double friction_of(const RheologyTable& table, const State& state) {
  return law_at(table, state).friction.value_or(nan);
}

double fraction_of(const RheologyTable& table, const State& state) {
  return law_at(table, state).volume_fraction.value_or(nan);
}

/// Derivative by one number of the state; the laws are smooth.
double slope(const Number& number, const RheologyTable& table, State state, double State::*by) {
  const double centre = state.*by;
  const double step = 1e-4 * centre;
  if (!(step > 0.0)) return 0.0;
  state.*by = centre + step;
  const double high = number(table, state);
  state.*by = centre - step;
  return (high - number(table, state)) / (2.0 * step);
}

double known(double error) {
  return std::isfinite(error) ? error : 0.0;
}

LawResidual residual(const Number& number,
                     const RheologyTable& table,
                     const StatePoint& point,
                     const dem::Estimate& measured,
                     const State& state) {
  LawResidual result;
  result.law = propagated(table, [&](const RheologyTable& t) { return number(t, state); });
  const double by_I = slope(number, table, state, &State::inertial_number);
  const double by_softness = slope(number, table, state, &State::softness);
  result.difference = result.law.value / measured.value - 1.0;
  result.statistics = std::hypot(known(measured.error),
                                 by_I * known(point.inertial_number.error),
                                 by_softness * known(point.softness.error)) /
                      measured.value;
  result.law_error = known(result.law.error) / measured.value;
  result.in_standard_errors = result.difference / std::hypot(result.statistics, result.law_error);
  return result;
}

void flag(std::vector<continuum::RangeFlag>& flags,
          const char* quantity,
          const std::optional<continuum::Range>& range,
          double value,
          bool upper_end_only = false) {
  if (!range || (value <= range->upper && (upper_end_only || value >= range->lower))) return;
  flags.push_back({.quantity = quantity,
                   .lower = range->lower,
                   .upper = range->upper,
                   .reached_lowest = value,
                   .reached_highest = value,
                   .fraction_outside = 1.0});
}

}  // namespace

StatePoint state_of(const dem::LocalRow& row,
                    const dem::ChuteConditions& conditions,
                    const std::string& name) {
  const auto positive = [](const dem::Estimate& estimate) {
    return dem::Estimate{std::abs(estimate.value), estimate.error, estimate.effective_samples};
  };
  StatePoint point;
  point.name = name;
  point.inertial_number = positive(row.inertial_number);
  point.softness = row.softness;
  point.friction = positive(row.friction);
  point.volume_fraction = row.volume_fraction;
  const double d = conditions.grain_diameter;
  const double stress = row.normal_stress.value;
  const double bond_number = conditions.attraction / (stress * d * d);
  point.bond_number = {bond_number, bond_number * known(row.normal_stress.error) / stress};
  return point;
}

StateComparison compare_state(const StatePoint& point, const RheologyTable& table) {
  const State state{point.inertial_number.value, point.softness.value, point.bond_number.value};
  StateComparison result{
      .point = point, .friction = {}, .volume_fraction = {}, .out_of_domain = {}};
  result.friction = residual(friction_of, table, point, point.friction, state);
  result.volume_fraction = residual(fraction_of, table, point, point.volume_fraction, state);
  const double by_I = slope(friction_of, table, state, &State::inertial_number);
  const double condition = result.friction.law.value / (state.inertial_number * by_I);
  if (std::isfinite(condition)) result.condition_number = condition;
  flag(result.out_of_domain, "I", table.range.inertial_number, state.inertial_number);
  flag(result.out_of_domain, "p*", table.range.softness, state.softness, true);
  flag(result.out_of_domain, "Bo", table.range.bond_number, state.bond_number);
  return result;
}

double rms_difference(const std::vector<StateComparison>& states,
                      LawResidual StateComparison::*quantity) {
  double sum = 0.0;
  int count = 0;
  for (const StateComparison& state : states) {
    const double difference = (state.*quantity).difference;
    if (!std::isfinite(difference)) continue;
    sum += difference * difference;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : nan;
}

}  // namespace grainlaw::calibration
