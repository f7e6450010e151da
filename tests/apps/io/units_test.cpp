#include "apps/io/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace grainlaw::io {
namespace {

constexpr double bits = 8.0 * 2.220446049250313e-16;

TEST(Units, GrainUnitsAreTheInternalOnes) {
  for (const Dimension d : {dimension::length, dimension::stress, dimension::bagnold_b}) {
    EXPECT_EQ(grain_units().size(d), 1.0);
  }
}

TEST(Units, GravityGrainMassAndDensityFollowFromTheSiUnits) {
  const Units si = si_units(2e-3, 2500.0, 9.81);
  EXPECT_NEAR(si.size(dimension::acceleration), 9.81, 9.81 * bits);
  // Internal density is 6/pi: of a grain with m = d = 1.
  EXPECT_NEAR(6.0 / std::numbers::pi * si.size(dimension::density), 2500.0, 2500.0 * bits);
}

TEST(Units, StiffnessUnitsHaveDensityAndGravityOfTheFile) {
  const Units units = stiffness_units(1e-5);
  EXPECT_NEAR(units.size(dimension::acceleration), 1e-5, 1e-5 * bits);
  EXPECT_NEAR(6.0 / std::numbers::pi * units.size(dimension::density), 1.0, bits);
}

TEST(Units, DimensionlessNumbersDoNotDependOnTheSet) {
  // I = gd d sqrt(rho_p/p) from sizes: rate x length x sqrt(density/stress) has size 1.
  for (const Units& u : {si_units(2e-3, 2500.0, 9.81), stiffness_units(1e-5)}) {
    const double size = u.size(dimension::rate) * u.size(dimension::length) *
                        std::sqrt(u.size(dimension::density) / u.size(dimension::stress));
    EXPECT_NEAR(size, 1.0, bits);
  }
}

TEST(Units, SymbolsAreReadable) {
  const Units si = si_units(1e-3, 2500.0, 9.81);
  EXPECT_EQ(si.symbol(dimension::stress), "Pa");
  EXPECT_EQ(si.symbol(dimension::mass_flow), "kg/(m s)");
  EXPECT_EQ(grain_units().symbol(dimension::stress), "m g/d^2");
  EXPECT_EQ(stiffness_units(1e-5).symbol(dimension::stress), "k_n/d");
  EXPECT_EQ(si.symbol(dimension::velocity), "m/s");
  EXPECT_EQ(si.symbol(dimension::number), "1");
  EXPECT_EQ(grain_units().symbol(dimension::velocity), "sqrt(g d)");
  EXPECT_EQ(grain_units().symbol(dimension::rate), "sqrt(g/d)");
  EXPECT_EQ(grain_units().symbol(dimension::time), "sqrt(d/g)");
  EXPECT_EQ(stiffness_units(1e-5).symbol(dimension::velocity), "d/t");
  EXPECT_EQ(si[dimension::stiffness].text, "mass/time^2");
}

}  // namespace
}  // namespace grainlaw::io
