#include "calibration/comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/observations.h"

namespace grainlaw::calibration {
namespace {

using continuum::Profile;
using continuum::ProfileRow;
using dem::LocalRow;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Linear interpolation of a field of the profile rows, constant beyond the ends.
template <class Field>
double interpolate(const std::vector<ProfileRow>& rows, double z, Field field) {
  if (z <= rows.front().z) return field(rows.front());
  for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
    if (z > rows[k + 1].z) continue;
    const double share = (z - rows[k].z) / (rows[k + 1].z - rows[k].z);
    return (1.0 - share) * field(rows[k]) + share * field(rows[k + 1]);
  }
  return field(rows.back());
}

/// phi of the prediction: that of the lowest row also below the no-slip height, where grains lie
/// between those of the base; none above the free surface.
double volume_fraction_at(const Profile& profile, double z) {
  if (z > std::max(profile.height, profile.rows.back().z)) return 0.0;
  return interpolate(profile.rows, z, [](const ProfileRow& row) { return row.volume_fraction; });
}

/// mu of the prediction; at the surface itself 0/0, so from the rows that carry a load.
double friction_at(const Profile& profile, double z) {
  std::vector<ProfileRow> loaded;
  for (const ProfileRow& row : profile.rows) {
    if (row.pressure > 0.0) loaded.push_back(row);
  }
  if (loaded.empty()) return nan;
  return interpolate(
      loaded, z, [](const ProfileRow& row) { return row.shear_stress / row.pressure; });
}

/// Rows from z = 0 up to where phi falls below half its bulk value (its median over those rows).
std::vector<std::size_t> compared_rows(const std::vector<LocalRow>& rows) {
  std::vector<double> fractions;
  std::vector<std::size_t> above_base;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double phi = rows[k].volume_fraction.value;
    if (rows[k].z < 0.0 || !std::isfinite(phi) || !std::isfinite(rows[k].velocity.value)) continue;
    above_base.push_back(k);
    fractions.push_back(phi);
  }
  const double half_bulk = 0.5 * median(fractions);
  const auto dilute = [&](std::size_t k) { return rows[k].volume_fraction.value < half_bulk; };
  // From the top down: a dilute layer right at the base is part of the comparison.
  while (!above_base.empty() && dilute(above_base.back())) above_base.pop_back();
  return above_base;
}

std::vector<LocalRow> picked(const std::vector<LocalRow>& rows,
                             const std::vector<std::size_t>& chosen) {
  std::vector<LocalRow> result;
  result.reserve(chosen.size());
  for (const std::size_t k : chosen) result.push_back(rows[k]);
  return result;
}

double row_width(const std::vector<LocalRow>& rows) {
  return rows.size() > 1 ? rows[1].z - rows[0].z : 0.0;
}

/// Relative L2 over bins of equal width; bins where one side has no value do not count.
double relative_l2(const std::vector<double>& predicted, const std::vector<double>& measured) {
  double difference = 0.0, norm = 0.0;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (!std::isfinite(predicted[k]) || !std::isfinite(measured[k])) continue;
    difference += std::pow(predicted[k] - measured[k], 2);
    norm += measured[k] * measured[k];
  }
  return norm > 0.0 ? std::sqrt(difference / norm) : nan;
}

/// All relative errors of one set of measured rows.
struct Norms {
  double velocity = nan;
  double velocity_maximum = nan;
  double volume_fraction = nan;
  double friction = nan;
  double surface_velocity = nan;
  double flux = nan;
};

Norms norms(const Predicted& predicted,
            const std::vector<LocalRow>& rows,
            const std::vector<bool>& dense) {
  std::vector<double> velocity, volume_fraction, friction;
  double largest = 0.0, largest_difference = 0.0, flux = 0.0, predicted_flux = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const LocalRow& row = rows[i];
    velocity.push_back(row.velocity.value);
    volume_fraction.push_back(dense[i] ? row.volume_fraction.value : nan);
    friction.push_back(dense[i] ? row.shear_stress.value / row.normal_stress.value : nan);
    largest = std::max(largest, std::abs(velocity[i]));
    largest_difference =
        std::max(largest_difference, std::abs(predicted.velocity[i] - velocity[i]));
    flux += row.volume_fraction.value * velocity[i];
    predicted_flux += predicted.volume_fraction[i] * predicted.velocity[i];
  }
  return {.velocity = relative_l2(predicted.velocity, velocity),
          .velocity_maximum = largest_difference / largest,
          .volume_fraction = relative_l2(predicted.volume_fraction, volume_fraction),
          .friction = relative_l2(predicted.friction, friction),
          .surface_velocity = predicted.velocity.back() / velocity.back() - 1.0,
          .flux = predicted_flux / flux - 1.0};
}

/// The norms of the whole window with the jackknife error over its blocks; without blocks no error.
dem::Estimate with_error(const Norms& whole,
                         const std::vector<Norms>& without,
                         double Norms::*norm) {
  std::vector<double> values;
  values.reserve(without.size());
  for (const Norms& one : without) values.push_back(one.*norm);
  return {whole.*norm, values.empty() ? nan : jackknife_error(values)};
}

double residual_in_errors(const Predicted& predicted, const std::vector<LocalRow>& rows) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const dem::Estimate& measured = rows[i].velocity;
    if (!(measured.error > 0.0)) continue;
    sum += std::pow((predicted.velocity[i] - measured.value) / measured.error, 2);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : nan;
}

/// Root of the sum of squares of some lengths of velocity over that of the measured velocities.
template <class Part>
double relative_norm(const std::vector<LocalRow>& rows, Part part) {
  double sum = 0.0, norm = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double value = part(i);
    norm += rows[i].velocity.value * rows[i].velocity.value;
    if (std::isfinite(value)) sum += value * value;
  }
  return norm > 0.0 ? std::sqrt(sum / norm) : nan;
}

}  // namespace

continuum::ChuteCase chute_case(const dem::ChuteConditions& conditions) {
  continuum::ChuteCase chute;
  chute.inclination = conditions.inclination;
  chute.gravity = conditions.gravity;
  chute.mass_per_area = conditions.mass_per_area;
  chute.grains.diameter = conditions.grain_diameter;
  chute.grains.density = conditions.grain_density;
  chute.grains.stiffness = conditions.stiffness;
  if (conditions.attraction > 0.0) chute.grains.adhesion = conditions.attraction;
  return chute;
}

std::string_view name(SampleKind kind) {
  switch (kind) {
    case SampleKind::in_sample:
      return "in sample";
    case SampleKind::leave_one_out:
      return "left out";
    case SampleKind::interpolation:
      return "interpolation";
    case SampleKind::extrapolation:
      return "extrapolation";
    case SampleKind::cross_geometry:
      return "cross geometry";
    case SampleKind::independent:
      break;
  }
  return "independent table";
}

SampleKind sample_kind(double inclination, const std::vector<double>& fitted_inclinations) {
  constexpr double same = 1e-6;  // [rad]: rounding of degrees in files
  if (fitted_inclinations.empty()) return SampleKind::independent;
  bool below = false, above = false;
  for (const double fitted : fitted_inclinations) {
    if (std::abs(fitted - inclination) < same) return SampleKind::in_sample;
    (fitted < inclination ? below : above) = true;
  }
  return below && above ? SampleKind::interpolation : SampleKind::extrapolation;
}

MeasuredRows measured_rows(const dem::LocalData& measured) {
  const std::vector<std::size_t> chosen = compared_rows(measured.rows);
  MeasuredRows result{.rows = picked(measured.rows, chosen), .blocks = {}, .dense = {}};
  for (const auto& block : block_rows(measured)) result.blocks.push_back(picked(block, chosen));
  const double reach = measured.frames.kernel.reach();
  const double surface =
      result.rows.empty() ? 0.0 : result.rows.back().z + 0.5 * row_width(result.rows);
  // Half the bulk density is where the surface is: the kernel is symmetric.
  for (const LocalRow& row : result.rows) {
    result.dense.push_back(reach == 0.0 || row.z <= surface - reach);
  }
  return result;
}

Predicted predict_at(const Profile& profile, const std::vector<LocalRow>& rows) {
  Predicted predicted;
  for (const LocalRow& row : rows) {
    predicted.velocity.push_back(velocity_at(profile, row.z));
    predicted.velocity_error.push_back(
        interpolate(profile.rows, row.z, [](const ProfileRow& at) { return at.velocity_error; }));
    predicted.volume_fraction.push_back(volume_fraction_at(profile, row.z));
    predicted.friction.push_back(friction_at(profile, row.z));
  }
  return predicted;
}

ProfileError profile_error(const Predicted& predicted, const MeasuredRows& measured) {
  const auto& rows = measured.rows;
  const Norms whole = norms(predicted, rows, measured.dense);
  std::vector<Norms> without;
  for (std::size_t b = 0; b < measured.blocks.size(); ++b) {
    without.push_back(norms(predicted, mean_without(measured.blocks, b), measured.dense));
  }
  ProfileError error{
      .velocity = with_error(whole, without, &Norms::velocity),
      .velocity_maximum = with_error(whole, without, &Norms::velocity_maximum),
      .volume_fraction = with_error(whole, without, &Norms::volume_fraction),
      .friction = with_error(whole, without, &Norms::friction),
      .surface_velocity = with_error(whole, without, &Norms::surface_velocity),
      .flux = with_error(whole, without, &Norms::flux),
      .in_standard_errors = residual_in_errors(predicted, rows),
      .statistics = relative_norm(rows, [&](std::size_t i) { return rows[i].velocity.error; }),
      .law = relative_norm(rows, [&](std::size_t i) { return predicted.velocity_error[i]; })};
  const double half_row = 0.5 * row_width(rows);
  error.velocity_top = rows.back().z + half_row;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (measured.dense[i]) error.fraction_top = rows[i].z + half_row;
  }
  return error;
}

ProfileError profile_error(const dem::LocalData& measured, const Profile& predicted) {
  const MeasuredRows compared = measured_rows(measured);
  if (compared.rows.empty() || predicted.rows.empty()) {
    throw FitError("run '" + measured.name + "': nothing to compare, " +
                   (compared.rows.empty() ? "the run has no rows above the base"
                                          : "the prediction has no profile"));
  }
  return profile_error(predict_at(predicted, compared.rows), compared);
}

double velocity_distance(const dem::LocalData& measured, const Profile& one, const Profile& other) {
  const std::vector<LocalRow> rows = picked(measured.rows, compared_rows(measured.rows));
  return relative_norm(rows, [&](std::size_t i) {
    return velocity_at(one, rows[i].z) - velocity_at(other, rows[i].z);
  });
}

double ErrorBudget::rest() const {
  const double known =
      statistics * statistics + law * law + geometry * geometry + numerics * numerics;
  return std::sqrt(std::max(0.0, total * total - known));
}

dem::Estimate propagated(const continuum::RheologyTable& table,
                         const std::function<double(const continuum::RheologyTable&)>& number) {
  const double value = number(table);
  if (!table.covariance) return {.value = value};
  const continuum::Covariance& covariance = *table.covariance;
  const std::size_t size = covariance.names.size();
  // A hundredth of a standard error: small against the curvature of the laws, large against
  // rounding; upwards, where every coefficient stays one.
  std::vector<double> slope(size, 0.0);
  for (std::size_t i = 0; i < size; ++i) {
    const double step = 0.01 * std::sqrt(covariance(i, i));
    if (!(step > 0.0)) continue;
    continuum::RheologyTable moved = table;
    const std::string& name = covariance.names[i];
    continuum::set_coefficient(moved, name, continuum::coefficient(table, name) + step);
    slope[i] = (number(moved) - value) / step;
  }
  double variance = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) variance += slope[i] * covariance(i, j) * slope[j];
  }
  return {.value = value, .error = std::sqrt(std::max(0.0, variance))};
}

double velocity_at(const Profile& profile, double z) {
  if (profile.rows.empty() || z < profile.rows.front().z) return 0.0;
  return interpolate(profile.rows, z, [](const ProfileRow& row) { return row.velocity; });
}

Profile naive_guess(const dem::LocalData& nearest, const dem::ChuteConditions& target) {
  const dem::ChuteConditions& near = nearest.conditions;
  const double mass_ratio = target.mass_per_area / near.mass_per_area;
  const double drive = target.gravity * std::sin(target.inclination);
  const double drive_ratio = drive / (near.gravity * std::sin(near.inclination));
  const double velocity_ratio = std::pow(mass_ratio, 1.5) * std::sqrt(drive_ratio);
  Profile guess;
  for (const LocalRow& row : nearest.rows) {
    if (!std::isfinite(row.velocity.value) || !std::isfinite(row.volume_fraction.value)) continue;
    const double mass_above = mass_ratio * row.mass_above;
    const double pressure = target.gravity * std::cos(target.inclination) * mass_above;
    const double shear_rate = velocity_ratio / mass_ratio * row.shear_rate.value;
    guess.rows.push_back({.z = mass_ratio * row.z,
                          .mass_above = mass_above,
                          .velocity = velocity_ratio * row.velocity.value,
                          .shear_rate = shear_rate,
                          .shear_stress = drive * mass_above,
                          .pressure = pressure,
                          .volume_fraction = row.volume_fraction.value,
                          .inertial_number = shear_rate * target.grain_diameter *
                                             std::sqrt(target.grain_density / pressure)});
  }
  if (guess.rows.size() < 2) {
    throw FitError("run '" + nearest.name + "' has fewer than two rows to make a guess from");
  }
  const double width = guess.rows[1].z - guess.rows[0].z;
  guess.height = guess.rows.back().z + 0.5 * width;
  guess.surface_velocity = guess.rows.back().velocity;
  for (const ProfileRow& row : guess.rows) guess.flux += row.volume_fraction * row.velocity * width;
  return guess;
}

}  // namespace grainlaw::calibration
