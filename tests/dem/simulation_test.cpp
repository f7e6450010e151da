#include "dem/simulation.h"

#include <gtest/gtest.h>

#include "dem/run.h"
#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

double default_step(const Hooke& law) {
  return law.contact_time(0.5) / 50.0;
}

TEST(Simulation, MomentumIsConservedInAPeriodicBox) {
  const auto start = gas(5.0, 100, 1.0, default_step(soft));
  Simulation box(rough(soft, 0.5), start.setup, start.initial);
  const Vec3 before = momentum(box);
  for (int k = 0; k < 5000; ++k) box.step();
  EXPECT_GT(box.ledger().dissipated(), 0.1 * box.ledger().initial_energy);  // it did collide
  // 100 grains, 5000 steps of rounding at 1e-16 relative: a random walk stays below 1e-12.
  EXPECT_LT(length(momentum(box) - before), 1e-12);
}

// About a fixed point: sum of r x m v + I omega, I omega = 2/5 m R (R omega).
Vec3 angular_momentum(const auto& pair) {
  Vec3 sum;
  for (std::size_t i = 0; i < 2; ++i) {
    sum += cross(pair.particles().state[i].position, pair.velocity(i)) + 0.4 * 0.5 * pair.spin(i);
  }
  return sum;
}

TEST(Simulation, AngularMomentumOfAnIsolatedPairIsConserved) {
  InitialState initial;
  initial.position = {{0.1, 0.2, 0.3}, {1.1, 0.3, 0.5}};
  initial.velocity = {{1.0, 0.3, 0.0}, {-1.0, 0.0, -0.4}};
  initial.spin = {{0.3, -0.2, 0.5}, {0.0, 0.4, -0.6}};
  Simulation pair(rough(stiff, 0.05), free_space(default_step(stiff)), initial);
  const Vec3 before = angular_momentum(pair);
  for (int k = 0; k < 200; ++k) pair.step();
  EXPECT_GT(pair.ledger().slip, 0.0);
  EXPECT_EQ(pair.touching_pairs(), 0u);
  // The velocity is centred at n, so r x v of the leapfrog is conserved to rounding.
  EXPECT_LT(length(angular_momentum(pair) - before), 1e-13);
}

TEST(Simulation, UniformMotionChangesNothing) {
  auto start = gas(5.0, 60, 1.0, default_step(soft));
  Simulation at_rest(rough(soft, 0.5), start.setup, start.initial);
  const Vec3 drift{0.25, -0.5, 0.125};
  for (Vec3& v : start.initial.velocity) v += drift;
  Simulation moving(rough(soft, 0.5), start.setup, start.initial);
  for (int k = 0; k < 500; ++k) {
    at_rest.step();
    moving.step();
  }
  EXPECT_NEAR(at_rest.ledger().dissipated(),
              moving.ledger().dissipated(),
              1e-9 * at_rest.ledger().dissipated());
}

/// Ledger residual over total dissipated energy of a rough column that falls and comes to rest.
double relative_residual(double steps_per_contact) {
  Scene scene = small_chute(0.0, 110);
  const ChuteGrains grains = pack_chute(scene);
  SimulationSetup setup;
  setup.box = grains.box;
  setup.dynamics = {.mass = 1.0,
                    .gravity = {std::sin(radians(25)), 0, -std::cos(radians(25))},
                    .time_step = soft.contact_time(0.5) / steps_per_contact};
  Simulation simulation(
      rough(soft, 0.5),
      setup,
      {.position = grains.column, .velocity = {}, .spin = {}, .frozen = grains.base});
  while (simulation.time() < 15.0) simulation.step();
  const EnergyLedger ledger = simulation.ledger();
  EXPECT_GT(ledger.normal_dashpot, 0.0);
  EXPECT_GT(ledger.slip, 0.0);
  EXPECT_GT(ledger.spring_lost, 0.0);
  return ledger.residual(simulation.mechanical_energy()) / ledger.dissipated();
}

TEST(EnergyLedger, ClosesAtTheDefaultStepAndToSecondOrder) {
  const double at_default = relative_residual(50.0);
  const double at_third = relative_residual(150.0);
  std::cout << "residual / dissipated at 1/50: " << at_default << ", at 1/150: " << at_third
            << '\n';
  EXPECT_LT(std::abs(at_default), 1e-3);
  EXPECT_LT(std::abs(at_third), 1e-4);
}

TEST(EnergyLedger, ElasticGasKeepsItsEnergyToTheSquareOfTheStep) {
  const Hooke elastic{.stiffness = 2e4, .damping = 0.0};
  const auto drift = [&](double steps_per_contact) {
    const auto start = gas(5.0, 100, 1.0, elastic.contact_time(0.5) / steps_per_contact);
    Simulation box(smooth(elastic), start.setup, start.initial);
    while (box.time() < 3.0) box.step();
    EXPECT_EQ(box.ledger().dissipated(), 0.0);
    return std::abs(box.mechanical_energy() / box.ledger().initial_energy - 1.0);
  };
  // The bounds the program promises for every run. The scheme has no secular drift: what is left
  // is the (omega dt)^2 of the contacts going on and the random phase at which contacts begin.
  EXPECT_LT(drift(50.0), 1e-3);
  EXPECT_LT(drift(150.0), 1e-4);
}

TEST(Simulation, OverlapAboveTheBoundStopsTheRunNamingTheContact) {
  InitialState initial;
  initial.position = {{}, {1.0, 0.0, 0.0}};
  initial.velocity = {{60.0, 0.0, 0.0}, {-60.0, 0.0, 0.0}};
  Simulation pair(smooth(stiff), free_space(default_step(stiff)), initial);
  try {
    for (int k = 0; k < 100; ++k) pair.step();
    FAIL() << "no error";
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find("grains 0 and 1 overlap by 0.3"), std::string::npos)
        << error.what();
  }
}

TEST(Simulation, NaNStopsTheRunWithinOneStepNamingTheGrain) {
  InitialState initial;
  initial.position = {{}, {3.0, 0.0, 0.0}, {6.0, 0.0, 0.0}};
  initial.velocity = {{}, {NAN, 0.0, 0.0}, {}};
  Simulation three(smooth(stiff), free_space(1e-4), initial);
  try {
    three.step();
    FAIL() << "no error";
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find("step 1: grain 1"), std::string::npos) << error.what();
  }
}

TEST(Simulation, GrainBelowTheBaseIsLost) {
  SimulationSetup setup = free_space(1e-3);
  setup.lowest_height = -1.0;
  setup.dynamics.gravity = {0.0, 0.0, -1.0};
  Simulation falling(
      smooth(stiff), setup, {.position = {{}}, .velocity = {}, .spin = {}, .frozen = {}});
  EXPECT_THROW(for (int k = 0; k < 2000; ++k) falling.step(), RunError);
}

TEST(Packing, IsRandomWithoutOverlapAndTheSameForTheSameSeed) {
  const Box box{{6.0, 6.0, 8.0}};
  const auto count = static_cast<std::size_t>(0.585 * 288.0 * 6.0 / std::numbers::pi);
  const auto packing = random_packing(box, count, 1.0, 5);
  EXPECT_EQ(packing, random_packing(box, count, 1.0, 5));
  EXPECT_NE(packing, random_packing(box, count, 1.0, 6));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 difference = packing[i] - packing[j];
      const Vec3 shift = box.image_shifts()[box.nearest_image(difference)];
      ASSERT_GT(length(difference - shift), 1.0 - 1e-3);
    }
  }
}

TEST(Packing, BaseAndColumnOfAChuteAreOnePackingCutAtAHeight) {
  const Scene scene = small_chute(20.0);
  const ChuteGrains grains = pack_chute(scene);
  EXPECT_EQ(grains.column.size(), 55u);
  const auto lower = [](const Vec3& a, const Vec3& b) { return a.z < b.z; };
  EXPECT_DOUBLE_EQ(std::max_element(grains.base.begin(), grains.base.end(), lower)->z, -0.5);
  EXPECT_GT(std::min_element(grains.column.begin(), grains.column.end(), lower)->z, -0.5);
}

}  // namespace
}  // namespace grainlaw::dem
