#include "continuum/ring_flow.h"

#include <gtest/gtest.h>

#include <cmath>

#include "continuum/ring_fluidity.h"
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

TEST(RingFlow, FlagsALocalBandThinnerThanGrainsMake) {
  EXPECT_TRUE(ring_flow(table, ring(1e-6)).local_band_collapse);
  EXPECT_FALSE(ring_flow(table, ring(1.884)).local_band_collapse);
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
  EXPECT_EQ(ring_flow(table, ring(1e5)).answer.outcome, Outcome::no_dense_state);
}

TEST(RingFlow, RefusesWhatHasNoMeaning) {
  RingFlowCase inside_out = ring(1.884);
  inside_out.inner_radius = 0.09;
  EXPECT_THROW(ring_flow(table, inside_out), std::invalid_argument);
  EXPECT_THROW(ring_flow(table, ring(1.884, -1.0)), std::invalid_argument);
  EXPECT_THROW(ring_flow(table, ring(1.884, 1e4)), std::invalid_argument);
  for (const double rate : {std::nan(""), 1e-300, 1e300})
    EXPECT_THROW(ring_flow(table, ring(rate)), std::invalid_argument) << rate;
  EXPECT_THROW(ring_flow(table, ring(1.884), {.cell_width = 1e-3}), std::invalid_argument);
  RheologyTable power = table;
  std::get<MuPhi>(power.law).friction.exponent = 0.5;
  EXPECT_THROW(ring_flow(power, ring(1.884, 0.3)), TableError);
  EXPECT_EQ(ring_flow(power, ring(1.884)).answer.outcome, Outcome::steady);
}

}  // namespace
}  // namespace grainlaw::continuum
