#include "dem/kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace grainlaw::dem {
namespace {

constexpr double gaussian_cut = 3.0;  // [w]
constexpr double lucy_cut = 2.0;      // [w]

double lucy_integral(double s) {  // from 0 to s, s in [0, 1]
  return 1.25 * s * (1.0 + s * s * (-2.0 + s * (2.0 - 0.6 * s)));
}

double gaussian_integral(double s) {  // from 0 to s, s in standard deviations
  constexpr double half_root = 0.5 * std::numbers::sqrt2;
  return 0.5 * std::erf(half_root * s) / std::erf(half_root * gaussian_cut);
}

}  // namespace

std::string_view name(KernelShape shape) {
  return shape == KernelShape::lucy ? "lucy" : "gaussian";
}

double Kernel::reach() const {
  return (shape == KernelShape::lucy ? lucy_cut : gaussian_cut) * width;
}

double Kernel::variance() const {
  if (shape == KernelShape::lucy) return 8.0 / 21.0 * width * width;  // 2/21 c^2
  // 1 - 2 s exp(-s^2/2) / (sqrt(2 pi) erf(s/sqrt 2)), of a normal distribution cut at s
  const double s = gaussian_cut;
  const double density = std::exp(-0.5 * s * s) / std::sqrt(2.0 * std::numbers::pi);
  return (1.0 - 2.0 * s * density / std::erf(s / std::numbers::sqrt2)) * width * width;
}

double Kernel::integral(double x) const {
  if (std::abs(x) >= reach()) return x > 0.0 ? 1.0 : 0.0;
  const double s = std::abs(x) / (shape == KernelShape::lucy ? reach() : width);
  const double half = shape == KernelShape::lucy ? lucy_integral(s) : gaussian_integral(s);
  return x > 0.0 ? 0.5 + half : 0.5 - half;
}

std::vector<double> bin_shares(const Kernel& kernel, double bin_width) {
  const double left = 1.0 - bin_width * bin_width / (12.0 * kernel.variance());
  if (!(kernel.width > 0.0) || left <= 0.0) return {1.0};
  const Kernel narrower{kernel.shape, kernel.width * std::sqrt(left)};
  const auto n = static_cast<std::ptrdiff_t>(std::ceil(narrower.reach() / bin_width - 0.5));
  std::vector<double> shares;
  for (std::ptrdiff_t m = -n; m <= n; ++m) {
    const double centre = static_cast<double>(m) * bin_width;
    shares.push_back(narrower.integral(centre + 0.5 * bin_width) -
                     narrower.integral(centre - 0.5 * bin_width));
  }
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);  // 1 but for rounding
  for (double& share : shares) share /= sum;
  return shares;
}

}  // namespace grainlaw::dem
