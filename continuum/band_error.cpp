#include "continuum/band_error.h"

#include <algorithm>
#include <cmath>

namespace grainlaw::continuum {
namespace {

/// Step in standard errors: the velocity is read off between rows, to about 1e-5 of it.
constexpr double step_in_errors = 0.1;

double velocity_at(const std::vector<ProfileRow>& rows, double z) {
  const auto above = std::ranges::lower_bound(rows, z, {}, &ProfileRow::z);
  if (above == rows.begin()) return above->velocity;
  if (above == rows.end()) return rows.back().velocity;
  const ProfileRow& below = *(above - 1);
  return std::lerp(below.velocity, above->velocity, (z - below.z) / (above->z - below.z));
}

/// Change of the velocity of every row per standard error of one coefficient; empty where the step
/// leaves the steady flows.
std::vector<double> changes(const ShearBand& band,
                            const RheologyTable& table,
                            const ShearBandCase& of,
                            const std::string& name,
                            double error) {
  RheologyTable other = table;
  set_coefficient(other, name, coefficient(table, name) + step_in_errors * error);
  other.covariance.reset();
  const ShearBand moved =
      shear_band(other, of, {.cells = band.cells, .most_cells = band.cells, .rows = 801});
  if (!flows(moved.answer.outcome)) return {};
  const bool box = std::holds_alternative<BodyForceBox>(of.flow);
  const double stretch = box ? moved.profile.height / band.profile.height : 1.0;
  std::vector<double> result;
  for (const ProfileRow& row : band.profile.rows) {
    const double change = velocity_at(moved.profile.rows, stretch * row.z) - row.velocity;
    result.push_back(change / step_in_errors);
  }
  return result;
}

}  // namespace

void add_velocity_band(ShearBand& band, const RheologyTable& table, const ShearBandCase& of) {
  if (!table.covariance || !flows(band.answer.outcome)) return;
  const Covariance& covariance = *table.covariance;
  const std::size_t size = covariance.names.size();
  std::vector<double> variance(band.profile.rows.size(), 0.0);
  std::vector<double> error(size);
  std::vector<std::vector<double>> change(size);
  for (std::size_t i = 0; i < size; ++i) {
    error[i] = std::sqrt(covariance(i, i));
    if (error[i] == 0.0) continue;
    change[i] = changes(band, table, of, covariance.names[i], error[i]);
    if (change[i].empty()) return;
  }
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      if (error[i] == 0.0 || error[j] == 0.0) continue;
      const double correlation = covariance(i, j) / (error[i] * error[j]);
      for (std::size_t k = 0; k < variance.size(); ++k)
        variance[k] += correlation * change[i][k] * change[j][k];
    }
  }
  for (std::size_t k = 0; k < variance.size(); ++k)
    band.profile.rows[k].velocity_error = std::sqrt(std::max(0.0, variance[k]));
}

}  // namespace grainlaw::continuum
