#include "dem/kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace grainlaw::dem {
namespace {

class Kernels : public testing::TestWithParam<KernelShape> {};

/// Moments of a kernel by differences of its integral over slices, the slice at its middle.
double moment(const Kernel& kernel, int order, int slices) {
  const double width = 2.0 * kernel.reach() / slices;
  double sum = 0.0;
  for (int k = 0; k < slices; ++k) {
    const double x = -kernel.reach() + (k + 0.5) * width;
    sum +=
        std::pow(x, order) * (kernel.integral(x + 0.5 * width) - kernel.integral(x - 0.5 * width));
  }
  return sum;
}

TEST_P(Kernels, HaveUnitIntegralAndTheirVariance) {
  const Kernel kernel{GetParam(), 0.7};
  constexpr int slices = 1000;
  EXPECT_NEAR(moment(kernel, 0, slices), 1.0, 1e-14);
  EXPECT_NEAR(moment(kernel, 1, slices), 0.0, 1e-14);
  // Mass of a slice at its middle: each misses at most the variance of a slice.
  const double slice = 2.0 * kernel.reach() / slices;
  EXPECT_NEAR(moment(kernel, 2, slices), kernel.variance(), slice * slice / 4.0);
}

TEST_P(Kernels, SharesOfBinsSumToOneAtEveryWidth) {
  for (const double width : {0.3, 0.5, 1.0, 2.0, 7.0}) {
    const std::vector<double> shares = bin_shares({GetParam(), width}, 0.25);
    EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0),
                1.0,
                1e-15 * static_cast<double>(shares.size()));
    EXPECT_EQ(shares.size() % 2, 1u);
    for (std::size_t k = 0; k < shares.size(); ++k) {
      EXPECT_GT(shares[k], 0.0);
      EXPECT_NEAR(shares[k], shares[shares.size() - 1 - k], 1e-15);
    }
  }
}

TEST_P(Kernels, WithoutWidthLeaveEveryBinItsOwn) {
  EXPECT_EQ(bin_shares({GetParam(), 0.0}, 0.25), std::vector{1.0});
}

/// Of a density wave cos(2 pi z / length) in bins, smoothed, against the kernel at exact places:
/// both only damp the wave. The bins of the result average it too; that factor is in both.
double wave_error(const Kernel& kernel, double bin, double length) {
  const double wave = 2.0 * M_PI / length;
  const auto averaged = [&](double width) {
    return std::sin(0.5 * wave * width) / (0.5 * wave * width);
  };
  const std::vector<double> shares = bin_shares(kernel, bin);
  const auto reach = static_cast<std::ptrdiff_t>(shares.size() / 2);
  double from_bins = 0.0;
  for (std::ptrdiff_t m = -reach; m <= reach; ++m) {
    from_bins += shares[static_cast<std::size_t>(m + reach)] *
                 std::cos(wave * bin * static_cast<double>(m)) * averaged(bin);
  }
  constexpr int slices = 20000;
  const double slice = 2.0 * kernel.reach() / slices;
  double exact = 0.0;
  for (int k = 0; k < slices; ++k) {
    const double x = -kernel.reach() + (k + 0.5) * slice;
    exact +=
        std::cos(wave * x) * (kernel.integral(x + 0.5 * slice) - kernel.integral(x - 0.5 * slice));
  }
  return std::abs(from_bins - exact * averaged(bin));
}

TEST_P(Kernels, FineBinsAreOfSecondOrderAgainstExactPlaces) {
  // The narrower kernel has the right variance but not the right fourth moment, which misses by a
  // share of (h/w)^2. Left as it is, the kernel would miss by (k h)^2 / 24 = 6e-3 at h = w / 4.
  const Kernel kernel{GetParam(), 1.0};
  const double length = 4.0;  // a variation as fast as the kernel lets through
  const double half = wave_error(kernel, 0.5, length);  // of half the width in the bins of a run
  const double quarter = wave_error(kernel, 0.25, length);
  const double eighth = wave_error(kernel, 0.125, length);
  EXPECT_LT(half, 1e-3);  // of the amplitude
  EXPECT_NEAR(half / quarter, 4.0, 0.5);
  EXPECT_NEAR(quarter / eighth, 4.0, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Shapes,
                         Kernels,
                         testing::Values(KernelShape::lucy, KernelShape::gaussian),
                         [](const auto& shape) { return std::string(name(shape.param)); });

}  // namespace
}  // namespace grainlaw::dem
