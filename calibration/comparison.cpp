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

/// A prediction at the heights of the compared rows.
struct Predicted {
  std::vector<double> velocity;
  std::vector<double> volume_fraction;
  std::vector<double> friction;
};

Predicted predict_at(const Profile& profile,
                     const std::vector<LocalRow>& rows,
                     const std::vector<std::size_t>& chosen) {
  Predicted predicted;
  for (const std::size_t k : chosen) {
    predicted.velocity.push_back(velocity_at(profile, rows[k].z));
    predicted.volume_fraction.push_back(volume_fraction_at(profile, rows[k].z));
    predicted.friction.push_back(friction_at(profile, rows[k].z));
  }
  return predicted;
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
            const std::vector<std::size_t>& chosen) {
  std::vector<double> velocity, volume_fraction, friction;
  double largest = 0.0, largest_difference = 0.0, flux = 0.0, predicted_flux = 0.0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const LocalRow& row = rows[chosen[i]];
    velocity.push_back(row.velocity.value);
    volume_fraction.push_back(row.volume_fraction.value);
    friction.push_back(row.shear_stress.value / row.normal_stress.value);
    largest = std::max(largest, std::abs(velocity[i]));
    largest_difference =
        std::max(largest_difference, std::abs(predicted.velocity[i] - velocity[i]));
    flux += volume_fraction[i] * velocity[i];
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

double residual_in_errors(const Predicted& predicted,
                          const std::vector<LocalRow>& rows,
                          const std::vector<std::size_t>& chosen) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const dem::Estimate& measured = rows[chosen[i]].velocity;
    if (!(measured.error > 0.0)) continue;
    sum += std::pow((predicted.velocity[i] - measured.value) / measured.error, 2);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : nan;
}

/// Velocity averaged over all flowing mass; the mass below the no-slip height is at rest.
double mean_velocity(const Profile& profile, double mass_per_area) {
  double momentum = 0.0;
  for (std::size_t k = 0; k + 1 < profile.rows.size(); ++k) {
    const ProfileRow& low = profile.rows[k];
    const ProfileRow& high = profile.rows[k + 1];
    momentum += 0.5 * (low.velocity + high.velocity) * (low.mass_above - high.mass_above);
  }
  return momentum / mass_per_area;
}

const dem::ProfileFrame* frame_at(const dem::ProfileFrames& frames, double time) {
  for (const dem::ProfileFrame& frame : frames.frames) {
    if (frame.begin <= time && time < frame.end) return &frame;
  }
  return nullptr;
}

/// L2 distance of the velocities of one frame from a profile over the L2 of the steady profile.
double frame_error(const dem::LocalData& measured,
                   const std::vector<std::size_t>& chosen,
                   const dem::ProfileFrame& frame,
                   const Profile& predicted) {
  const std::vector<double> velocity = dem::velocities(frame, measured.frames.bins_per_row);
  double difference = 0.0, norm = 0.0;
  for (const std::size_t k : chosen) {
    const LocalRow& row = measured.rows[k];
    norm += row.velocity.value * row.velocity.value;
    const auto bin = static_cast<std::size_t>(
        std::floor((row.z - measured.frames.z_begin) / measured.frames.row_width()));
    if (bin >= velocity.size() || !std::isfinite(velocity[bin])) continue;
    difference += std::pow(velocity_at(predicted, row.z) - velocity[bin], 2);
  }
  return norm > 0.0 ? std::sqrt(difference / norm) : nan;
}

}  // namespace

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

ProfileError profile_error(const dem::LocalData& measured, const Profile& predicted) {
  const std::vector<std::size_t> chosen = compared_rows(measured.rows);
  if (chosen.empty() || predicted.rows.empty()) {
    throw FitError(
        "run '" + measured.name + "': nothing to compare, " +
        (chosen.empty() ? "the run has no rows above the base" : "the prediction has no profile"));
  }
  const Predicted at_rows = predict_at(predicted, measured.rows, chosen);
  const Norms whole = norms(at_rows, measured.rows, chosen);
  const auto blocks = block_rows(measured);
  std::vector<Norms> without;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    without.push_back(norms(at_rows, mean_without(blocks, b), chosen));
  }
  return {.velocity = with_error(whole, without, &Norms::velocity),
          .velocity_maximum = with_error(whole, without, &Norms::velocity_maximum),
          .volume_fraction = with_error(whole, without, &Norms::volume_fraction),
          .friction = with_error(whole, without, &Norms::friction),
          .surface_velocity = with_error(whole, without, &Norms::surface_velocity),
          .flux = with_error(whole, without, &Norms::flux),
          .in_standard_errors = residual_in_errors(at_rows, measured.rows, chosen)};
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

std::vector<TransientError> transient_error(const dem::LocalData& measured,
                                            const std::vector<continuum::Snapshot>& predicted) {
  const std::vector<std::size_t> chosen = compared_rows(measured.rows);
  std::vector<TransientError> errors;
  for (const continuum::Snapshot& snapshot : predicted) {
    const dem::ProfileFrame* frame = frame_at(measured.frames, snapshot.time);
    if (frame == nullptr) continue;
    errors.push_back(
        {.time = snapshot.time,
         .measured_mean = dem::mean_velocity(*frame),
         .predicted_mean = mean_velocity(snapshot.profile, measured.conditions.mass_per_area),
         .velocity_error = frame_error(measured, chosen, *frame, snapshot.profile)});
  }
  return errors;
}

}  // namespace grainlaw::calibration
