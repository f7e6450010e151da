#include "continuum/shear_layer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

ShearLayer shear_layer(const RheologyTable& table,
                       const ChuteCase& chute,
                       int cells,
                       double delta) {
  const Layer layer = make_layer(table, chute);
  return {DiscreteLayer(layer, MassGrid(layer.mass, cells, 1.5)), delta};
}

/// The tridiagonal Jacobian as a full matrix, row-major.
std::vector<double> analytic_jacobian(const ShearLayer& system, const std::vector<double>& q) {
  const std::size_t n = q.size();
  std::vector<double> storage(3 * n, 0.0);
  std::vector<double*> columns;
  for (std::size_t j = 0; j < n; ++j) columns.push_back(storage.data() + 3 * j);
  const TridiagonalView view(columns.data(), 1);
  system.jacobian(0.0, q, view);
  std::vector<double> full(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i == 0 ? 0 : i - 1; j < std::min(n, i + 2); ++j)
      full[i * n + j] = view(i, j);
  return full;
}

void expect_jacobian_of_differences(const ShearLayer& system, const std::vector<double>& q) {
  const std::size_t n = q.size();
  const auto analytic = analytic_jacobian(system, q);
  std::vector<double> high(n), low(n);
  for (std::size_t j = 0; j < n; ++j) {
    const double h = 1e-5 * std::abs(q[j]);
    auto moved = q;
    moved[j] = q[j] + h;
    system.rate(0.0, moved, high);
    moved[j] = q[j] - h;
    system.rate(0.0, moved, low);
    const double scale = std::abs(analytic[j * n + j]);
    // truncation h^2 = 1e-10 of the curvature; rounding 1e-16 / 1e-5 of rates that are at most 1e3
    // times the diagonal entry times q
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(analytic[i * n + j], (high[i] - low[i]) / (2.0 * h), 1e-8 * scale)
          << "row " << i << " column " << j;
  }
}

TEST(ShearLayer, AnalyticJacobianMatchesFiniteDifferencesForMuOfI) {
  const auto system = shear_layer(table_of(frictional_spheres()), chute(24, 52.2), 9, 0.0);
  expect_jacobian_of_differences(system, {.05, .1, .2, .3, .25, .2, .4, .35, .6});
}

TEST(ShearLayer, AnalyticJacobianMatchesFiniteDifferencesWithRegularisedYield) {
  const auto soft = chute(24, 52.2, {.stiffness = 3.8e3, .adhesion = 0.4});
  const auto system = shear_layer(table_of(frictional_spheres()), soft, 9, 0.1);
  expect_jacobian_of_differences(system, {.05, -.1, .2, .3, .25, .2, -.04, .35, .6});
}

TEST(ShearLayer, AnalyticJacobianMatchesFiniteDifferencesForBagnold) {
  const auto system =
      shear_layer(table_of(bagnold_at_24_degrees(1.3, 0.8, 6.0)), chute(24, 29), 9, 0.1);
  expect_jacobian_of_differences(system, {.05, -.1, .2, .3, .25, .2, -.04, .35, .6});
}

TEST(ShearLayer, SteadyStateOfThePointwiseBalanceDoesNotAccelerate) {
  const auto soft = chute(24, 52.2, {.stiffness = 3.8e5});
  const auto system = shear_layer(table_of(frictional_spheres()), soft, 50, 0.0);
  // rounding of a stress of at most 21 divided by the smallest cell, 0.15
  EXPECT_LT(system.largest_acceleration(system.discrete().steady().rate, {}), 21.0 / 0.15 * 1e-15);
}

TEST(ShearLayer, RelaxationTimeOfALinearLawIsTheDiffusionTime) {
  const double b = 50.0, phi = 0.58, height = 50.0;
  const auto system =
      shear_layer(table_of(bagnold_at_24_degrees(0, b, 0)), chute(24, phi * height), 400, 0.0);
  // int M / (K tau') dM = H^2 / (2 nu); the midpoint rule errs by (1.5 / 400)^2
  const double expected = height * height * phi / (2.0 * b);
  EXPECT_NEAR(system.discrete().relaxation_time(system.discrete().steady().rate),
              expected,
              1e-2 * expected);
}

}  // namespace
}  // namespace grainlaw::continuum
