#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "continuum/chute_1d.h"
#include "continuum/layer.h"
#include "continuum/steady_profile.h"

namespace grainlaw::continuum {
namespace {

/// Step of the finite differences in standard errors: truncation (step^2) and rounding (1e-13 /
/// step / relative error) both stay far below the 1e-3 that a standard error needs.
constexpr double step_in_errors = 1e-2;

/// Derivatives of the rows with respect to one coefficient, times its standard error.
struct Sensitivity {
  std::vector<double> velocity;
  std::vector<double> volume_fraction;
};

/// The profile with one coefficient moved; absent where no steady flow exists any more.
std::optional<Profile> moved_profile(const RheologyTable& table,
                                     const ChuteCase& chute,
                                     const SteadyOptions& options,
                                     const std::string& name,
                                     double value) {
  RheologyTable moved = table;
  set_coefficient(moved, name, value);
  const Layer layer = make_layer(moved, chute);
  const Verdict verdict = steady_verdict(layer);
  if (!flows(verdict.outcome)) return std::nullopt;
  return in_case_units(layer, steady_profile(layer, verdict.plug_mass, options));
}

double volume_fraction_slope(const std::vector<ProfileRow>& rows, std::size_t i) {
  const ProfileRow& below = rows[i == 0 ? 0 : i - 1];
  const ProfileRow& above = rows[std::min(i + 1, rows.size() - 1)];
  return (above.volume_fraction - below.volume_fraction) / (above.z - below.z);
}

/// Rows of two moved profiles belong to the same relative mass. A band is drawn over z, so what the
/// shift of a row alone changes is taken off: d/dc at fixed z = d/dc at fixed row - d/dz dz/dc.
Sensitivity difference(const Profile& at, const Profile& high, const Profile& low, double steps) {
  Sensitivity result;
  for (std::size_t i = 0; i < at.rows.size(); ++i) {
    const ProfileRow& h = high.rows[i];
    const ProfileRow& l = low.rows[i];
    const double shift = h.z - l.z;
    result.velocity.push_back((h.velocity - l.velocity - at.rows[i].shear_rate * shift) / steps);
    result.volume_fraction.push_back(
        (h.volume_fraction - l.volume_fraction - volume_fraction_slope(at.rows, i) * shift) /
        steps);
  }
  return result;
}

/// Central difference; one-sided where the other side would be negative or has no steady flow.
std::optional<Sensitivity> sensitivity(const RheologyTable& table,
                                       const ChuteCase& chute,
                                       const Profile& profile,
                                       const std::string& name,
                                       double error) {
  const SteadyOptions options{.rows = static_cast<int>(profile.rows.size())};
  const double value = coefficient(table, name);
  const double step = step_in_errors * error;
  const auto high = moved_profile(table, chute, options, name, value + step);
  const bool has_low = value < 0.0 || value >= step;
  const auto low =
      has_low ? moved_profile(table, chute, options, name, value - step) : std::nullopt;
  if (high && low) return difference(profile, *high, *low, 2.0 * step_in_errors);
  if (high) return difference(profile, *high, profile, step_in_errors);
  if (low) return difference(profile, profile, *low, step_in_errors);
  return std::nullopt;
}

}  // namespace

void add_error_band(SteadyChute& steady, const RheologyTable& table, const ChuteCase& chute) {
  auto& rows = steady.profile.rows;
  if (!table.covariance || rows.empty()) return;
  const Covariance& covariance = *table.covariance;
  const std::size_t n = covariance.names.size();
  std::vector<double> error(n);
  std::vector<Sensitivity> change(n);
  for (std::size_t i = 0; i < n; ++i) {
    error[i] = std::sqrt(covariance(i, i));
    if (error[i] == 0.0) continue;
    auto found = sensitivity(table, chute, steady.profile, covariance.names[i], error[i]);
    if (!found) {
      steady.answer.text +=
          fmt::format("; no band: a step of {} leaves the steady flows", covariance.names[i]);
      return;
    }
    change[i] = std::move(*found);
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    double velocity = 0.0;
    double volume_fraction = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        if (error[i] == 0.0 || error[j] == 0.0) continue;
        const double correlation = covariance(i, j) / (error[i] * error[j]);
        velocity += change[i].velocity[k] * correlation * change[j].velocity[k];
        volume_fraction +=
            change[i].volume_fraction[k] * correlation * change[j].volume_fraction[k];
      }
    }
    // a covariance with a zero eigenvalue may end at -1e-17
    rows[k].velocity_error = std::sqrt(std::max(0.0, velocity));
    rows[k].volume_fraction_error = std::sqrt(std::max(0.0, volume_fraction));
  }
}

}  // namespace grainlaw::continuum
