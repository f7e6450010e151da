// What follows a change of tilt: steps, arrest, start, and both by turns.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/continuum/exact_yield.h"
#include "tests/continuum/example_laws.h"
#include "tests/verification/verified.h"

namespace grainlaw::continuum {
namespace {

const RheologyTable frictional = table_of(frictional_spheres());
const RheologyTable cohesive_bagnold = table_of(bagnold_at_24_degrees(1.3, 0.8, 6.0));

TEST(TiltStep, LeadsToTheSteadyFlowOfTheNewTilt) {
  for (const auto& [before, after] : {std::pair{23.0, 26.0}, {26.0, 23.0}}) {
    const auto run =
        transient_chute(frictional, chute(after, 52.2), {.inclination_before = before * degree});
    EXPECT_EQ(run.answer.outcome, Outcome::steady) << run.answer.text;
    const double steady = steady_chute(frictional, chute(after, 52.2)).profile.surface_velocity;
    EXPECT_NEAR(run.quadrature_surface_velocity.value(), steady, 1e-13 * steady);
    EXPECT_NEAR(run.final_profile.surface_velocity, steady, 1e-5 * steady);  // grid: 5e-6 at 200
    EXPECT_TRUE(run.events.empty());                                         // it never rested
    EXPECT_GT(run.time_to_steady.value(), 0.0);
  }
}

TEST(TiltStep, ToTheSameTiltChangesNothing) {
  for (const GrainProperties& grains :
       {GrainProperties{}, GrainProperties{.stiffness = 3.8e5, .adhesion = 5.0}}) {
    const auto run =
        transient_chute(frictional,
                        chute(24, 52.2, grains),
                        {.inclination_before = 24 * degree, .output_times = {0.0, 1.0, 100.0}});
    const double at_first = run.snapshots[0].profile.surface_velocity;
    for (const Snapshot& snapshot : run.snapshots)  // tolerance of the velocity
      EXPECT_NEAR(snapshot.profile.surface_velocity, at_first, 1e-6 * at_first);
  }
}

TEST(TiltStep, CarriesAPlugFromOneTiltToTheNext) {
  const auto cohesive = chute(26, 52.2, {.stiffness = 3.8e5, .adhesion = 5.0});
  const auto run = transient_chute(frictional, cohesive, {.inclination_before = 23 * degree});
  EXPECT_EQ(run.answer.outcome, Outcome::plug) << run.answer.text;
  EXPECT_NEAR(run.final_profile.surface_velocity,
              *run.quadrature_surface_velocity,
              3e-5 * *run.quadrature_surface_velocity);
}

TEST(TiltStep, RefusesToBeginWithAFlowThatDoesNotExist) {
  EXPECT_THROW(transient_chute(frictional, chute(24, 52.2), {.inclination_before = 40 * degree}),
               std::invalid_argument);
  const auto from_rest =
      transient_chute(frictional, chute(15, 52.2), {.inclination_before = 18 * degree});
  EXPECT_EQ(from_rest.answer.outcome, Outcome::arrested);
  EXPECT_EQ(from_rest.answer.time, 0.0);
}

/// Steady flow of V2 (a 1.3, b 0.8, tau_c 6), then a tilt at which the drive is 0.9 of the yield
/// stress at the base.
ChuteCase arresting() {
  ChuteCase chute{.inclination = std::asin(0.9 * 6.0 / 29.0), .mass_per_area = 29.0};
  return chute;
}

TEST(V7Arrest, StopsInTheFiniteTimeOfTheRigidMaterialAndRestsExactly) {
  std::vector<double> times;
  for (int i = 0; i <= 25; ++i) times.push_back(10.0 * i);
  times.push_back(300.0);
  const auto run = transient_chute(
      cohesive_bagnold, arresting(), {.inclination_before = 24 * degree, .output_times = times});
  ASSERT_EQ(run.answer.outcome, Outcome::arrested) << run.answer.text;
  verify("V7", "time of arrest", 258.0, run.answer.time.value(), 0.3);
  verify("V7", "u_s at rest", 0.0, run.final_profile.surface_velocity, 0.0);
  ASSERT_EQ(run.events.size(), 1u);
  EXPECT_EQ(run.events[0].kind, ChuteEvent::Kind::arrest);
  ASSERT_EQ(run.snapshots.size(), times.size());
  for (std::size_t i = 1; i < times.size(); ++i)
    EXPECT_LT(run.snapshots[i].profile.flux, run.snapshots[i - 1].profile.flux) << times[i];
  for (const auto& row : run.snapshots.back().profile.rows) EXPECT_EQ(row.velocity, 0.0);
  const double bound = run.snapshots[0].profile.flux / 29.0 / (6.0 / 29.0 - 0.9 * 6.0 / 29.0);
  EXPECT_NEAR(bound, 1100.5, 0.5);
  EXPECT_LT(run.answer.time.value(), bound);
}

TEST(V7Arrest, OfTheRigidMaterialComesLaterByTwoStepsOfImplicitEuler) {
  const auto layer_at = [](const ChuteCase& chute) {
    const Layer layer = make_layer(cohesive_bagnold, chute);
    return DiscreteLayer(layer, MassGrid(layer.mass, 200, 1.5));
  };
  for (const double dt : {1.0, 2.0}) {
    ExactYield exact(layer_at(arresting()), layer_at(chute(24, 29)).steady());
    double time = 0.0;
    while (exact.largest_velocity() > 1e-12 && time < 400.0) {
      exact.step(dt);
      time += dt;
    }
    EXPECT_NEAR(time, 258.0 + 2.0 * dt, dt);  // known to one step
  }
}

TEST(V7Arrest, OfMuOfIStaysBelowTheBoundOfTheBaseFriction) {
  // H = 50: M = 29.75; the bound is mean velocity / (mu0 cos - sin)
  double previous = 0.0;
  for (const auto& [theta, bound] :
       {std::pair{15.0, 315.0}, {18.0, 968.0}, {19.0, 3152.0}, {19.4, 32449.0}}) {
    const auto run = transient_chute(
        frictional, chute(theta, 29.75), {.cells = 50, .inclination_before = 24 * degree});
    ASSERT_EQ(run.answer.outcome, Outcome::arrested) << run.answer.text;
    EXPECT_LT(*run.answer.time, bound);
    EXPECT_GT(*run.answer.time, previous);
    previous = *run.answer.time;
    EXPECT_EQ(run.final_profile.surface_velocity, 0.0);
    EXPECT_EQ(run.final_profile.plug_mass, 29.75);
  }
}

TEST(V7Arrest, NeverComesWithARegularisedYieldStressWhichSaysHowFastItCreeps) {
  const double delta = 1e-2;
  const auto run = transient_chute(
      frictional,
      chute(18, 29.75),
      {.inclination_before = 24 * degree, .yield_regularisation = delta, .time_limit = 1e5});
  EXPECT_EQ(run.answer.outcome, Outcome::not_converged);
  EXPECT_NE(run.answer.text.find("creeps at 3"), std::string::npos) << run.answer.text;
  // q is uniform: mu0 q / sqrt(q^2 + delta^2) + beta q / (1 + k q) = tan(theta), a Bagnold profile
  const FlowCurve curve = flow_curve(frictional_spheres(), {}, 1.0);
  double low = 0.0, high = 1.0;
  while (high - low > 1e-12) {
    const double q = 0.5 * (low + high);
    const double mu = 0.3530 * q / std::hypot(q, delta) + curve.viscous_stress(q);
    (mu < std::tan(18 * degree) ? low : high) = q;
  }
  const double creep =
      2.0 / 3.0 * low * std::sqrt(std::cos(18 * degree)) / 0.595 * std::pow(29.75, 1.5);
  EXPECT_NEAR(run.final_profile.surface_velocity, creep, 1e-5 * creep);  // grid
}

TEST(Start, IsReportedWhenTheTiltIsRaisedAboveRepose) {
  const auto run = transient_chute(
      frictional, chute(15, 29.75), {.tilts = {{100.0, 24 * degree}}, .time_limit = 300.0});
  EXPECT_EQ(run.answer.outcome, Outcome::started) << run.answer.text;
  EXPECT_EQ(run.answer.time, 100.0);
  ASSERT_EQ(run.events.size(), 1u);
  EXPECT_EQ(run.events[0].kind, ChuteEvent::Kind::start);
}

TEST(Start, OfACohesiveLayerComesOnceItsStressHasReachedYield) {
  const auto cohesive = chute(15, 29.75, {.adhesion = 1.0});
  const auto run = transient_chute(frictional, cohesive, {.tilts = {{100.0, 24 * degree}}});
  EXPECT_EQ(run.answer.outcome, Outcome::plug) << run.answer.text;
  ASSERT_FALSE(run.events.empty());
  EXPECT_EQ(run.events[0].kind, ChuteEvent::Kind::start);
  EXPECT_NEAR(run.events[0].time, 100.0, 1.0);  // a few elastic times of 0.08
}

TEST(Oscillation, AcrossReposeStartsAndStopsEveryTimeWithoutDrift) {
  constexpr int periods = 100;
  TransientOptions options{.cells = 10, .relative_tolerance = 1e-4};
  std::vector<double> rests;
  for (int i = 0; i < periods; ++i) {
    options.tilts.push_back({100.0 * i + 10.0, 23 * degree});
    options.tilts.push_back({100.0 * i + 40.0, 15 * degree});
    options.output_times.push_back(100.0 * i + 40.0);  // fastest
    options.output_times.push_back(100.0 * i + 100.0);
  }
  const auto run = transient_chute(frictional, chute(15, 29.75), options);
  EXPECT_EQ(run.answer.outcome, Outcome::arrested) << run.answer.text;
  ASSERT_EQ(run.events.size(), 2u * periods);
  const double rest_height = run.snapshots[1].profile.height;
  const double speed = run.snapshots[0].profile.surface_velocity;
  for (std::size_t i = 0; i < periods; ++i) {
    EXPECT_EQ(run.events[2 * i].kind, ChuteEvent::Kind::start);
    EXPECT_EQ(run.events[2 * i].time, 100.0 * static_cast<double>(i) + 10.0);
    EXPECT_EQ(run.events[2 * i + 1].kind, ChuteEvent::Kind::arrest);
    EXPECT_NEAR(run.snapshots[2 * i].profile.surface_velocity, speed, 1e-3 * speed);
    const Profile& rest = run.snapshots[2 * i + 1].profile;
    EXPECT_EQ(rest.surface_velocity, 0.0);
    EXPECT_EQ(rest.flux, 0.0);
    EXPECT_EQ(rest.height, rest_height);
    EXPECT_EQ(rest.rows.front().mass_above, 29.75);
  }
}

TEST(TransientOptions, RefuseTiltsThatAreNotInOrder) {
  const auto refuses = [&](const TransientOptions& options) {
    EXPECT_THROW(transient_chute(frictional, chute(24, 52.2), options), std::invalid_argument);
  };
  refuses({.tilts = {{10.0, 0.4}, {5.0, 0.3}}});
  refuses({.tilts = {{-1.0, 0.4}}});
  refuses({.tilts = {{1.0, 2.0}}});
  refuses({.elastic_time = -1.0});
}

}  // namespace
}  // namespace grainlaw::continuum
