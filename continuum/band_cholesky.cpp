#include "continuum/band_cholesky.h"

#include <algorithm>

namespace grainlaw::continuum {

BandCholesky::BandCholesky(std::size_t size, std::size_t bandwidth)
    : size_(size), bandwidth_(bandwidth), values_(size * (bandwidth + 1), 0.0) {}

void BandCholesky::clear() {
  std::ranges::fill(values_, 0.0);
}

bool BandCholesky::factorise() {
  const std::size_t stride = bandwidth_ + 1;
  for (std::size_t j = 0; j < size_; ++j) {
    double* const column = &values_[j * stride];
    if (!(column[0] > 0.0)) return false;
    const std::size_t below = std::min(bandwidth_, size_ - 1 - j);
    for (std::size_t i = 1; i <= below; ++i) {
      const double factor = column[i] / column[0];
      double* const other = &values_[(j + i) * stride];
      for (std::size_t k = i; k <= below; ++k) other[k - i] -= factor * column[k];
    }
    for (std::size_t i = 1; i <= below; ++i) column[i] /= column[0];
  }
  return true;
}

void BandCholesky::solve(std::span<double> x) const {
  const std::size_t stride = bandwidth_ + 1;
  for (std::size_t j = 0; j < size_; ++j) {
    const std::size_t below = std::min(bandwidth_, size_ - 1 - j);
    for (std::size_t i = 1; i <= below; ++i) x[j + i] -= values_[j * stride + i] * x[j];
  }
  for (std::size_t j = size_; j-- > 0;) {
    x[j] /= values_[j * stride];
    const std::size_t below = std::min(bandwidth_, size_ - 1 - j);
    for (std::size_t i = 1; i <= below; ++i) x[j] -= values_[j * stride + i] * x[j + i];
  }
}

}  // namespace grainlaw::continuum
