#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

/// mu0, beta and kappa correlated as fits of mu(I) are, errors of 0.1 to 1 %.
RheologyTable with_errors() {
  auto table = table_of(frictional_spheres());
  table.base = EffectiveBase{.no_slip_height = 1.1, .mass_below = 0.6, .recipe = {}};
  const std::vector<std::string> names{
      "mu0", "beta", "kappa", "phi0", "mass_below", "no_slip_height"};
  const std::vector<double> error{3e-4, 4e-3, 1.5e-2, 1e-3, 0.05, 0.1};
  Covariance covariance{names, std::vector<double>(36, 0.0)};
  for (std::size_t i = 0; i < 6; ++i) covariance.matrix[i * 7] = error[i] * error[i];
  const auto correlate = [&](std::size_t i, std::size_t j, double r) {
    covariance.matrix[i * 6 + j] = covariance.matrix[j * 6 + i] = r * error[i] * error[j];
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

/// Row of a profile at the height z; linear between rows.
ProfileRow row_at_height(const Profile& profile, double z) {
  std::size_t i = 1;
  while (i + 1 < profile.rows.size() && profile.rows[i].z < z) ++i;
  const ProfileRow& a = profile.rows[i - 1];
  const ProfileRow& b = profile.rows[i];
  const double share = (z - a.z) / (b.z - a.z);
  return {.velocity = a.velocity + share * (b.velocity - a.velocity),
          .volume_fraction = a.volume_fraction + share * (b.volume_fraction - a.volume_fraction)};
}

/// Standard deviation of numbers that arrive one by one.
struct Deviation {
  double count = 0.0, sum = 0.0, square = 0.0;
  void add(double x) {
    ++count;
    sum += x;
    square += x * x;
  }
  double value() const { return std::sqrt((square - sum * sum / count) / (count - 1.0)); }
};

/// The table with its coefficients drawn from their covariance = l l^T.
RheologyTable drawn(const RheologyTable& table, const std::vector<double>& l, std::mt19937_64& at) {
  const auto& names = table.covariance->names;
  std::normal_distribution<double> normal;
  std::vector<double> unit(names.size());
  for (double& x : unit) x = normal(at);
  RheologyTable result = table;
  for (std::size_t i = 0; i < names.size(); ++i) {
    double change = 0.0;
    for (std::size_t j = 0; j <= i; ++j) change += l[i * names.size() + j] * unit[j];
    set_coefficient(result, names[i], coefficient(table, names[i]) + change);
  }
  return result;
}

TEST(ErrorBand, AgreesAtFixedHeightWithAMonteCarloDrawOfTheCoefficients) {
  const auto table = with_errors();
  const auto l = cholesky(*table.covariance);
  const auto inclined = chute(24, 52.2);
  auto steady = steady_chute(table, inclined, {.rows = 11});
  add_error_band(steady, table, inclined);
  const std::vector<std::size_t> rows{1, 5, 9};
  std::vector<Deviation> velocity(rows.size()), volume_fraction(rows.size());
  std::mt19937_64 random(7);
  const int draws = 4000;
  for (int draw = 0; draw < draws; ++draw) {
    const auto profile = steady_chute(drawn(table, l, random), inclined).profile;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto row = row_at_height(profile, steady.profile.rows[rows[i]].z);
      velocity[i].add(row.velocity);
      volume_fraction[i].add(row.volume_fraction);
    }
  }
  // four standard errors of a standard deviation, 1 / sqrt(2 n), and 1 % for the curvature of u,
  // which changes by 2 % per standard error
  const double tolerance = 4.0 / std::sqrt(2.0 * draws) + 0.01;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = steady.profile.rows[rows[i]];
    EXPECT_NEAR(row.velocity_error / velocity[i].value(), 1.0, tolerance) << i;
    EXPECT_NEAR(row.volume_fraction_error / volume_fraction[i].value(), 1.0, tolerance) << i;
  }
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
  auto table = table_of(incompressible_spheres());
  table.base = EffectiveBase{.no_slip_height = 1.1, .mass_below = 0.6, .recipe = {}};
  table.covariance = Covariance{{"no_slip_height", "mass_below"}, {0.01, 0.0, 0.0, 0.0025}};
  auto steady = steady_chute(table, chute(24, 52.2), {.rows = 11});
  add_error_band(steady, table, chute(24, 52.2));
  // u = A (H^1.5 - (H + z0 - z)^1.5) with H = M1 / phi: the base height z0 moves by 0.1, H by
  // 0.05 / phi
  const double H = 51.6 / 0.58;
  const double A = steady.profile.surface_velocity / std::pow(H, 1.5);
  for (const auto& row : steady.profile.rows) {
    const double depth = std::max(0.0, H + 1.1 - row.z);
    const double by_height = 1.5 * A * std::sqrt(depth) * 0.1;
    const double by_mass = 1.5 * A * (std::sqrt(H) - std::sqrt(depth)) * 0.05 / 0.58;
    // central difference: (step / H)^2
    EXPECT_NEAR(row.velocity_error, std::hypot(by_height, by_mass), 1e-6 * A * std::sqrt(H));
  }
}

TEST(ErrorBand, OfTheBaseHeightAloneIsTheSlopeOfTheProfileTimesItsError) {
  // Soft grains whose friction does not depend on softness: I is the same everywhere and phi rises
  // linearly with the mass above, so dphi/dz = -phi dphi/dM.
  const GrainProperties soft{.stiffness = 38197.0};
  MuPhi law = frictional_spheres();
  law.softness_friction.reset();
  auto table = table_of(law);
  table.base = EffectiveBase{.no_slip_height = 1.1, .mass_below = 0.6, .recipe = {}};
  table.covariance = Covariance{{"no_slip_height"}, {0.01}};
  auto steady = steady_chute(table, chute(24, 52.2, soft));
  add_error_band(steady, table, chute(24, 52.2, soft));
  const auto& rows = steady.profile.rows;
  const double rise = (rows.front().volume_fraction - rows.back().volume_fraction) / 51.6;
  for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
    const auto& row = rows[i];
    // rounding over a step of 1e-3; phi changes by 4e-5 between rows, the slope by its square
    EXPECT_NEAR(row.velocity_error, 0.1 * row.shear_rate, 1e-9);
    EXPECT_NEAR(row.volume_fraction_error / (0.1 * row.volume_fraction * rise), 1.0, 1e-8);
  }
}

}  // namespace
}  // namespace grainlaw::continuum
