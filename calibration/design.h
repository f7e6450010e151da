#pragma once

#include <span>
#include <vector>

namespace grainlaw::calibration {

/// What one second of DEM at some setting tells about the coefficients: the gradient of its datum
/// over the standard error that one second leaves, one entry per coefficient.
using Information = std::vector<double>;

/// How a time should be spent.
struct Design {
  std::vector<double> share;  ///< of the time, per candidate; sums to 1
  double variance = 0.0;      ///< mean variance of the targets afterwards
};

/// Distributes `seconds` over the candidates so that the mean variance of the targets becomes
/// smallest (V-optimal): tr(G F^-1 G^T) with F = known + seconds * sum share_k f_k f_k^T.
/// `targets` are the gradients of what will be predicted, `known` is the information there is
/// already (row-major, coefficients^2; zeros: none). Multiplicative updates (Titterington 1976;
/// Yu, Ann. Stat. 38 (2010) 1593). Candidates that cannot reduce the variance get no share. Throws
/// std::invalid_argument for lists that do not fit together or no candidate; the variance is
/// infinite where the candidates leave a target unknown.
Design v_optimal(std::span<const Information> candidates,
                 std::span<const std::vector<double>> targets,
                 const std::vector<double>& known,
                 double seconds);

/// Mean variance of the targets with this information.
double mean_variance(std::span<const std::vector<double>> targets,
                     const std::vector<double>& information);

}  // namespace grainlaw::calibration
