#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "continuum/shear_band.h"

namespace grainlaw::continuum {
namespace {

/// Step of the finite differences in standard errors: see error_band.cpp.
constexpr double step_in_errors = 1e-2;

double sought_value(const ShearBand& band) {
  return band.sought == ShearBand::Sought::stress ? band.driving_stress : band.driving_velocity;
}

/// The quantity sought with one coefficient moved; absent where nothing flows any more.
std::optional<double> moved(const RheologyTable& table,
                            const ShearBandCase& of,
                            const ShearBandOptions& options,
                            const std::string& name,
                            double step) {
  const double value = coefficient(table, name) + step;
  if (value < 0.0 && step < 0.0) return std::nullopt;
  RheologyTable other = table;
  set_coefficient(other, name, value);
  other.covariance.reset();
  const ShearBand band = shear_band(other, of, options);
  if (!flows(band.answer.outcome)) return std::nullopt;
  return sought_value(band);
}

/// Change of the quantity sought per standard error of a coefficient: central difference, one-sided
/// where one side is negative or does not flow.
std::optional<double> sensitivity(const RheologyTable& table,
                                  const ShearBandCase& of,
                                  const ShearBand& band,
                                  const std::string& name,
                                  double error) {
  const ShearBandOptions options{.cells = band.cells, .most_cells = band.cells, .rows = 2};
  const double step = step_in_errors * error;
  const auto high = moved(table, of, options, name, step);
  const auto low = moved(table, of, options, name, -step);
  if (!high && !low) return std::nullopt;
  const double difference = high.value_or(sought_value(band)) - low.value_or(sought_value(band));
  return difference / ((high && low ? 2.0 : 1.0) * step_in_errors);
}

}  // namespace

void add_error(ShearBand& band, const RheologyTable& table, const ShearBandCase& of) {
  if (!table.covariance || !flows(band.answer.outcome)) return;
  const Covariance& covariance = *table.covariance;
  const std::size_t n = covariance.names.size();
  std::vector<double> change(n, 0.0);
  std::vector<double> error(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    error[i] = std::sqrt(covariance(i, i));
    if (error[i] == 0.0) continue;
    const auto found = sensitivity(table, of, band, covariance.names[i], error[i]);
    if (!found) {
      band.answer.text +=
          fmt::format("; no error: a step of {} leaves the steady flows", covariance.names[i]);
      return;
    }
    change[i] = *found;
  }
  double variance = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (error[i] > 0.0 && error[j] > 0.0)
        variance += change[i] * change[j] * covariance(i, j) / (error[i] * error[j]);
  band.error = std::sqrt(std::max(0.0, variance));
}

}  // namespace grainlaw::continuum
