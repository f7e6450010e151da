#include "calibration/mu_phi_fit.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <sstream>

#include "calibration/inertial_laws.h"
#include "calibration/observations.h"
#include "dem/estimate_text.h"

namespace grainlaw::calibration {
namespace {

void require_equal(const dem::LocalData& one,
                   const dem::LocalData& other,
                   double dem::ChuteConditions::*quantity,
                   const std::string& words) {
  const double x = one.conditions.*quantity;
  const double y = other.conditions.*quantity;
  if (std::abs(x - y) <= 1e-9 * std::max(std::abs(x), std::abs(y))) return;  // rounding of files
  std::ostringstream text;
  text << "runs '" << one.name << "' and '" << other.name << "' differ in " << words << " (" << x
       << " and " << y << "): mu(I), phi(I) hold for one kind of grains, fit them apart";
  throw FitError(text.str());
}

/// One law for one kind of grains on one kind of base.
void require_same_material(std::span<const dem::LocalData> runs) {
  for (const dem::LocalData& run : runs) {
    const dem::LocalData& first = runs.front();
    require_equal(first, run, &dem::ChuteConditions::grain_diameter, "grain diameter");
    require_equal(first, run, &dem::ChuteConditions::grain_density, "grain density");
    require_equal(first, run, &dem::ChuteConditions::contact_friction, "contact friction");
    require_equal(first, run, &dem::ChuteConditions::stiffness, "contact stiffness");
    if (run.conditions.base != first.conditions.base) {
      throw FitError("runs '" + first.name + "' and '" + run.name +
                     "' flow over different bases: the no-slip height belongs to a base, fit them "
                     "apart");
    }
  }
}

void require_two_tilts(const std::vector<FlowPoint>& points) {
  if (count_tilts(points) >= 2) return;
  throw FitError(
      points.size() < 2
          ? "mu(I) needs runs at two tilts at least, there is only one run"
          : "mu(I) needs runs at two tilts at least: runs at one tilt all measure the same point");
}

/// Weighted means of both numbers of the effective base over the tilts.
struct MeanBase {
  dem::Estimate no_slip_height;  ///< [d]
  dem::Estimate mass_below;      ///< [rho_p d]
  Matrix covariance = Matrix(2, 2);
  std::vector<std::string> notes = {};
};

struct WeightedMean {
  dem::Estimate mean;
  std::vector<double> shares;  ///< of each value in the mean
  std::vector<double> errors;
  double scatter = 1.0;  ///< factor on the error where the values scatter by more than their errors
};

WeightedMean weighted_mean(const std::vector<dem::Estimate>& values) {
  WeightedMean result;
  result.errors = weight_errors(values);
  double weights = 0.0;
  for (const double error : result.errors) weights += 1.0 / (error * error);
  result.mean.value = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    result.shares.push_back(1.0 / (result.errors[i] * result.errors[i] * weights));
    result.mean.value += result.shares[i] * values[i].value;
  }
  double chi_squared = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    chi_squared += std::pow((values[i].value - result.mean.value) / result.errors[i], 2);
  }
  const double freedom = static_cast<double>(values.size()) - 1.0;
  result.scatter = std::max(1.0, std::sqrt(chi_squared / freedom));
  result.mean.error = result.scatter / std::sqrt(weights);
  return result;
}

/// Height and mass of one run are two readings of one fitted number, so their errors are fully
/// correlated within a run.
MeanBase mean_base(const std::vector<FlowPoint>& points) {
  const WeightedMean height = weighted_mean(collect(points, &FlowPoint::no_slip_height));
  const WeightedMean mass = weighted_mean(collect(points, &FlowPoint::mass_below));
  MeanBase base{.no_slip_height = height.mean, .mass_below = mass.mean};
  for (std::size_t i = 0; i < points.size(); ++i) {
    base.covariance(0, 1) += height.shares[i] * mass.shares[i] * height.errors[i] * mass.errors[i];
  }
  base.covariance(0, 1) *= height.scatter * mass.scatter;
  base.covariance(1, 0) = base.covariance(0, 1);
  base.covariance(0, 0) = std::pow(height.mean.error, 2);
  base.covariance(1, 1) = std::pow(mass.mean.error, 2);
  std::ostringstream text;
  text.precision(2);
  text << "effective base: weighted mean over the runs, no-slip height "
       << value_with_error(height.mean.value, height.mean.error) << " d";
  if (height.scatter > 1.0) {
    text << "; the runs scatter by " << height.scatter
         << " times their own errors, the error is enlarged by this factor";
  }
  base.notes.push_back(text.str());
  if (height.mean.value < 0.0 || mass.mean.value < 0.0) {
    base.notes.emplace_back(
        "the velocities point to u = 0 below the base top: the grains slip; the table holds u = 0 "
        "at the base top instead");
    base.no_slip_height.value = std::max(0.0, height.mean.value);
    base.mass_below.value = std::max(0.0, mass.mean.value);
  }
  return base;
}

/// Joint covariance of parts that are taken as independent of each other.
continuum::Covariance block_diagonal(
    const std::vector<std::pair<std::vector<std::string>, Matrix>>& parts) {
  continuum::Covariance joint;
  for (const auto& [names, matrix] : parts) {
    joint.names.insert(joint.names.end(), names.begin(), names.end());
  }
  const std::size_t n = joint.names.size();
  joint.matrix.assign(n * n, 0.0);
  std::size_t first = 0;
  for (const auto& [names, matrix] : parts) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      for (std::size_t j = 0; j < names.size(); ++j) {
        joint.matrix[(first + i) * n + first + j] =
            matrix(static_cast<int>(i), static_cast<int>(j));
      }
    }
    first += names.size();
  }
  return joint;
}

std::vector<std::string> names_of(const FittedLaw& law) {
  std::vector<std::string> names;
  for (const FittedCoefficient& c : law.summary.coefficients) names.push_back(c.name);
  return names;
}

continuum::ValidRange explored(const std::vector<FlowPoint>& points) {
  continuum::Range inertial{std::numeric_limits<double>::infinity(), 0.0};
  continuum::Range softness = inertial;
  for (const FlowPoint& point : points) {
    inertial.lower = std::min(inertial.lower, point.inertial_number.value);
    inertial.upper = std::max(inertial.upper, point.inertial_number.value);
    softness.lower = std::min(softness.lower, point.softness_lower);
    softness.upper = std::max(softness.upper, point.softness_upper);
  }
  continuum::ValidRange range;
  range.inertial_number = inertial;
  if (softness.upper > 0.0) range.softness = softness;
  return range;
}

continuum::RheologyTable make_table(std::span<const dem::LocalData> runs,
                                    const std::vector<FlowPoint>& points,
                                    const FittedLaw& friction,
                                    const FittedLaw& fraction,
                                    const MeanBase& base) {
  const std::vector<double>& mu = friction.values;
  const std::vector<double>& phi = fraction.values;
  continuum::RheologyTable table;
  continuum::MuPhi law;
  law.friction = {.mu0 = mu[0], .beta = mu[1], .kappa = mu.size() > 2 ? mu[2] : 0.0};
  law.volume_fraction = {
      .phi0 = phi[0], .I_phi = phi.size() > 1 ? phi[1] : std::numeric_limits<double>::infinity()};
  table.law = law;
  table.contact_friction = runs.front().conditions.contact_friction;
  table.base = continuum::EffectiveBase{.no_slip_height = base.no_slip_height.value,
                                        .mass_below = base.mass_below.value,
                                        .recipe = runs.front().conditions.base};
  table.covariance = block_diagonal({{names_of(friction), friction.covariance},
                                     {names_of(fraction), fraction.covariance},
                                     {{"no_slip_height", "mass_below"}, base.covariance}});
  table.range = explored(points);
  table.provenance.source = "grainlaw, mu(I) and phi(I) fit over tilts";
  table.provenance.geometry = runs.front().conditions.geometry;
  for (const dem::LocalData& run : runs) table.provenance.data.push_back(run.name);
  return table;
}

}  // namespace

MuPhiFit fit_mu_phi(std::span<const dem::LocalData> runs, const RowSelection& selection) {
  require_same_material(runs);
  std::vector<FlowPoint> points;
  for (const dem::LocalData& run : runs) points.push_back(flow_point(run, selection));
  return fit_mu_phi(runs, std::move(points));
}

MuPhiFit fit_mu_phi(std::span<const dem::LocalData> runs, std::vector<FlowPoint> points) {
  const auto clock = std::chrono::steady_clock::now();
  require_same_material(runs);
  MuPhiFit fit;
  fit.points = std::move(points);
  require_two_tilts(fit.points);

  const FittedLaw friction = fit_friction(fit.points);
  const FittedLaw fraction = fit_volume_fraction(fit.points);
  const MeanBase base = mean_base(fit.points);
  fit.table = make_table(runs, fit.points, friction, fraction, base);
  fit.friction = friction.summary;
  fit.volume_fraction = fraction.summary;
  for (const FlowPoint& point : fit.points) {
    fit.friction.left_out.insert(
        fit.friction.left_out.end(), point.left_out.begin(), point.left_out.end());
    fit.friction.notes.insert(fit.friction.notes.end(), point.notes.begin(), point.notes.end());
  }
  fit.friction.notes.insert(fit.friction.notes.end(), base.notes.begin(), base.notes.end());
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - clock;
  fit.friction.wall_seconds = elapsed.count();
  return fit;
}

}  // namespace grainlaw::calibration
