// Does the energy ledger close? Residual over dissipated energy, for all laws and all boundaries.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

constexpr Hertz hertz{.stiffness = 2e5, .damping = 150.0};
// Attractions of some 20 grain weights; the well as wide as one grain in fifty.
constexpr GaussianWell well{.strength = 0.25, .width = 0.01};
constexpr ReversibleAdhesion dry{.largest_force = 20.0, .slope = 500.0};
constexpr LiquidBridge wet{.surface_tension = 3.0, .contact_angle = 0.2, .volume = 2e-4};
const Sliding grip = sliding(0.5, 2e4, 5.0);
const StickSlip stick{
    .static_coefficient = 0.6, .coefficient = 0.4, .stiffness = 6e3, .damping = 5.0};

/// What a run of a scene leaves unexplained, over what it dissipated.
template <class Law>
double relative_residual(const Scene& scene, const Law& law, double time) {
  Simulation simulation = flow(scene, law);
  run_until(simulation, time);
  const EnergyLedger ledger = simulation.ledger();
  EXPECT_GT(ledger.normal_dashpot, 0.0);
  if constexpr (Law::rotates) {
    EXPECT_GT(ledger.slip, 0.0);
    EXPECT_GT(ledger.tangential_dashpot, 0.0);
  }
  if constexpr (Law::bridges) {
    EXPECT_GT(ledger.bridge_lost, 0.0);
  }
  return ledger.residual(simulation.mechanical_energy()) / ledger.dissipated();
}

/// The bounds the program promises for every run at its default step and at a third of it.
template <class Law>
void expect_closed(const char* name, const Scene& scene, const Law& law, double time) {
  const double at_default = relative_residual(with(scene, law, 50.0), law, time);
  const double at_third = relative_residual(with(scene, law, 150.0), law, time);
  std::cout << name << ": residual / dissipated at 1/50: " << at_default
            << ", at 1/150: " << at_third << '\n';
  EXPECT_LT(std::abs(at_default), 1e-3) << name;
  EXPECT_LT(std::abs(at_third), 1e-4) << name;
}

/// A column that falls on its tilted base, comes apart into collisions and shears.
template <class Law>
void expect_closed_column(const char* name, const Law& law) {
  expect_closed(name, small_chute(25.0), law, 6.0);
}

TEST(EnergyLedger, ClosesForAFallingColumnUnderEveryPairOfNormalLawAndCohesion) {
  expect_closed_column("hooke", ContactLaw{soft, Cohesionless{}, grip});
  expect_closed_column("hooke, well", ContactLaw{soft, well, grip});
  expect_closed_column("hooke, reversible", ContactLaw{soft, dry, grip});
  expect_closed_column("hooke, bridge", ContactLaw{soft, wet, grip});
  expect_closed_column("hertz", ContactLaw{hertz, Cohesionless{}, grip});
  expect_closed_column("hertz, well", ContactLaw{hertz, well, grip});
  expect_closed_column("hertz, reversible", ContactLaw{hertz, dry, grip});
  expect_closed_column("hertz, bridge", ContactLaw{hertz, wet, grip});
}

TEST(EnergyLedger, ClosesForAFallingColumnUnderEveryFriction) {
  expect_closed_column("hooke, no friction", ContactLaw{soft, Cohesionless{}, Frictionless{}});
  expect_closed_column("hooke, stick-slip", ContactLaw{soft, Cohesionless{}, stick});
  expect_closed_column("hertz, bridge, no friction", ContactLaw{hertz, wet, Frictionless{}});
  expect_closed_column("hertz, reversible, stick-slip", ContactLaw{hertz, dry, stick});
}

TEST(EnergyLedger, ClosesInAShearedBoxOfFixedVolume) {
  expect_closed("box", small_shear(std::nullopt), ContactLaw{soft, Cohesionless{}, grip}, 4.0);
}
TEST(EnergyLedger, ClosesInAShearedBoxUnderPressure) {
  expect_closed(
      "box under pressure", small_shear(10.0), ContactLaw{soft, Cohesionless{}, grip}, 4.0);
}
TEST(EnergyLedger, ClosesBetweenWallsAtAFixedGap) {
  expect_closed("walls", small_plane_shear(std::nullopt), ContactLaw{soft, dry, grip}, 4.0);
}
TEST(EnergyLedger, ClosesBetweenWallsUnderLoad) {
  expect_closed(
      "walls under load", small_plane_shear(10.0), ContactLaw{soft, Cohesionless{}, grip}, 4.0);
}
TEST(EnergyLedger, ClosesInABoxDrivenByABodyForce) {
  expect_closed("body force", small_force_box(), ContactLaw{soft, Cohesionless{}, grip}, 4.0);
}
TEST(EnergyLedger, ClosesInARingCellWithWetGrains) {
  expect_closed("ring", small_ring(), ContactLaw{soft, wet, grip}, 4.0);
}

/// Largest relative drift of the energy of a gas that cannot lose any.
double drift(double steps_per_contact, double shear_rate) {
  const Hooke elastic{.stiffness = 2e4, .damping = 0.0};
  SimulationSetup setup = free_space(elastic.contact_time(0.5) / steps_per_contact);
  if (shear_rate > 0.0) setup.drive = BoxDrive{.shear_rate = shear_rate};
  Simulation box(smooth(elastic), setup, gas(5.0, 100, 1.0));
  const double scale = box.ledger().initial_energy;
  double largest = 0.0;
  while (box.time() < 3.0) {
    box.step();
    const double residual = box.ledger().residual(box.mechanical_energy());
    largest = std::max(largest, std::abs(residual) / scale);
  }
  EXPECT_EQ(box.ledger().dissipated(), 0.0);
  return largest;
}

TEST(EnergyLedger, ElasticGasKeepsItsEnergy) {
  // Bounds as promised, here against the initial energy.
  EXPECT_LT(drift(50.0, 0.0), 1e-3);
  EXPECT_LT(drift(150.0, 0.0), 1e-4);
}

TEST(EnergyLedger, ElasticGasGainsTheWorkOfItsShearedImages) {
  EXPECT_LT(drift(50.0, 0.5), 1e-3);
  EXPECT_LT(drift(150.0, 0.5), 1e-4);
}

}  // namespace
}  // namespace grainlaw::dem
