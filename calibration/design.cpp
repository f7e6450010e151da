#include "calibration/design.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace grainlaw::calibration {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

Vector vector(const std::vector<double>& values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Matrix square(const std::vector<double>& values, Eigen::Index size) {
  return Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(
      values.data(), size, size);
}

/// F^-1 in the scale of its diagonal, and whether there is one: coefficients differ by decades.
struct Inverse {
  Matrix matrix;
  bool exists = false;
};

Inverse inverse(const Matrix& information) {
  const Vector scale = information.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0.0)) return {};
  const Vector unit = scale.cwiseInverse();
  const Matrix scaled = unit.asDiagonal() * information * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix> spectrum(scaled);
  if (spectrum.eigenvalues().minCoeff() < 1e-12) return {};
  const Matrix inverted = spectrum.eigenvectors() *
                          spectrum.eigenvalues().cwiseInverse().asDiagonal() *
                          spectrum.eigenvectors().transpose();
  return {unit.asDiagonal() * inverted * unit.asDiagonal(), true};
}

double mean_variance(const std::vector<Vector>& targets, const Inverse& covariance) {
  if (!covariance.exists) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const Vector& g : targets) sum += g.dot(covariance.matrix * g);
  return sum / static_cast<double>(targets.size());
}

std::vector<Vector> vectors(std::span<const std::vector<double>> lists, std::size_t size) {
  std::vector<Vector> result;
  for (const std::vector<double>& list : lists) {
    if (list.size() != size) throw std::invalid_argument("gradients of different length");
    result.push_back(vector(list));
  }
  if (result.empty()) throw std::invalid_argument("a design needs candidates and targets");
  return result;
}

Matrix spent(const Matrix& known,
             const std::vector<Vector>& candidates,
             const std::vector<double>& share,
             double seconds) {
  Matrix information = known;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    information += seconds * share[k] * candidates[k] * candidates[k].transpose();
  }
  return information;
}

}  // namespace

double mean_variance(std::span<const std::vector<double>> targets,
                     const std::vector<double>& information) {
  const std::size_t size = targets.empty() ? 0 : targets.front().size();
  if (information.size() != size * size) throw std::invalid_argument("information of another size");
  return mean_variance(vectors(targets, size),
                       inverse(square(information, static_cast<Eigen::Index>(size))));
}

Design v_optimal(std::span<const Information> candidates,
                 std::span<const std::vector<double>> targets,
                 const std::vector<double>& known,
                 double seconds) {
  const std::size_t size = candidates.empty() ? 0 : candidates.front().size();
  const std::vector<Vector> f = vectors(candidates, size);
  const std::vector<Vector> g = vectors(targets, size);
  if (known.size() != size * size) throw std::invalid_argument("information of another size");
  const Matrix before = square(known, static_cast<Eigen::Index>(size));
  Design design{.share = std::vector<double>(f.size(), 1.0 / static_cast<double>(f.size()))};
  constexpr int most_updates = 2000;
  for (int update = 0; update < most_updates; ++update) {
    const Inverse covariance = inverse(spent(before, f, design.share, seconds));
    design.variance = mean_variance(g, covariance);
    if (!covariance.exists) break;
    // How much a second at each candidate would still take off the variance; at the optimum equal
    // for all that have a share. The root makes every update an improvement.
    std::vector<double> gain(f.size());
    double mean = 0.0;
    for (std::size_t k = 0; k < f.size(); ++k) {
      const Vector reached = covariance.matrix * f[k];
      for (const Vector& target : g) gain[k] += std::pow(target.dot(reached), 2);
      mean += design.share[k] * std::sqrt(gain[k]);
    }
    double change = 0.0;
    for (std::size_t k = 0; k < f.size(); ++k) {
      const double next = design.share[k] * std::sqrt(gain[k]) / mean;
      change = std::max(change, std::abs(next - design.share[k]));
      design.share[k] = next;
    }
    if (change < 1e-6) break;
  }
  return design;
}

}  // namespace grainlaw::calibration
