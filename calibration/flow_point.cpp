#include <algorithm>
#include <cmath>
#include <sstream>

#include "calibration/mu_phi_fit.h"
#include "calibration/observations.h"
#include "calibration/power_profile.h"
#include "dem/estimate_text.h"
#include "dem/statistics.h"

namespace grainlaw::calibration {
namespace {

using dem::LocalRow;

/// The numbers of a flow point from one set of rows.
struct PointValues {
  double friction = 0.0;
  double inertial_number = 0.0;
  double volume_fraction = 0.0;
  double no_slip_height = 0.0;  ///< [d]
  double mass_below = 0.0;      ///< [rho_p d]
  PowerProfile profile;
};

/// u(M) = int I sqrt(p / rho_p) / (d rho_p phi) dM with p = g cos(theta) M and I, phi constant:
/// I = 3/2 slope d rho_p phi sqrt(rho_p / (g cos(theta))). Friction is the ratio of the sums over
/// the rows: the mean of the ratios, weighted by pressure.
PointValues evaluate(const dem::ChuteConditions& grains,
                     const std::vector<LocalRow>& rows,
                     const std::vector<std::size_t>& chosen,
                     const std::vector<double>& errors) {
  PointValues point;
  std::vector<double> mass_above, velocity;
  double shear_stress = 0.0, normal_stress = 0.0;
  for (const std::size_t k : chosen) {
    mass_above.push_back(rows[k].mass_above);
    velocity.push_back(rows[k].velocity.value);
    shear_stress += rows[k].shear_stress.value;
    normal_stress += rows[k].normal_stress.value;
    point.volume_fraction += rows[k].volume_fraction.value / static_cast<double>(chosen.size());
  }
  point.friction = shear_stress / normal_stress;
  point.profile = fit_power_profile(mass_above, velocity, errors);
  const double mass_unit = grains.grain_density * grains.grain_diameter;
  point.inertial_number =
      1.5 * point.profile.slope * mass_unit * point.volume_fraction *
      std::sqrt(grains.grain_density / (grains.gravity * std::cos(grains.inclination)));
  point.mass_below = (grains.mass_per_area - point.profile.flowing_mass) / mass_unit;
  point.no_slip_height = MassColumn(rows, grains.grain_density).height(point.profile.flowing_mass) /
                         grains.grain_diameter;
  return point;
}

void store_values(const PointValues& values, FlowPoint& point) {
  point.friction.value = values.friction;
  point.inertial_number.value = values.inertial_number;
  point.volume_fraction.value = values.volume_fraction;
  point.no_slip_height.value = values.no_slip_height;
  point.mass_below.value = values.mass_below;
}

/// Jackknife over the blocks: one number per point and block, so every correlation between rows and
/// fields is in it.
void store_jackknife_errors(const std::vector<PointValues>& without, FlowPoint& point) {
  const auto error = [&](double PointValues::*field) {
    std::vector<double> values;
    values.reserve(without.size());
    for (const PointValues& one : without) values.push_back(one.*field);
    return jackknife_error(values);
  };
  point.friction.error = error(&PointValues::friction);
  point.inertial_number.error = error(&PointValues::inertial_number);
  point.volume_fraction.error = error(&PointValues::volume_fraction);
  point.no_slip_height.error = error(&PointValues::no_slip_height);
  point.mass_below.error = error(&PointValues::mass_below);
}

double mean_error(const dem::LocalData& data,
                  const Observations& observations,
                  dem::Estimate LocalRow::*field) {
  double sum = 0.0;
  for (const double error : weight_errors(data.rows, observations.rows, field)) sum += error;
  return sum / static_cast<double>(observations.rows.size());
}

/// Without blocks the correlation between rows is unknown: means get the error of a single row (all
/// rows move together), the profile the one of independent rows.
void store_row_errors(const dem::LocalData& data,
                      const Observations& observations,
                      const PointValues& values,
                      FlowPoint& point) {
  point.friction.error = mean_error(data, observations, &LocalRow::friction);
  point.volume_fraction.error = mean_error(data, observations, &LocalRow::volume_fraction);
  point.inertial_number.error =
      values.inertial_number * values.profile.slope_error / values.profile.slope;
  const double mass_unit = data.conditions.grain_density * data.conditions.grain_diameter;
  point.mass_below.error = values.profile.flowing_mass_error / mass_unit;
  point.no_slip_height.error = point.mass_below.error / values.volume_fraction;
  point.notes.push_back(data.name +
                        ": no frames to form blocks from; the error of I takes velocities of "
                        "different rows as independent and is too small");
}

/// Within three standard errors of a normal distribution, or as many of Student's as cover the same
/// share when the error itself comes from few blocks.
bool in_balance(const FlowPoint& point) {
  constexpr double one_sided = 0.99865;
  constexpr double rounding = 1e-12;  // of sums over rows without any scatter
  const double most = point.blocks > 1 ? dem::student_quantile(one_sided, point.blocks - 1) : 3.0;
  return std::abs(point.friction.value - std::tan(point.inclination)) <=
         most * point.friction.error + rounding;
}

void note_imbalance(FlowPoint& point) {
  if (in_balance(point)) return;
  std::ostringstream text;
  text.precision(4);
  text << point.name << ": measured friction "
       << value_with_error(point.friction.value, point.friction.error)
       << " differs from tan(theta) = " << std::tan(point.inclination)
       << " by more than chance allows (3 standard errors): the layer is not in balance or the "
          "stress is biased; "
          "the fit takes the measured value";
  point.notes.push_back(text.str());
}

/// The fitted velocity is an integral of the law over the whole layer, so the law is tested from
/// the surface, p* = 0, to the base.
void store_softness_range(const dem::ChuteConditions& grains, FlowPoint& point) {
  if (!(grains.stiffness > 0.0)) return;
  const double pressure = grains.gravity * std::cos(grains.inclination) * grains.mass_per_area;
  point.softness_upper = pressure * grains.grain_diameter / grains.stiffness;
}

}  // namespace

FlowPoint flow_point(const dem::LocalData& data, const RowSelection& selection) {
  const Observations observations = select_rows(data, selection);
  const std::vector<double> errors =
      weight_errors(data.rows, observations.rows, &LocalRow::velocity);
  const PointValues values = evaluate(data.conditions, data.rows, observations.rows, errors);
  if (!(values.profile.slope > 0.0)) {
    throw FitError("run '" + data.name +
                   "': the velocity does not rise towards the surface, there is no shear flow");
  }
  FlowPoint point;
  point.name = data.name;
  point.inclination = data.conditions.inclination;
  point.left_out = observations.left_out;
  store_values(values, point);

  const auto blocks = blocks_for_fit(data);
  point.blocks = static_cast<int>(blocks.size());
  std::vector<PointValues> without;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    without.push_back(
        evaluate(data.conditions, mean_without(blocks, b), observations.rows, errors));
  }
  if (without.empty()) {
    store_row_errors(data, observations, values, point);
  } else {
    store_jackknife_errors(without, point);
  }
  store_softness_range(data.conditions, point);
  note_imbalance(point);
  return point;
}

continuum::EffectiveBase effective_base(const FlowPoint& point) {
  return {.no_slip_height = std::max(0.0, point.no_slip_height.value),
          .mass_below = std::max(0.0, point.mass_below.value)};
}

dem::Estimate friction_for_fit(const FlowPoint& point) {
  return in_balance(point) ? dem::Estimate{std::tan(point.inclination), 0.0} : point.friction;
}

}  // namespace grainlaw::calibration
