// Bands that start from rest: against the steady quadrature, which knows nothing of time, and
// against the Fourier series of a linear fluid.
#include "continuum/shear_band_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "continuum/band_layer.h"
#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

const RheologyTable frictional = table_of(frictional_spheres());

ShearBandCase loaded_shear(const WallDrive& drive, double gravity = 1.0) {
  return {.flow = PlaneShear{
              .drive = drive, .extent = {.height = 60.0}, .load = 10.0, .gravity = gravity}};
}

ShearBandCase box(double amplitude, const GrainProperties& grains = {}) {
  return {.flow = BodyForceBox{.extent = {.height = 40.0}, .amplitude = amplitude, .pressure = 2.0},
          .grains = grains};
}

/// A shear rate that falls linearly to the edge of a band of mass w changes the velocity by at most
/// (h / w)^2 when the edge lies inside a cell of mass h.
double edge_error(double band_mass, double layer_mass, int cells) {
  const double k = cells * std::pow(band_mass / layer_mass, 2.0 / 3.0);
  const double h = 1.5 * band_mass / k;
  return (h / band_mass) * (h / band_mass);
}

TEST(BandStart, UnderGravityLeadsToTheSteadyBandOfTheQuadrature) {
  for (const auto& drive : {WallDrive{.stress = 4.2}, WallDrive{.velocity = 0.4}}) {
    const auto run = start_band(frictional, loaded_shear(drive));
    ASSERT_EQ(run.answer.outcome, Outcome::steady) << run.answer.text;
    const double band_mass = run.driving_stress / 0.3530 - 10.0;
    const double layer_mass = run.final_profile.rows.front().mass_above;
    EXPECT_LT(std::abs(run.difference), edge_error(band_mass, layer_mass, 200));
    EXPECT_GT(run.time_to_steady.value(), 0.0);
    EXPECT_EQ(run.final_profile.rows.front().velocity, 0.0);
    // phi of the sheared part, a twentieth of the height, is averaged over cells
    EXPECT_NEAR(run.final_profile.height, 60.0, 1e-3 * 60.0);
  }
}

TEST(BandStart, OfUniformShearIsTheLawItself) {
  const auto run = start_band(frictional, loaded_shear({.velocity = 4.0}, 0.0));
  ASSERT_EQ(run.answer.outcome, Outcome::steady) << run.answer.text;
  EXPECT_NEAR(run.difference, 0.0, 1e-6);  // the residual that counts as steady
  for (const ProfileRow& row : run.final_profile.rows)
    EXPECT_NEAR(row.velocity, 4.0 * row.z / run.final_profile.height, 1e-4 * 4.0);
}

TEST(BandStart, OfABodyForceBoxLeadsToItsSteadyBands) {
  for (const GrainProperties& grains :
       {GrainProperties{}, GrainProperties{.stiffness = 1e4, .adhesion = 0.5}}) {
    const auto run = start_band(frictional, box(0.2, grains));
    ASSERT_EQ(run.answer.outcome, Outcome::steady) << run.answer.text;
    // the edge at about a fifth of a quarter with 200 even cells: (1 / 40)^2
    EXPECT_LT(std::abs(run.difference), 1.0 / 1600.0);
  }
}

/// u = U [z/H + sum 2 (-1)^k / (k pi) exp(-k^2 pi^2 nu t / H^2) sin(k pi z/H)] of a fluid of
/// viscosity beta sqrt(p), which mu = beta I is at uniform pressure and constant phi.
TEST(BandStart, OfALinearFluidFollowsTheFourierSeries) {
  const double beta = 0.5, p = 10.0, phi = 0.58, U = 2.0, H = 60.0;
  MuPhi law = incompressible_spheres();
  law.friction = {.mu0 = 0.0, .beta = beta};
  const double nu = beta * std::sqrt(p) / phi;
  const double time = 0.05 * H * H / nu;
  const auto run =
      start_band(table_of(law), loaded_shear({.velocity = U}, 0.0), {.output_times = {time}});
  ASSERT_EQ(run.snapshots.size(), 1u);
  for (const ProfileRow& row : run.snapshots[0].profile.rows) {
    double exact = row.z / H;
    for (int k = 1; k < 50; ++k) {
      const double l = k * std::numbers::pi;
      exact += 2.0 * (k % 2 == 0 ? 1.0 : -1.0) / l * std::exp(-l * l * nu * time / (H * H)) *
               std::sin(l * row.z / H);
    }
    // stresses lag by the elastic time, 5e-4 of momentum / stress = H^2 / 2 nu, while u rises by
    // less than 4 U nu / H^2
    EXPECT_NEAR(row.velocity, U * exact, 1e-3 * U) << row.z;
  }
}

/// All momentum comes from the drive less the stress at y = 0: at early times, before the bands
/// have yielded anywhere else, less than the drive alone gives.
TEST(BandStart, OfABoxGainsNoMoreMomentumThanTheForceGives) {
  const auto run = start_band(frictional, box(0.2), {.output_times = {2.0, 5.0}});
  const double mass = 0.5 * run.final_profile.rows.front().mass_above;  // of half a period
  for (const Snapshot& s : run.snapshots) {
    const double given = 0.2 * (2.0 / std::numbers::pi) * mass * s.time;
    EXPECT_GT(s.profile.flux, 0.0);
    EXPECT_LT(s.profile.flux, given);
  }
}

TEST(BandStart, BelowYieldRestsAndAboveTheLargestFrictionHasNoSteadyFlow) {
  EXPECT_EQ(start_band(frictional, box(0.05)).answer.outcome, Outcome::arrested);
  EXPECT_TRUE(start_band(frictional, box(0.05)).final_profile.rows.empty());
  EXPECT_EQ(start_band(frictional, loaded_shear({.stress = 7.5})).answer.outcome,
            Outcome::no_steady);
}

TEST(BandStart, SaysWhenTheTimeGivenWasTooShort) {
  const auto run = start_band(frictional, box(0.2), {.time_limit = 1.0});
  EXPECT_EQ(run.answer.outcome, Outcome::time_reached);
  EXPECT_EQ(run.end_time, 1.0);
  EXPECT_FALSE(run.time_to_steady);
}

TEST(BandStart, RefusesWhatItDoesNotFollow) {
  EXPECT_THROW(start_band(frictional,
                          {.flow = AnnularShear{.drive = {.velocity = 1.0},
                                                .inner_radius = 20.0,
                                                .outer_radius = 40.0,
                                                .pressure = 1.0}}),
               std::invalid_argument);
  auto nonlocal = box(0.2);
  nonlocal.nonlocal_amplitude = 0.48;
  EXPECT_THROW(start_band(frictional, nonlocal), std::invalid_argument);
}

TEST(BandLayer, AnalyticJacobianMatchesFiniteDifferencesInPlugAndFlow) {
  const auto band = loaded_shear({.velocity = 0.4});
  const BandProblem problem = make_problem(frictional, band, BandUnits(band.grains));
  const BandLayer layer(
      problem, {0.0, 1.0, 3.0, 6.0, 10.0}, {.velocity = 0.4}, {.velocity = 0.0}, 4.0, 0.1);
  std::vector<double> y = {4.2, 0.3, 3.9, 0.1, 4.7, 0.05, 3.0, 0.01, 2.0};
  const std::size_t n = y.size();
  std::vector<double> storage(5 * n, 0.0);
  std::vector<double*> columns;
  for (std::size_t j = 0; j < n; ++j) columns.push_back(storage.data() + 5 * j);
  layer.jacobian(0.0, y, BandView(columns.data(), 2));
  for (std::size_t j = 0; j < n; ++j) {
    const double step = 1e-7;
    std::vector<double> low(n), high(n), moved = y;
    moved[j] = y[j] + step;
    layer.rate(0.0, moved, high);
    moved[j] = y[j] - step;
    layer.rate(0.0, moved, low);
    for (std::size_t i = j < 2 ? 0 : j - 2; i < std::min(n, j + 3); ++i) {
      const double difference = (high[i] - low[i]) / (2.0 * step);
      // rounding of the rate, whose terms are a hundred times larger than it, over the step
      EXPECT_NEAR(
          BandView(columns.data(), 2)(i, j), difference, 1e-6 * (1.0 + std::abs(difference)))
          << i << ' ' << j;
    }
  }
}

}  // namespace
}  // namespace grainlaw::continuum
