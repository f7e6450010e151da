#include "continuum/yielding_layer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/continuum/exact_yield.h"
#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

DiscreteLayer discrete(const RheologyTable& table, const ChuteCase& chute, int cells) {
  const Layer layer = make_layer(table, chute);
  return {layer, MassGrid(layer.mass, cells, 1.5)};
}

/// The band Jacobian against central differences at a state given as stress over yield stress.
void expect_jacobian_of_differences(const YieldingLayer& system, std::span<const double> loads) {
  const DiscreteLayer& layer = system.discrete();
  Motion motion;
  for (std::size_t k = 0; k < layer.cells(); ++k) {
    motion.stress.push_back(loads[k] * layer.curve(k).yield_stress);
    motion.velocity.push_back(10.0 - static_cast<double>(k * k) / 10.0);
  }
  const std::vector<double> y = system.state(motion);
  const std::size_t n = y.size();
  std::vector<double> storage(5 * n, 0.0);
  std::vector<double*> columns;
  for (std::size_t j = 0; j < n; ++j) columns.push_back(storage.data() + 5 * j);
  const BandView matrix(columns.data(), 2);
  system.jacobian(0.0, y, matrix);
  std::vector<double> high(n), low(n);
  for (std::size_t j = 0; j < n; ++j) {
    const double h = 1e-5 * std::abs(y[j]);
    auto moved = y;
    moved[j] = y[j] + h;
    system.rate(0.0, moved, high);
    moved[j] = y[j] - h;
    system.rate(0.0, moved, low);
    for (std::size_t i = 0; i < n; ++i) {
      const bool in_band = i + 2 >= j && j + 2 >= i;
      const double analytic = in_band ? matrix(i, j) : 0.0;
      // truncation h^2 = 1e-10 of the curvature; rounding of stress rates damping^-1 times larger
      const double rounding = 1e-15 * (std::abs(high[i]) + 1e5) / h;
      EXPECT_NEAR(analytic, (high[i] - low[i]) / (2.0 * h), 1e-8 * std::abs(analytic) + rounding)
          << "row " << i << " column " << j;
    }
  }
}

TEST(YieldingLayer, AnalyticJacobianMatchesFiniteDifferencesInPlugAndFlow) {
  const std::array<double, 9> loads{.2, -.6, .9, -1.2, 1.1, .8, 1.3, 1.2, 1.25};
  const auto cohesive = chute(24, 52.2, {.stiffness = 3.8e3, .adhesion = 0.4});
  expect_jacobian_of_differences(
      YieldingLayer(discrete(table_of(frictional_spheres()), cohesive, 9), 0.1), loads);
  const auto bagnold = table_of(bagnold_at_24_degrees(1.3, 0.8, 6.0));
  expect_jacobian_of_differences(YieldingLayer(discrete(bagnold, chute(24, 29), 9), 0.1), loads);
}

TEST(YieldingLayer, SaysWhereAStressIsTooLargeForTheLaw) {
  const YieldingLayer system(discrete(table_of(frictional_spheres()), chute(24, 52.2), 4), 0.1);
  Motion motion = system.discrete().rest();
  motion.stress[2] *= 3.0;  // mu_inf is twice mu0
  std::vector<double> rate(8);
  try {
    system.rate(0.0, system.state(motion), rate);
    FAIL() << "carried a stress beyond the largest friction";
  } catch (const StateError& error) {
    EXPECT_NE(std::string(error.what()).find("cell 3 of 4"), std::string::npos) << error.what();
  }
}

TEST(RestStress, OfAProportionalYieldStressIsTheYieldStress) {
  const auto layer = discrete(table_of(frictional_spheres()), chute(24, 52.2), 20);
  const Motion rest = layer.rest();
  for (std::size_t k = 0; k < 20; ++k)
    EXPECT_NEAR(rest.stress[k], layer.curve(k).yield_stress, 1e-14 * 52.2);
}

TEST(RestStress, OfAConstantYieldStressMovesTheLayerAsOneBlock) {
  const auto table = table_of(bagnold_at_24_degrees(1.3, 0.8, 6.0));
  const auto layer = discrete(table, chute(24, 29), 20);
  const Motion rest = layer.rest();
  for (std::size_t k = 0; k < 20; ++k)
    EXPECT_NEAR(rest.stress[k], 6.0 * layer.grid().face[k] / 29.0, 1e-13);
}

TEST(RestStress, NeverExceedsTheYieldStressNorWhatTheDriveCanCarry) {
  for (const double f_a : {1e-3, 1.0, 20.0}) {
    const auto cohesive = chute(24, 52.2, {.stiffness = 3.8e3, .adhesion = f_a});
    const auto layer = discrete(table_of(frictional_spheres()), cohesive, 50);
    const Motion rest = layer.rest();
    double above = 0.0, mass = 0.0, slope = 0.0;
    for (std::size_t k = 0; k < 50; ++k) {
      EXPECT_LE(rest.stress[k], layer.curve(k).yield_stress * (1.0 + 1e-14));
      const double here = (rest.stress[k] - above) / (layer.grid().face[k] - mass);
      EXPECT_LE(here, layer.layer().sine + 1e-12);
      EXPECT_GE(here, slope - 1e-11);  // convex: no part overtakes the one above it
      above = rest.stress[k];
      mass = layer.grid().face[k];
      slope = here;
    }
  }
}

const RheologyTable cohesive_bagnold = table_of(bagnold_at_24_degrees(1.3, 0.8, 6.0));

TEST(ElastoViscoplasticFlow, HasTheSteadyStateOfTheQuadratureWhateverItsElasticity) {
  double first = 0.0;
  for (const double elastic_time : {0.01, 0.1, 1.0}) {
    const auto run = start_from_rest(
        cohesive_bagnold, chute(24, 29), {.cells = 100, .elastic_time = elastic_time});
    ASSERT_EQ(run.answer.outcome, Outcome::plug) << run.answer.text;
    const double velocity = run.final_profile.surface_velocity;
    // the plug edge lies within a cell of 1/100 of the mass, whose shear starts with its square
    EXPECT_NEAR(velocity, 28.020844029, 28.02 * 3e-4);
    if (first == 0.0) first = velocity;
    EXPECT_NEAR(velocity, first, 1e-6 * 28.02 * 10.0);  // tolerance of some ten steps at the end
  }
}

TEST(ElastoViscoplasticFlow, MovesItsPlugAsARigidBlock) {
  const auto run = start_from_rest(cohesive_bagnold, chute(24, 29));
  for (const auto& row : run.final_profile.rows) {
    if (row.mass_above > 0.49 * 29.0) continue;  // the edge is at 0.509
    EXPECT_EQ(row.shear_rate, 0.0);
    EXPECT_NEAR(row.velocity, run.final_profile.surface_velocity, 1e-10 * 28.0);
  }
}

TEST(ElastoViscoplasticFlow, CarriesABagnoldLawWithoutLinearTerm) {
  const auto table = table_of(bagnold_at_24_degrees(1.3, 0.0, 6.0));
  const auto run = start_from_rest(table, chute(24, 29), {.cells = 50});
  ASSERT_EQ(run.answer.outcome, Outcome::plug) << run.answer.text;
  // below the edge at 0.51 of the mass the shear rate starts with a square root, over which a cell
  // of 0.024 errs by at most 0.3 (0.024 / 0.49)^1.5 of the whole
  EXPECT_NEAR(run.final_profile.surface_velocity,
              *run.quadrature_surface_velocity,
              3.3e-3 * *run.quadrature_surface_velocity);
}

TEST(ElastoViscoplasticFlow, FollowsTheRigidViscoplasticOne) {
  // Implicit Euler on the same grid: halving its step halves the distance, what is left is ours.
  const std::vector<double> times{20.0, 100.0};
  const auto run = start_from_rest(
      cohesive_bagnold, chute(24, 29), {.cells = 50, .elastic_time = 0.01, .output_times = times});
  const auto layer = discrete(cohesive_bagnold, chute(24, 29), 50);
  for (std::size_t i = 0; i < times.size(); ++i) {
    std::array<double, 2> surface{};
    for (const int halving : {0, 1}) {
      ExactYield exact(layer, layer.rest());
      const int steps = 200 << halving;
      for (int n = 0; n < steps; ++n) exact.step(times[i] / steps);
      surface[static_cast<std::size_t>(halving)] = exact.velocity().front();
    }
    const double extrapolated = 2.0 * surface[1] - surface[0];
    // what is left of second order, and a lag of the elastic time at an acceleration below the
    // drive
    const double tolerance =
        std::abs(surface[1] - surface[0]) / 10.0 + 0.01 * std::sin(24 * degree);
    EXPECT_NEAR(run.snapshots[i].profile.rows[50].velocity, extrapolated, tolerance);
  }
}

}  // namespace
}  // namespace grainlaw::continuum
