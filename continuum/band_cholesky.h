#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace grainlaw::continuum {

/// A symmetric positive matrix that is 0 farther than `bandwidth` from its diagonal, factorised as
/// L D L^T in its place. (Eigen's is no choice here: the packaged Ceres brings functions of Eigen
/// of its own, compiled for another alignment, and the linker takes one of the two.)
class BandCholesky {
 public:
  BandCholesky(std::size_t size, std::size_t bandwidth);

  std::size_t size() const { return size_; }
  void clear();
  /// Of the lower half: column <= row <= column + bandwidth.
  double& operator()(std::size_t row, std::size_t column) {
    return values_[column * (bandwidth_ + 1) + row - column];
  }

  /// False where the matrix is not positive.
  bool factorise();
  /// Of the factorised matrix, in place.
  void solve(std::span<double> x) const;

 private:
  std::size_t size_;
  std::size_t bandwidth_;
  std::vector<double> values_;  ///< column by column, from the diagonal down
};

}  // namespace grainlaw::continuum
