#include "continuum/split_bottom.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

/// The ring cell of Shi et al. 2020, section 2.3, in SI units.
SplitBottomCase ring_cell(double depth = 0.040) {
  return {.split_radius = 0.085,
          .depth = depth,
          .rotation_rate = 0.063,
          .gravity = 9.81,
          .grains = {.diameter = 2.2e-3, .density = 2000.0, .stiffness = 100.0}};
}

TEST(LeastTorquePath, HasTheSurfaceRadiiOfAnIndependentShootingMethod) {
  const std::pair<double, double> expected[] = {{.1, .99497},
                                                {.2, .97958},
                                                {.3, .95278},
                                                {.4, .91241},
                                                {.5, .85408},
                                                {.6, .76759},
                                                {.65, .70530},
                                                {.7, .61441}};
  for (const auto& [depth, radius] : expected) {
    const auto paths = least_torque_paths(depth).surface_radius;
    ASSERT_EQ(paths.size(), 1u) << depth;
    EXPECT_NEAR(paths[0], radius, 5e-6) << depth;
  }
}

/// For a shallow filling r = R_s (1 - x^2/2 + ...), x = H/R_s, from r'' = 1/r.
TEST(LeastTorquePath, StaysAboveTheSplitInAShallowFilling) {
  for (const double x : {0.02, 0.05})
    EXPECT_NEAR(least_torque_paths(x).surface_radius.at(0), 1.0 - 0.5 * x * x, x * x * x * x);
}

/// The path tends to the cone r = sqrt(2) y, around which it winds: several open paths exist near
/// H/R_s = 1/sqrt(2), and none beyond the first turn.
TEST(LeastTorquePath, IsNotUniqueInADeepFillingAndThenEnds) {
  EXPECT_EQ(least_torque_paths(0.700).surface_radius.size(), 1u);
  EXPECT_EQ(least_torque_paths(0.720).surface_radius.size(), 2u);
  EXPECT_EQ(least_torque_paths(0.750).surface_radius.size(), 0u);
}

TEST(SplitBottom, BandCentreOfThePublishedCellIsThatOfTheExperiments) {
  const auto cell = split_bottom(table_of(slippery_spheres()), ring_cell());
  EXPECT_NEAR(cell.measured_radius, 0.0721, 5e-5);
  EXPECT_GT(cell.path_radius, cell.measured_radius);
  for (const double ratio : {0.1, 0.2, 0.3})  // both laws agree in shallow fillings
    EXPECT_NEAR(
        least_torque_paths(ratio).surface_radius.at(0), measured_surface_radius(ratio), 0.0026);
}

/// dp/dy = rho_p g phi0 (1 + p/P), P = p_phi k_n / d: about 520 Pa for the published cell. The
/// weight takes phi at the upper end of every part: an error of half a part times the gain of phi
/// below.
TEST(SplitBottom, PressureAtTheBottomIsTheWeight) {
  const auto cell = split_bottom(table_of(slippery_spheres()), ring_cell(), 2000);
  const double P = 0.272 * 100.0 / 2.2e-3;
  const double expected = P * std::expm1(2000.0 * 9.81 * 0.653 * (0.040 - 1e-5) / P);
  EXPECT_NEAR(cell.rows.front().pressure, expected, 2e-5 * expected);
  EXPECT_GT(cell.rows.back().radius, 0.999 * cell.path_radius);
  EXPECT_NEAR(cell.rows.front().radius, 0.085, 1e-4);
}

/// The shear rate r d omega / dr at the centre is the slope of the error function.
TEST(SplitBottom, ShearRateAtTheCentreIsTheSlopeOfTheProfile) {
  const auto cell = split_bottom(table_of(slippery_spheres()), ring_cell());
  for (const std::size_t i : {10u, 50u, 90u}) {
    const auto& row = cell.rows[i];
    const double step = 1e-5 * row.width;
    const double slope = (rotation_share(row.radius + step, row.radius, row.width) -
                          rotation_share(row.radius - step, row.radius, row.width)) /
                         (2.0 * step);
    EXPECT_NEAR(row.shear_rate, row.radius * 0.063 * slope, 1e-8 * row.shear_rate);
    EXPECT_NEAR(row.inertial_number,
                row.shear_rate * 2.2e-3 * std::sqrt(2000.0 / row.pressure),
                1e-12 * row.inertial_number);
  }
}

/// A Coulomb material in a shallow cell: 2 pi mu rho g R_s^2 H^2 / 2.
TEST(SplitBottom, TorqueOfAShallowCoulombFillingIsElementary) {
  const MuPhi coulomb{.friction = {.mu0 = 0.4, .beta = 0.0},
                      .volume_fraction = {.phi0 = 0.6, .I_phi = INFINITY}};
  const SplitBottomCase cell{.split_radius = 1000.0, .depth = 10.0, .rotation_rate = 1e-4};
  const double exact = 2.0 * std::numbers::pi * 0.4 * 0.6 * 1e6 * 50.0;
  EXPECT_NEAR(split_bottom(table_of(coulomb), cell, 1000).torque, exact, 2e-4 * exact);
}

TEST(SplitBottom, WithoutExactlyOnePathNothingIsPicked) {
  for (const double ratio : {0.72, 0.75}) {
    const auto cell = split_bottom(table_of(slippery_spheres()), ring_cell(ratio * 0.085));
    EXPECT_EQ(cell.answer.outcome, Outcome::not_converged);
    EXPECT_TRUE(cell.rows.empty());
  }
}

/// I of the published cell runs from 1.1e-2 at the bottom down to 1.3e-3, p* up to 0.0104.
TEST(SplitBottom, SaysWhereTheTableHasNoData) {
  const auto flagged = [](const RheologyTable& table) {
    const auto cell = split_bottom(table, ring_cell());
    const auto& flags = cell.answer.out_of_domain;
    return flags.empty() ? std::string() : flags.front().quantity;
  };
  RheologyTable table = table_of(slippery_spheres());
  EXPECT_EQ(flagged(table), "");
  table.range.inertial_number = Range{0.005, 0.25};
  EXPECT_EQ(flagged(table), "I");
  table.range.inertial_number.reset();
  table.range.softness = Range{0.0, 0.005};
  EXPECT_EQ(flagged(table), "p*");
}

/// f_p = 1 - sqrt(p*/p_mu) vanishes where p d / k_n = p_mu.
TEST(SplitBottom, GrainsTooSoftForFrictionHaveNoAnswer) {
  SplitBottomCase soft = ring_cell();
  for (const double stiffness : {1.0, 1e-8, 1e-300}) {
    soft.grains.stiffness = stiffness;
    const auto cell = split_bottom(table_of(slippery_spheres()), soft);
    EXPECT_EQ(cell.answer.outcome, Outcome::no_steady) << stiffness;
    EXPECT_TRUE(cell.rows.empty());
  }
}

TEST(SplitBottom, GrainsOfNoSizeAreRefused) {
  SplitBottomCase cell = ring_cell();
  for (const double diameter : {1e-300, 1e300}) {
    cell.grains.diameter = diameter;
    EXPECT_THROW(split_bottom(table_of(slippery_spheres()), cell), std::invalid_argument);
  }
}

TEST(SplitBottom, AFillingTooShallowForItsPathIsNotCalledADome) {
  const auto cell = split_bottom(table_of(slippery_spheres()), ring_cell(1e-6));
  EXPECT_EQ(cell.answer.outcome, Outcome::not_converged);
  EXPECT_NE(cell.answer.text.find("too shallow"), std::string::npos);
}

TEST(SplitBottom, IsCalledGeometry) {
  const auto cell = split_bottom(table_of(slippery_spheres()), ring_cell());
  EXPECT_NE(cell.answer.text.find("geometry, not a solution"), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::continuum
