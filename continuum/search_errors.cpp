#include <algorithm>
#include <array>
#include <cmath>

#include "continuum/steady_search.h"

namespace grainlaw::continuum {
namespace {

/// Step of the finite differences in standard errors, as in the error band of a profile.
constexpr double step_in_errors = 1e-2;
using Numbers = std::array<double, 5>;

std::optional<Numbers> moved(const RheologyTable& table,
                             const std::function<FoundChute(const RheologyTable&)>& find,
                             const std::string& name,
                             double value) {
  RheologyTable other = table;
  set_coefficient(other, name, value);
  try {
    const FoundChute found = find(other);
    if (!flows(found.steady.answer.outcome)) return std::nullopt;
    return Numbers{found.chute.inclination,
                   found.chute.mass_per_area,
                   found.steady.profile.height,
                   found.mass_flow,
                   found.steady.profile.surface_velocity};
  } catch (const NoSuchFlow&) {
    return std::nullopt;
  } catch (const TableError&) {
    return std::nullopt;
  }
}

/// Derivative by one coefficient, times its standard error: central, or one-sided at an edge.
std::optional<Numbers> derivative(const RheologyTable& table,
                                  const std::function<FoundChute(const RheologyTable&)>& find,
                                  const std::string& name,
                                  double error) {
  if (error == 0.0) return Numbers{};
  const double value = coefficient(table, name);
  const double step = step_in_errors * error;
  auto high = moved(table, find, name, value + step);
  auto low = moved(table, find, name, value - step);
  const double steps = (high && low ? 2.0 : 1.0) * step_in_errors;
  if (!high) high = moved(table, find, name, value);
  if (!low) low = moved(table, find, name, value);
  if (!high || !low) return std::nullopt;
  Numbers result{};
  for (std::size_t k = 0; k < result.size(); ++k) result[k] = ((*high)[k] - (*low)[k]) / steps;
  return result;
}

}  // namespace

std::optional<ChuteErrors> search_errors(
    const RheologyTable& table, const std::function<FoundChute(const RheologyTable&)>& find) {
  if (!table.covariance) return std::nullopt;
  const Covariance& covariance = *table.covariance;
  const std::size_t n = covariance.names.size();
  std::vector<Numbers> change;
  for (std::size_t i = 0; i < n; ++i) {
    const auto by = derivative(table, find, covariance.names[i], std::sqrt(covariance(i, i)));
    if (!by) return std::nullopt;
    change.push_back(*by);
  }
  Numbers variance{};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
      if (scale == 0.0) continue;
      for (std::size_t k = 0; k < variance.size(); ++k)
        variance[k] += change[i][k] * covariance(i, j) / scale * change[j][k];
    }
  for (double& v : variance) v = std::sqrt(std::max(0.0, v));
  return ChuteErrors{variance[0], variance[1], variance[2], variance[3], variance[4]};
}

}  // namespace grainlaw::continuum
