#include "continuum/ring_flow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "continuum/ring_fluidity.h"
#include "continuum/torque_balance.h"
#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

/// The ring cell of Shi et al. 2020, section 2.3, in SI units.
RingFlowCase ring(double rotation_rate, std::optional<double> amplitude = {}) {
  return {.cell = {.split_radius = 0.085,
                   .depth = 0.037,
                   .rotation_rate = rotation_rate,
                   .gravity = 9.81,
                   .grains = {.diameter = 2.2e-3, .density = 2000.0, .stiffness = 100.0}},
          .inner_radius = 0.0147,
          .outer_radius = 0.110,
          .nonlocal_amplitude = amplitude};
}

const RheologyTable table = table_of(slippery_spheres());

/// Far above the bottom a uniform viscosity makes omega = (1/R_i^2 - 1/r^2) / (1/R_i^2 - 1/R_o^2).
TEST(TorqueBalance, HasTheCouetteFlowBetweenTallCylinders) {
  const RingMesh mesh(2.0, 5.0, 6.0, 40.0, 0.1);
  TorqueBalance balance(mesh, 5.0);
  std::vector<double> unknowns(balance.unknowns());
  balance.solve(std::vector<double>(mesh.cells(), 3.0), unknowns);
  const std::vector<double> rotation = balance.scatter(unknowns);
  for (std::size_t i = 0; i < mesh.r().size(); ++i) {
    const double r = mesh.r()[i];
    const double exact = (0.25 - 1.0 / (r * r)) / (0.25 - 1.0 / 36.0);
    EXPECT_NEAR(rotation[mesh.node(i, mesh.rows())], exact, 1e-3) << r;
  }
}

/// Diffusion changes nothing where there is nothing to even out.
TEST(RingFluidity, IsThatOfTheLocalLawInHomogeneousShear) {
  const RingMesh mesh(5.0, 8.0, 10.0, 6.0, 0.5);
  const MuPhi law = slippery_spheres();
  const double p = 3.0, rate = 0.2;
  for (const double amplitude : {0.0, 0.1, 1.0, 10.0}) {
    RingFluidity fluidity(mesh, law, {}, std::vector<double>(mesh.rows(), p), amplitude);
    std::vector<double> g(mesh.cells(), 0.03);
    fluidity.solve(std::vector<double>(mesh.cells(), rate), g);
    const double expected = p * rate / shear_stress(law, GrainProperties{}, rate, p);
    for (const double value : g) EXPECT_NEAR(value, expected, 1e-9 * expected) << amplitude;
  }
}

/// A law without rate is a plastic material: among all rotations it takes the one of least torque,
/// a band on the path of Unger et al. (2004), which is found by other means in split_bottom.cpp.
TEST(RingFlow, SlowLocalFlowTakesThePathOfLeastTorque) {
  const RingFlowCase slow = ring(1e-6);
  const RingFlow flow = ring_flow(table, slow, {.cell_width = 0.25});
  const SplitBottom path = split_bottom(table, slow.cell, 1000);
  ASSERT_EQ(flow.answer.outcome, Outcome::steady) << flow.answer.text;
  EXPECT_NEAR(flow.torque, path.torque, 0.01 * path.torque);
  EXPECT_GT(flow.torque, path.torque);
  for (const RingFlowRow& row : flow.rows) {
    const auto near = std::ranges::min_element(
        path.rows, {}, [&](const SplitBottomRow& other) { return std::abs(other.z - row.z); });
    EXPECT_NEAR(row.centre, near->radius, 0.25 * slow.cell.grains.diameter) << row.z;
  }
  EXPECT_TRUE(flow.local_band_collapse);
  EXPECT_LT(flow.rows.back().width, 1.0 * slow.cell.grains.diameter);
}

TEST(RingFlow, ConvergesWithFirstOrderInTheCellWidth) {
  const auto error = [&](double width) {
    return ring_flow(table, ring(1.884, 0.3), {.cell_width = width}).discretisation_error;
  };
  const double coarse = error(0.5), fine = error(0.25);
  EXPECT_NEAR(coarse / fine, 2.0, 0.4);
  EXPECT_LT(coarse, 0.015);
}

TEST(RingFlow, NonlocalBandsWidenWithTheAmplitude) {
  const double local = ring_flow(table, ring(0.5)).rows.back().width;
  EXPECT_NEAR(ring_flow(table, ring(0.5, 1e-3)).rows.back().width, local, 1e-3 * local);
  double before = local;
  for (const double amplitude : {0.2, 0.4, 0.8}) {
    const double width = ring_flow(table, ring(0.5, amplitude)).rows.back().width;
    EXPECT_GT(width, 1.02 * before) << amplitude;
    before = width;
  }
}

/// Experiments (Fenistein et al. 2004): a slow band has a width that does not depend on the rate,
/// where the local law collapses.
TEST(RingFlow, SlowNonlocalBandsDoNotDependOnTheRate) {
  const RingFlow slow = ring_flow(table, ring(1e-3, 0.4));
  const RingFlow slower = ring_flow(table, ring(1e-5, 0.4));
  EXPECT_FALSE(slow.local_band_collapse);
  EXPECT_GT(slow.rows.back().width, 5.0 * 2.2e-3);
  EXPECT_NEAR(slow.rows.back().width, slower.rows.back().width, 0.01 * slow.rows.back().width);
}

TEST(RingFlow, IsTheSameInOtherUnits) {
  RingFlowCase grain = ring(0.0, 0.3);
  const double d = 2.2e-3;
  grain.cell.grains = {
      .diameter = 1.0, .density = 1.0, .stiffness = 100.0 / (2000.0 * 9.81 * d * d)};
  for (double* length :
       {&grain.cell.split_radius, &grain.cell.depth, &grain.inner_radius, &grain.outer_radius})
    *length /= d;
  grain.cell.gravity = 1.0;
  grain.cell.rotation_rate = 1.884 * std::sqrt(d / 9.81);
  const RingFlow one = ring_flow(table, ring(1.884, 0.3));
  const RingFlow other = ring_flow(table, grain);
  EXPECT_NEAR(one.torque, other.torque * 2000.0 * 9.81 * std::pow(d, 4), 1e-6 * one.torque);
  EXPECT_NEAR(one.rows.back().width, other.rows.back().width * d, 1e-6 * d);
}

/// In a deep filling the band closes into a dome below the surface (Cheng et al. 2006).
TEST(RingFlow, SaysThatADeepBandDoesNotReachTheSurface) {
  RingFlowCase deep = ring(1.884, 0.3);
  deep.cell.depth = 0.13;
  const RingFlow flow = ring_flow(table, deep);
  EXPECT_NE(flow.answer.text.find("does not reach the surface"), std::string::npos)
      << flow.answer.text;
}

TEST(RingFlow, AnswersWhereTheLawHasLeftPhysics) {
  RingFlowCase soft = ring(1.884);
  soft.cell.grains.stiffness = 1e-3;
  EXPECT_EQ(ring_flow(table, soft).answer.outcome, Outcome::no_steady);
  EXPECT_EQ(ring_flow(table, ring(1e6)).answer.outcome, Outcome::no_dense_state);
}

TEST(RingFlow, RefusesWhatHasNoMeaning) {
  RingFlowCase inside_out = ring(1.884);
  inside_out.inner_radius = 0.09;
  EXPECT_THROW(ring_flow(table, inside_out), std::invalid_argument);
  EXPECT_THROW(ring_flow(table, ring(1.884, -1.0)), std::invalid_argument);
  EXPECT_THROW(ring_flow(table, ring(std::nan(""))), std::invalid_argument);
  EXPECT_THROW(ring_flow(table, ring(1.884), {.cell_width = 1e-3}), std::invalid_argument);
  RheologyTable power = table;
  std::get<MuPhi>(power.law).friction.exponent = 0.5;
  EXPECT_THROW(ring_flow(power, ring(1.884, 0.3)), TableError);
  EXPECT_EQ(ring_flow(power, ring(1.884)).answer.outcome, Outcome::steady);
}

}  // namespace
}  // namespace grainlaw::continuum
