// A chute whose tilt changes on the way: gravity turns, nothing else does.
#include <gtest/gtest.h>

#include "dem/run.h"
#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

TEST(Tilt, FreeGrainFallsByTheNewGravityFromTheVelocityItHas) {
  const double dt = 1e-3;
  const Vec3 before = gravity(1.0, radians(24.0));
  const Vec3 after = gravity(1.0, radians(18.0));
  SimulationSetup setup = free_space(dt);
  setup.dynamics.field = Uniform{before};
  InitialState one;
  one.grains.push_back({.position = {1.0, 2.0, 3.0}});
  Simulation simulation(smooth(soft), setup, one);
  for (int k = 0; k < 400; ++k) simulation.step();
  simulation.set_field(Uniform{after});
  for (int k = 0; k < 600; ++k) simulation.step();
  const double t = 400 * dt, s = 600 * dt;
  const Vec3 way = (0.5 * t * t + t * s) * before + 0.5 * s * s * after;
  // Leapfrog is exact under a constant force: what is left is the rounding of 1000 steps.
  constexpr double rounding = 1000 * 4.0 * 2.2e-16;
  EXPECT_LT(length(simulation.particles().state[0].position - Vec3{1.0, 2.0, 3.0} - way), rounding);
  EXPECT_LT(length(simulation.velocity(0) - t * before - s * after), rounding);
  const double energy = simulation.kinetic_energy();
  EXPECT_NEAR(simulation.ledger().field_work, energy, rounding * energy);
}

/// Flows, is laid back and comes to rest.
Scene arresting_chute() {
  Scene scene = small_chute(26.0);
  std::get<Chute>(scene.geometry).tilts = {{7.03, radians(24.0)}, {13.0, radians(10.0)}};
  scene.measurement.averaging_time = 100.0;
  scene.measurement.time_limit = 100.0;
  return scene;
}

TEST(Tilt, LayerThatIsLaidBackArrestsAndTheRunSaysWhen) {
  const LocalData data = run(arresting_chute());
  ASSERT_TRUE(data.window.arrested_at.has_value()) << data.window.reason;
  EXPECT_EQ(data.window.reason.substr(0, 15), "arrested at t =") << data.window.reason;
  const double rest = *data.window.arrested_at;
  EXPECT_GT(rest, 13.0);
  for (const ProfileFrame& frame : data.frames.frames) {
    if (frame.begin >= rest) {
      EXPECT_LE(std::abs(mean_velocity(frame)), 1e-3) << frame.begin;
    }
    if (frame.end == rest) {
      EXPECT_GT(mean_velocity(frame), 1e-3);
    }
  }
  // Rest is seen after 20 time units, by whole frames of 2.
  EXPECT_NEAR(data.window.end, rest + 20.0, 2.1);
  EXPECT_LE(data.summary.energy_residual, 1e-3);
}

TEST(Tilt, ConditionsTellTheTiltOfTheRowsAndTheWayToIt) {
  const LocalData data = run(arresting_chute());
  EXPECT_EQ(data.conditions.inclination, radians(10.0));
  const std::vector<TiltStep> history{
      {0.0, radians(26.0)}, {7.03, radians(24.0)}, {13.0, radians(10.0)}};
  EXPECT_EQ(data.conditions.tilts, history);
  EXPECT_TRUE(run(small_chute(12.0)).conditions.tilts.empty());
}

TEST(Tilt, RestBeforeTheLastTiltDoesNotEndTheRun) {
  Scene scene = small_chute(10.0);  // below repose: at rest from the start
  std::get<Chute>(scene.geometry).tilts = {{40.0, radians(26.0)}};
  scene.measurement.averaging_time = 10.0;
  scene.measurement.time_limit = 60.0;
  const LocalData data = run(scene);
  EXPECT_GT(data.window.end, 50.0);
  EXPECT_GE(data.window.begin, 40.0);
  EXPECT_FALSE(data.window.arrested_at.has_value()) << data.window.reason;
}

TEST(Tilt, RunThatIsTakenUpBeforeOrAfterATiltIsThatWhichWasNot) {
  const Scene scene = arresting_chute();
  const LocalData whole = run(scene);
  for (const double stop : {3.0, 7.0, 9.0, 15.0}) {
    Checkpoint checkpoint;
    RunOptions options;
    options.observer = [&](const Progress& p) { return p.settling || p.time < stop; };
    options.save = [&](const Checkpoint& saved) { checkpoint = saved; };
    run(scene, options);
    RunOptions resume;
    resume.resume = &checkpoint;
    const LocalData resumed = run(scene, resume);
    ASSERT_EQ(resumed.frames.frames.size(), whole.frames.frames.size()) << stop;
    for (std::size_t k = 0; k < whole.frames.frames.size(); ++k) {
      const ProfileFrame& a = whole.frames.frames[k];
      const ProfileFrame& b = resumed.frames.frames[k];
      EXPECT_EQ(a.kinetic_energy, b.kinetic_energy) << stop << " " << k;
      EXPECT_EQ(a.centre_of_mass, b.centre_of_mass) << stop << " " << k;
    }
    EXPECT_EQ(whole.summary.energy_residual, resumed.summary.energy_residual) << stop;
    EXPECT_EQ(whole.window.arrested_at, resumed.window.arrested_at) << stop;
  }
}

TEST(Tilt, StoppedRunIsOfTheTiltItHadReached) {
  RunOptions options;
  options.observer = [](const Progress& p) { return p.settling || p.time < 9.0; };
  const LocalData data = run(arresting_chute(), options);
  EXPECT_EQ(data.conditions.inclination, radians(24.0));
  EXPECT_FALSE(data.window.steady);
}

/// Enough grains for two strips.
TEST(Tilt, ThreadsDoNotChangeThePathAcrossATilt) {
  Scene scene = small_chute(26.0, 4100);
  auto& chute = std::get<Chute>(scene.geometry);
  chute.length = chute.width = 20.0;
  chute.base = FlatBase{};
  const auto law = rough(soft, 0.5);
  scene = with(scene, law, 50.0);
  Simulation one = flow(scene, law, 1);
  Simulation two = flow(scene, law, 2);
  const auto run_across = [](auto& simulation) {
    for (int k = 0; k < 100; ++k) simulation.step();
    simulation.set_field(Uniform{gravity(1.0, radians(18.0))});
    for (int k = 0; k < 100; ++k) simulation.step();
    return motions(simulation);
  };
  const Motions a = run_across(one);
  const Motions b = run_across(two);
  ASSERT_EQ(a.position.size(), 4100u);
  for (std::size_t i = 0; i < a.position.size(); ++i) {
    EXPECT_EQ(length(a.position[i] - b.position[i]), 0.0) << i;
    EXPECT_EQ(length(a.velocity[i] - b.velocity[i]), 0.0) << i;
  }
}

TEST(Tilt, ScenesThatContradictThemselvesAreRefused) {
  const auto refused = [](std::vector<TiltStep> tilts) {
    Scene scene = small_chute(26.0);
    std::get<Chute>(scene.geometry).tilts = std::move(tilts);
    EXPECT_THROW(validate(scene), SceneError);
  };
  refused({{10.0, radians(-1.0)}});
  refused({{10.0, radians(90.0)}});
  refused({{0.0, radians(20.0)}});
  refused({{20.0, radians(20.0)}, {20.0, radians(24.0)}});
  refused({{1000.0, radians(20.0)}});  // the time limit: it would never be
}

}  // namespace
}  // namespace grainlaw::dem
