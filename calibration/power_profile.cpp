#include "calibration/power_profile.h"

#include <cmath>
#include <limits>

namespace grainlaw::calibration {

PowerProfile fit_power_profile(const std::vector<double>& mass_above,
                               const std::vector<double>& velocity,
                               const std::vector<double>& error) {
  double weights = 0.0, mean_x = 0.0, mean_u = 0.0;
  for (std::size_t k = 0; k < velocity.size(); ++k) {
    const double weight = 1.0 / (error[k] * error[k]);
    weights += weight;
    mean_x += weight * std::pow(mass_above[k], 1.5);
    mean_u += weight * velocity[k];
  }
  mean_x /= weights;
  mean_u /= weights;
  double sxx = 0.0, sxu = 0.0;
  for (std::size_t k = 0; k < velocity.size(); ++k) {
    const double weight = 1.0 / (error[k] * error[k]);
    const double x = std::pow(mass_above[k], 1.5) - mean_x;
    sxx += weight * x * x;
    sxu += weight * x * (velocity[k] - mean_u);
  }
  PowerProfile fit;
  fit.slope = -sxu / sxx;
  const double reach = mean_u / fit.slope;  // M1^1.5 - mean_x, where u = 0
  fit.flowing_mass = fit.slope > 0.0 ? std::pow(mean_x + reach, 2.0 / 3.0)
                                     : std::numeric_limits<double>::quiet_NaN();
  fit.slope_error = 1.0 / std::sqrt(sxx);
  const double reach_error = std::sqrt(1.0 / weights + reach * reach / sxx) / std::abs(fit.slope);
  fit.flowing_mass_error = reach_error / (1.5 * std::sqrt(fit.flowing_mass));
  return fit;
}

}  // namespace grainlaw::calibration
