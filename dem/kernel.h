#pragma once

#include <string_view>
#include <vector>

namespace grainlaw::dem {

enum class KernelShape {
  lucy,      ///< 5/(4c) (1 + 3 s)(1 - s)^3, s = |x|/c, c = 2 w  (Lucy 1977)
  gaussian,  ///< standard deviation w, cut at 3 w and normalised again
};
std::string_view name(KernelShape shape);

/// What fields are smoothed with along the axis of a profile; its integral is 1. Length scale and
/// reach as in Weinhart et al., Granular Matter 14 (2012) 289. Standard deviation: sqrt(8/21) w =
/// 0.617 w of Lucy's, 0.987 w of the Gaussian.
struct Kernel {
  KernelShape shape = KernelShape::lucy;
  double width = 0.0;  ///< w [length]; 0: none, fields are averages over bins

  double reach() const;             ///< no weight beyond [length]
  double variance() const;          ///< [length^2]
  double integral(double x) const;  ///< from far below to x
};

/// Shares of the 2 n + 1 bins around it that a source in the middle bin gets, kernels integrated
/// over bins; they sum to 1. A source may be anywhere in its bin, which alone spreads it by the
/// variance h^2 / 12: that is taken off the variance of the kernel. A variation of wave length 4 w
/// then comes out 1e-3 of its amplitude off at h = w / 2 and 2.4e-4 at h = w / 4 (Lucy), of second
/// order in h.
std::vector<double> bin_shares(const Kernel& kernel, double bin_width);

}  // namespace grainlaw::dem
