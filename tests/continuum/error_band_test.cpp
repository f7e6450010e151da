#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

/// mu0, beta and kappa correlated as fits of mu(I) are, errors of 0.1 to 1 %.
RheologyTable with_errors() {
  auto table = table_of(frictional_spheres());
  table.base = EffectiveBase{.no_slip_height = 1.1, .mass_below = 0.6, .recipe = {}};
  const std::vector<std::string> names{"mu0", "beta", "kappa", "phi0", "mass_below"};
  const std::vector<double> error{3e-4, 4e-3, 1.5e-2, 1e-3, 0.05};
  Covariance covariance{names, std::vector<double>(25, 0.0)};
  for (std::size_t i = 0; i < 5; ++i) covariance.matrix[i * 6] = error[i] * error[i];
  const auto correlate = [&](std::size_t i, std::size_t j, double r) {
    covariance.matrix[i * 5 + j] = covariance.matrix[j * 5 + i] = r * error[i] * error[j];
  };
  correlate(0, 1, -0.8);
  correlate(1, 2, 0.9);
  correlate(0, 2, -0.6);
  table.covariance = covariance;
  return table;
}

/// Lower triangle L with L L^T = covariance.
std::vector<double> cholesky(const Covariance& covariance) {
  const std::size_t n = covariance.names.size();
  std::vector<double> l(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = covariance(i, j);
      for (std::size_t k = 0; k < j; ++k) sum -= l[i * n + k] * l[j * n + k];
      l[i * n + j] = i == j ? std::sqrt(sum) : sum / l[j * n + j];
    }
  return l;
}

TEST(ErrorBand, AgreesWithAMonteCarloDrawOfTheCoefficients) {
  const auto table = with_errors();
  const auto l = cholesky(*table.covariance);
  const auto& names = table.covariance->names;
  const auto inclined = chute(24, 52.2);
  auto steady = steady_chute(table, inclined, {.rows = 11});
  add_error_band(steady, table, inclined);

  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const int draws = 4000;
  double sum = 0, square = 0, phi_sum = 0, phi_square = 0;
  for (int draw = 0; draw < draws; ++draw) {
    auto drawn = table;
    std::vector<double> unit(names.size());
    for (double& x : unit) x = normal(random);
    for (std::size_t i = 0; i < names.size(); ++i) {
      double change = 0.0;
      for (std::size_t j = 0; j <= i; ++j) change += l[i * names.size() + j] * unit[j];
      set_coefficient(drawn, names[i], coefficient(table, names[i]) + change);
    }
    const auto row = steady_chute(drawn, inclined, {.rows = 11}).profile.rows.back();
    sum += row.velocity;
    square += row.velocity * row.velocity;
    phi_sum += row.volume_fraction;
    phi_square += row.volume_fraction * row.volume_fraction;
  }
  const auto deviation = [&](double s, double s2) {
    return std::sqrt((s2 - s * s / draws) / (draws - 1));
  };
  // four standard errors of a standard deviation, 1 / sqrt(2 n), and 1 % for the curvature of u,
  // which changes by 2 % per standard error
  const double tolerance = 4.0 / std::sqrt(2.0 * draws) + 0.01;
  const auto& surface = steady.profile.rows.back();
  EXPECT_NEAR(surface.velocity_error / deviation(sum, square), 1.0, tolerance);
  EXPECT_NEAR(surface.volume_fraction_error / deviation(phi_sum, phi_square), 1.0, tolerance);
}

TEST(ErrorBand, OfOneCoefficientIsItsErrorTimesTheExactDerivative) {
  // u ~ I ~ (tan - mu0) / beta for the linear law: d ln u / d ln beta = -1
  MuPhi law = incompressible_spheres();
  law.friction.kappa = 0.0;
  auto table = table_of(law);
  const double relative = 0.02;
  const double error = relative * law.friction.beta;
  table.covariance = Covariance{{"beta"}, {error * error}};
  auto steady = steady_chute(table, chute(24, 29));
  add_error_band(steady, table, chute(24, 29));
  for (const auto& row : steady.profile.rows)  // central difference: (0.02 / 100)^2
    EXPECT_NEAR(row.velocity_error, relative * row.velocity, 1e-7 * row.velocity + 1e-12);
}

TEST(ErrorBand, OfBagnoldCoefficientsFollowsThePowerOfA) {
  auto table = table_of(bagnold_at_24_degrees(1.3, 0.0, 0.0));  // u ~ 1 / sqrt(a)
  table.covariance = Covariance{{"a", "b"}, {0.13 * 0.13, 0.0, 0.0, 0.0}};
  auto steady = steady_chute(table, chute(24, 29));
  add_error_band(steady, table, chute(24, 29));
  const auto& surface = steady.profile.rows.back();
  EXPECT_NEAR(surface.velocity_error, 0.05 * surface.velocity, 1e-6 * surface.velocity);
}

TEST(ErrorBand, IsOneSidedForACoefficientAtItsBound) {
  auto table = table_of(bagnold_at_24_degrees(1.3, 0.0, 0.0));
  table.covariance = Covariance{{"b"}, {1e-4}};
  auto steady = steady_chute(table, chute(24, 29));
  add_error_band(steady, table, chute(24, 29));
  // gd = sqrt(tau/a) - b/(2a) + O(b^2): b = 0.01 slows the surface by b H / (2a)
  const double expected = 0.01 * 50.0 / (2.0 * 1.3);
  EXPECT_NEAR(steady.profile.rows.back().velocity_error, expected, 1e-4 * expected);
}

TEST(ErrorBand, IsAbsentWithoutACovariance) {
  const auto table = table_of(frictional_spheres());
  auto steady = steady_chute(table, chute(24, 52.2));
  add_error_band(steady, table, chute(24, 52.2));
  for (const auto& row : steady.profile.rows) EXPECT_EQ(row.velocity_error, 0.0);
}

TEST(ErrorBand, ReachesAcrossTheEffectiveBase) {
  auto table = with_errors();
  table.covariance = Covariance{{"no_slip_height", "mass_below"}, {0.01, 0.0, 0.0, 0.0025}};
  auto steady = steady_chute(table, chute(24, 52.2));
  add_error_band(steady, table, chute(24, 52.2));
  const auto& surface = steady.profile.rows.back();
  // u_s ~ M1^1.5: 1.5 * 0.05 / 51.6; a shift in z moves the rows, not the velocity of a mass
  EXPECT_NEAR(
      surface.velocity_error, 1.5 * 0.05 / 51.6 * surface.velocity, 1e-6 * surface.velocity);
}

}  // namespace
}  // namespace grainlaw::continuum
