#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

const RheologyTable frictional = table_of(frictional_spheres());

TransientChute start(double degrees, const TransientOptions& options = {}) {
  return start_from_rest(frictional, chute(degrees, 52.2), options);
}

TEST(StartFromRest, StaysAtRestBelowRepose) {
  for (const double theta : {0.0, 15.0, 18.0, 19.44}) {
    const auto run = start(theta, {.output_times = {10.0}});
    EXPECT_EQ(run.answer.outcome, Outcome::arrested) << theta;
    EXPECT_EQ(run.end_time, 0.0);
    EXPECT_EQ(run.final_profile.surface_velocity, 0.0);
    EXPECT_NEAR(
        run.final_profile.rows.front().shear_stress, 52.2 * std::sin(theta * degree), 1e-13);
    ASSERT_EQ(run.snapshots.size(), 1u);
  }
}

TEST(StartFromRest, ReachesTheSteadyFlowOfTheQuadratureFromReposeToThePhiLimit) {
  for (const double theta : {19.445, 19.45, 19.5, 24.0, 30.0, 33.0}) {
    const auto run = start(theta);
    EXPECT_EQ(run.answer.outcome, Outcome::steady) << run.answer.text;
    EXPECT_LE(run.residual, 1e-8);
    const double steady = steady_chute(frictional, chute(theta, 52.2)).profile.surface_velocity;
    EXPECT_NEAR(run.final_profile.surface_velocity, steady, 1e-5 * steady);  // grid: 5e-6 at 200
  }
}

TEST(StartFromRest, DoesNotCallAnUnfinishedRunSteady) {
  const auto run = start(33.0, {.time_limit = 1e5});
  EXPECT_EQ(run.answer.outcome, Outcome::not_converged) << run.answer.text;
  EXPECT_GT(run.residual, 1e-4);
}

TEST(StartFromRest, LosesItsDenseStateBetweenThePhiLimitAndTheLargestFriction) {
  for (const double theta : {33.95, 35.0, 35.5})
    EXPECT_EQ(start(theta).answer.outcome, Outcome::no_dense_state) << theta;
  const auto run = start(35.5, {.time_limit = 1e7});  // runs into I_phi (1 - 1e-3)
  EXPECT_EQ(run.answer.outcome, Outcome::no_dense_state);
  EXPECT_LT(run.end_time, 1e7);
  EXPECT_NEAR(run.final_profile.rows.front().inertial_number, 5.383 * (1 - 1e-3), 1e-5);
}

TEST(StartFromRest, AcceleratesAboveTheLargestFrictionTowardsItsLimit) {
  for (const double theta : {36.0, 40.0}) {
    const auto run = start(theta, {.time_limit = 1e5});
    EXPECT_EQ(run.answer.outcome, Outcome::accelerating) << run.answer.text;
    // mu never exceeds mu(I_phi), so at least this much of the drive is left
    const double mu = friction(frictional_spheres(), 5.383);
    const double least = std::cos(theta * degree) * (std::tan(theta * degree) - mu);
    EXPECT_GT(run.residual * std::sin(theta * degree), least);
    EXPECT_LT(run.residual * std::sin(theta * degree), least + 0.02);
  }
}

TEST(StartFromRest, RefusesASoftLayerThatHasNoFrictionLeft) {
  const auto run = start_from_rest(frictional, chute(24, 52.2, {.stiffness = 100.0}));
  EXPECT_EQ(run.answer.outcome, Outcome::no_steady);
  EXPECT_NE(run.answer.text.find("p_mu = 0.3905"), std::string::npos) << run.answer.text;
  EXPECT_TRUE(run.final_profile.rows.empty());  // not a layer at rest
  EXPECT_TRUE(run.snapshots.empty());
  EXPECT_FALSE(run.time_to_steady);
}

TEST(StartFromRest, TimeToSteadyOfAViscousLayerIsThatOfItsSlowestMode) {
  // Mean velocity of a film, mobility b phi in the mass coordinate: 1 - sum 96 / (pi n)^4
  // exp(-(pi n / 2)^2 b phi t / M^2) over odd n; at 1 % only n = 1 is left.
  const double b = 0.8, phi = 0.58, mass = 29.0, pi = std::numbers::pi;
  const double decay_time = 4.0 * mass * mass / (pi * pi * b * phi);
  const auto table = table_of(bagnold_at_24_degrees(0.0, b, 0.0));
  const auto run = start_from_rest(table, chute(24, mass), {.relative_tolerance = 1e-8});
  ASSERT_TRUE(run.time_to_steady);
  // an error of the velocity counts 100 times at 1 %: 1e-8 in every step, and the grid
  const double steps = static_cast<double>(run.statistics.steps);
  const double tolerance = 100.0 * (1e-8 * steps + 0.25 / 200.0 / 200.0);
  const double expected = decay_time * std::log(9600.0 / std::pow(pi, 4));
  EXPECT_NEAR(*run.time_to_steady, expected, tolerance * decay_time);
  // relaxation_time is within 25 % of decay_time
  EXPECT_NEAR(run.settling_time / (decay_time * std::log(1e8)), pi * pi / 8.0, 0.001);
}

TEST(StartFromRest, HasATimeToSteadyOnlyWhenItGotThere) {
  EXPECT_TRUE(start(24).time_to_steady);
  EXPECT_FALSE(start(24, {.time_limit = 100.0}).time_to_steady);
  EXPECT_FALSE(start(40, {.time_limit = 100.0}).time_to_steady);
  EXPECT_FALSE(start(15).time_to_steady);
  EXPECT_EQ(start(40, {.time_limit = 100.0}).settling_time, 0.0);
}

TEST(StartFromRest, ItsInertialNumberOnlyRisesSoThatTheEndShowsTheHighest) {
  for (const GrainProperties& grains : {GrainProperties{}, GrainProperties{.adhesion = 1.0}}) {
    const auto run = start_from_rest(
        frictional, chute(24, 52.2, grains), {.output_times = {1, 10, 100, 300, 1000, 3000}});
    const Profile* earlier = nullptr;
    for (const Snapshot& snapshot : run.snapshots) {
      for (std::size_t i = 0; earlier && i < earlier->rows.size(); ++i) {
        const double before = earlier->rows[i].inertial_number;
        EXPECT_GE(snapshot.profile.rows[i].inertial_number, before - 1e-6 - 1e-4 * before)
            << "row " << i << " at t = " << snapshot.time;  // 1e-6 per step, up to 100 steps
      }
      earlier = &snapshot.profile;
    }
  }
}

TEST(StartFromRest, FlagsTheStateItReachesAndNotThatOfTheSteadyFlow) {
  auto table = frictional;
  table.range.inertial_number = Range{0.005, 0.5};
  const auto run = start_from_rest(table, chute(35.5, 52.2), {.time_limit = 1e4});
  EXPECT_TRUE(steady_chute(table, chute(35.5, 52.2)).answer.out_of_domain.empty());
  ASSERT_EQ(run.answer.out_of_domain.size(), 2u);
  EXPECT_EQ(run.answer.out_of_domain[0].quantity, "I");
  EXPECT_EQ(run.answer.out_of_domain[0].reached_highest,
            run.final_profile.rows.front().inertial_number);
  EXPECT_EQ(run.answer.out_of_domain[1].quantity, "phi");
  EXPECT_EQ(run.answer.out_of_domain[1].reached_lowest,
            run.final_profile.rows.front().volume_fraction);
}

TEST(StartFromRest, StatesTheConditionNumberOfTheFrictionItReached) {
  const auto run = start(24, {.time_limit = 100.0, .stop_when_steady = false});
  const auto& base = run.final_profile.rows.front();
  const double mu = base.shear_stress / base.pressure;
  const double expected = (1.0 + base.inertial_number / 0.7184) * mu / (mu - 0.3530);
  EXPECT_NEAR(run.answer.condition_number, expected, 1e-10 * expected);
  EXPECT_NEAR(start(24).answer.condition_number,
              steady_chute(frictional, chute(24, 52.2)).answer.condition_number,
              1e-5);  // the residual of 1e-8 in the friction, over mu - mu0
}

TEST(StartFromRest, SaysNoTimesWithoutTheirUnit) {
  EXPECT_EQ(start(24).answer.text.find("t = "), std::string::npos);
}

TEST(StartFromRest, BeginsAsABlockOverAShearedBase) {
  const auto run = start(24, {.output_times = {0.0, 1.0}});
  ASSERT_EQ(run.snapshots.size(), 2u);
  EXPECT_EQ(run.snapshots[0].profile.surface_velocity, 0.0);
  // friction mu0 cos(theta) holds back every part that the base has not reached yet
  const double block = std::sin(24 * degree) - 0.3530 * std::cos(24 * degree);
  EXPECT_NEAR(run.snapshots[1].profile.surface_velocity, block, 1e-6 * block);
}

TEST(StartFromRest, MeanVelocityObeysTheMomentumBalanceOfTheWholeLayer) {
  // d(flux)/dt = M1 (g sin(theta)) - tau at the base, both from snapshots a short time apart
  const double t = 40.0, dt = 0.1;
  const auto run = start(24, {.relative_tolerance = 1e-9, .output_times = {t - dt, t, t + dt}});
  const double gain = (run.snapshots[2].profile.flux - run.snapshots[0].profile.flux) / (2 * dt);
  const double balance =
      52.2 * std::sin(24 * degree) - run.snapshots[1].profile.rows.front().shear_stress;
  EXPECT_NEAR(gain, balance, 1e-4 * balance);  // (dt / t)^2 of a smooth start
}

TEST(StartFromRest, SnapshotsDoNotDependOnTheRequestOfOthers) {
  const auto few = start(24, {.output_times = {50.0}});
  const auto many = start(24, {.output_times = {20.0, 30.0, 50.0, 70.0}});
  EXPECT_EQ(few.snapshots[0].profile.surface_velocity, many.snapshots[2].profile.surface_velocity);
}

TEST(StartFromRest, RunsToTheTimeAskedForWhenNotAskedForASteadyFlow) {
  const auto run = start(24, {.time_limit = 30.0, .stop_when_steady = false});
  EXPECT_EQ(run.answer.outcome, Outcome::time_reached);
  EXPECT_EQ(run.end_time, 30.0);
}

TEST(StartFromRest, RegularisedPlugHasAnErrorProportionalToDelta) {
  const auto table = table_of(bagnold_at_24_degrees(1.3, 0.8, 6.0));
  const double exact = 28.020844029;  // Brewster et al. 2008, eq. 9
  const auto error = [&](double delta) {
    const auto run =
        start_from_rest(table, chute(24, 29), {.cells = 400, .yield_regularisation = delta});
    EXPECT_EQ(run.answer.outcome, Outcome::plug) << run.answer.text;
    EXPECT_NEAR(run.final_profile.plug_mass, 25.4337241611 * 0.58, 29.0 * 0.003);  // half a cell
    return run.final_profile.surface_velocity / exact - 1.0;
  };
  // In the plug q = delta x / sqrt(1 - x^2) with x = tau / tau_y, which integrates to delta times
  // the plug depth; the sheared part adds delta^2, the grid 1e-5.
  const double expected = 25.4337241611 / exact;
  EXPECT_NEAR(error(1e-2), expected * 1e-2, 1e-4 + 1e-5);
  EXPECT_NEAR(error(1e-3), expected * 1e-3, 1e-6 + 1e-5);
  EXPECT_NEAR(error(1e-4), expected * 1e-4, 1e-5);
}

TEST(StartFromRest, SoftGrainsReachTheSteadyFlowWithoutAnyRegularisation) {
  const GrainProperties soft{.stiffness = 381971.8634};
  const auto run = start_from_rest(frictional, chute(24, 52.2, soft));
  EXPECT_EQ(run.answer.outcome, Outcome::steady);
  EXPECT_NEAR(run.final_profile.surface_velocity, 113.8802833418, 113.88 * 1e-5);  // grid
  EXPECT_EQ(run.answer.text.find("delta"), std::string::npos) << run.answer.text;
}

TEST(StartFromRest, RefusesOptionsThatWouldMislead) {
  const auto refuses = [&](const TransientOptions& options) {
    EXPECT_THROW(start_from_rest(frictional, chute(24, 52.2, {.adhesion = 1.0}), options),
                 std::invalid_argument);
  };
  refuses({.absolute_tolerance = 1e-5, .yield_regularisation = 1e-4});  // below 100 atol
  refuses({.yield_regularisation = 1e-10});
  refuses({.cells = 1});
  refuses({.relative_tolerance = 0.0});
  refuses({.output_times = {-1.0}});
}

TEST(StartFromRest, WarnsOfAVeryCoarseGridButRuns) {
  for (const int cells : {2, 3}) {
    const auto run = start(24, {.cells = cells});
    EXPECT_EQ(run.answer.outcome, Outcome::steady);
    EXPECT_NE(run.answer.text.find("coarse"), std::string::npos);
  }
}

TEST(StartFromRest, MirrorImageAndOtherUnitsGiveTheSameStart) {
  const double d = 1e-4, rho = 2500.0, g = 9.81, time = std::sqrt(d / g);
  const auto plain = start(24, {.output_times = {60.0}});
  const auto si = start_from_rest(frictional,
                                  {.inclination = -24 * degree,
                                   .gravity = g,
                                   .mass_per_area = 52.2 * rho * d,
                                   .grains = {.diameter = d, .density = rho}},
                                  {.output_times = {60.0 * time}});
  const double velocity = plain.snapshots[0].profile.surface_velocity;
  // rounding of the input may change a step size decision: both runs stay within the tolerance
  EXPECT_NEAR(
      si.snapshots[0].profile.surface_velocity / std::sqrt(g * d), -velocity, 1e-6 * velocity);
  EXPECT_NEAR(si.snapshots[0].time, 60.0 * time, 1e-15);
}

}  // namespace
}  // namespace grainlaw::continuum
