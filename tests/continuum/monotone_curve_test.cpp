#include "continuum/monotone_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "continuum/dual.h"
#include "continuum/flow_curve.h"
#include "continuum/shear_band.h"
#include "continuum/well_posedness.h"
#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

/// Steep, flat, steep: a cubic with the mean slopes at the points would overshoot.
MonotoneCurve stairs() {
  return {{0.0, 0.1, 0.2, 0.25, 0.6}, {0.30, 0.31, 0.50, 0.505, 0.80}};
}

std::string refusal(std::vector<double> I, std::vector<double> mu) {
  try {
    MonotoneCurve(std::move(I), std::move(mu));
  } catch (const TableError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(MonotoneCurve, PassesThroughItsPointsWithoutOvershoot) {
  const MonotoneCurve mu = stairs();
  for (std::size_t k = 0; k < mu.x().size(); ++k) EXPECT_NEAR(mu(mu.x()[k]), mu.y()[k], 1e-16);
  for (int i = 1; i <= 6000; ++i) {
    EXPECT_GE(mu(i * 1e-4), mu((i - 1) * 1e-4) - 1e-16) << i;  // rounding of a number below 1
    EXPECT_GE(mu.slope(i * 1e-4), 0.0);
  }
}

TEST(MonotoneCurve, IsHeldBeyondItsEnds) {
  const MonotoneCurve mu({0.1, 0.3}, {0.4, 0.5});
  EXPECT_EQ(mu(0.0), 0.4);
  EXPECT_EQ(mu(7.0), 0.5);
  EXPECT_EQ(mu.slope(0.05), 0.0);
  EXPECT_EQ(mu.slope(0.31), 0.0);
  EXPECT_EQ(mu.inverse(0.2), 0.1);
  EXPECT_FALSE(mu.inverse(0.5001));
}

TEST(MonotoneCurve, HasContinuousSlopesThatItsDualNumbersShare) {
  const MonotoneCurve mu = stairs();
  for (const double I : {0.1, 0.2, 0.25})  // the curvature is below 1e3, the step 1e-9
    EXPECT_NEAR(mu.slope(I - 1e-9), mu.slope(I + 1e-9), 2e-6);
  for (const double I : {0.05, 0.13, 0.22, 0.5})
    EXPECT_NEAR(mu(Dual<1>::variable(I, 0)).slope[0], mu.slope(I), 1e-14);
}

TEST(MonotoneCurve, InverseGivesBackTheInertialNumber) {
  const MonotoneCurve mu = stairs();
  for (const double I : {1e-6, 0.03, 0.1, 0.11, 0.24, 0.3, 0.59})
    // mu has a rounding of 1e-16, and the cubic three of them
    EXPECT_NEAR(mu.inverse(mu(I)).value(), I, 4e-16 / mu.slope(I) + 4e-16);
}

/// Slopes from neighbours are of second order inside, so the curve is of third.
TEST(MonotoneCurve, TendsToTheLawItsPointsAreOf) {
  const auto law = [](double I) { return 0.35 + 0.5 * I / (1.0 + 1.4 * I); };
  const auto error = [&](int intervals) {
    std::vector<double> I, mu;
    for (int k = 0; k <= intervals; ++k) {
      I.push_back(0.6 * k / intervals);
      mu.push_back(law(I.back()));
    }
    const MonotoneCurve curve(I, mu);
    double largest = 0.0;
    for (double x = 0.1; x < 0.5; x += 1e-3)  // the ends have a slope of first order
      largest = std::max(largest, std::abs(curve(x) - law(x)));
    return largest;
  };
  EXPECT_GT(error(20) / error(40), 7.0);
  EXPECT_LT(error(20), 1e-5);
}

TEST(MonotoneCurve, DipIsRefusedWithTheIntervalWhereFrictionDoesNotRise) {
  const std::string dip = refusal({0.0, 0.01, 0.05, 0.1, 0.3}, {0.40, 0.38, 0.36, 0.37, 0.5});
  EXPECT_NE(dip.find("from I = 0 to 0.05: d mu / dI <= 0"), std::string::npos) << dip;
  const std::string two = refusal({0.0, 0.1, 0.2, 0.3, 0.4}, {0.3, 0.3, 0.4, 0.39, 0.5});
  EXPECT_NE(two.find("from I = 0 to 0.1 and from I = 0.2 to 0.3"), std::string::npos) << two;
}

TEST(MonotoneCurve, PairsThatAreNoCurveAreRefused) {
  EXPECT_NE(refusal({0.1}, {0.4}).find("two pairs"), std::string::npos);
  EXPECT_NE(refusal({0.1, 0.2}, {0.4}).find("2 of I and 1 of mu"), std::string::npos);
  EXPECT_NE(refusal({0.1, 0.1}, {0.4, 0.5}).find("pair 2"), std::string::npos);
  EXPECT_NE(refusal({-0.1, 0.1}, {0.4, 0.5}).find("pair 1"), std::string::npos);
  EXPECT_NE(refusal({0.1, NAN}, {0.4, 0.5}).find("pair 2"), std::string::npos);
}

MuPhi tabulated(std::vector<double> I, std::vector<double> mu, MuPhi law) {
  law.friction = {};
  law.friction.tabulated = std::make_shared<const MonotoneCurve>(std::move(I), std::move(mu));
  return law;
}

/// Pairs of mu = 0.353 + 0.6 I.
MuPhi tabulated_line(MuPhi law) {
  return tabulated({0.0, 0.07, 0.3, 0.9}, {0.353, 0.395, 0.533, 0.893}, std::move(law));
}

TEST(TabulatedFriction, PairsOfALineAreTheLinearLaw) {
  const GrainProperties grains{.stiffness = 4e3, .adhesion = 0.5};
  MuPhi linear = frictional_spheres();
  linear.friction = {.mu0 = 0.353, .beta = 0.6};
  const auto expected = steady_chute(table_of(linear), chute(24, 29, grains));
  const auto found = steady_chute(table_of(tabulated_line(linear)), chute(24, 29, grains));
  EXPECT_EQ(found.answer.outcome, Outcome::plug);
  EXPECT_NEAR(found.profile.plug_mass, expected.profile.plug_mass, 1e-12);
  EXPECT_NEAR(found.answer.condition_number, expected.answer.condition_number, 1e-10);
  for (std::size_t i = 0; i < expected.profile.rows.size(); ++i)
    EXPECT_NEAR(found.profile.rows[i].velocity,
                expected.profile.rows[i].velocity,
                1e-12 * expected.profile.surface_velocity);
}

/// Rigid grains have one I in the whole layer, that of mu = tan(theta).
TEST(TabulatedFriction, ChuteOfRigidGrainsHasBagnoldsProfileWithTheInertialNumberOfItsTilt) {
  const MuPhi law =
      tabulated({0.0, 0.1, 0.2, 0.6}, {0.30, 0.35, 0.50, 0.80}, incompressible_spheres());
  const double I = law.friction.tabulated->inverse(std::tan(24 * degree)).value();
  const auto profile = steady_chute(table_of(law), chute(24, 29)).profile;
  const double scale = 2.0 / 3.0 * I * std::sqrt(std::cos(24 * degree)) / 0.58;
  for (const auto& row : profile.rows)
    EXPECT_NEAR(row.velocity,
                scale * (std::pow(29.0, 1.5) - std::pow(row.mass_above, 1.5)),
                1e-13 * scale * std::pow(29.0, 1.5));
}

TEST(TabulatedFriction, RestsBelowItsFirstFrictionAndHasNoSteadyFlowAboveItsLast) {
  const RheologyTable table =
      table_of(tabulated({0.02, 0.1, 0.3}, {0.40, 0.45, 0.55}, incompressible_spheres()));
  const auto outcome = [&](double mu) {
    return steady_chute(table, chute(std::atan(mu) / degree, 29)).answer;
  };
  EXPECT_EQ(outcome(0.399).outcome, Outcome::arrested);
  EXPECT_EQ(outcome(0.401).outcome, Outcome::steady);
  EXPECT_EQ(outcome(0.549).outcome, Outcome::steady);
  EXPECT_EQ(outcome(0.551).outcome, Outcome::no_steady);
  EXPECT_NE(outcome(0.551).text.find("largest friction 0.55 "), std::string::npos);
}

TEST(TabulatedFriction, StartFromRestEndsInTheSteadyFlow) {
  const RheologyTable table = table_of(tabulated_line(frictional_spheres()));
  const auto run = start_from_rest(table, chute(24, 29));
  const double steady = steady_chute(table, chute(24, 29)).profile.surface_velocity;
  EXPECT_EQ(run.answer.outcome, Outcome::steady) << run.answer.text;
  EXPECT_NEAR(run.final_profile.surface_velocity, steady, 1e-4 * steady);  // grid
  const MuPhi late = tabulated({0.02, 0.9}, {0.36, 0.9}, frictional_spheres());
  EXPECT_THROW(start_from_rest(table_of(late), chute(24, 29)), TableError);
}

TEST(TabulatedFriction, ShearBandsAndSideWallsTakeTheLawItIsOf) {
  MuPhi linear = frictional_spheres();
  linear.friction = {.mu0 = 0.353, .beta = 0.6};
  const RheologyTable pairs = table_of(tabulated_line(linear));
  const PlaneShear flow{
      .drive = {.stress = 4.5}, .extent = {.height = 60.0}, .load = 10.0, .gravity = 1.0};
  const double band = shear_band(table_of(linear), {.flow = flow}).driving_velocity;
  EXPECT_NEAR(shear_band(pairs, {.flow = flow}).driving_velocity, band, 1e-10 * band);
  EXPECT_THROW(shear_band(pairs, {.flow = flow, .nonlocal_amplitude = 0.5}), TableError);
  ChuteCase walled = chute(26, 29);
  walled.walls = SideWalls{.width = 60.0, .friction = 0.2, .pressure_ratio = 1.0};
  const double walls = steady_chute(table_of(linear), walled).profile.surface_velocity;
  EXPECT_GT(walls, 0.0);
  // both march in the same steps, so only the rounding of the inverse is left, 1e-15 / I
  EXPECT_NEAR(steady_chute(pairs, walled).profile.surface_velocity, walls, 1e-11 * walls);
}

TEST(TabulatedFriction, HasTheCertificateOfTheLawItIsOf) {
  MuPhi linear = incompressible_spheres();
  linear.friction = {.mu0 = 0.353, .beta = 0.6};
  for (const double I : {0.02, 0.2, 0.7}) {
    const auto expected = well_posedness(table_of(linear), {.inertial_number = I});
    const auto found = well_posedness(table_of(tabulated_line(linear)), {.inertial_number = I});
    EXPECT_NEAR(found->margin, expected->margin, 1e-13);
  }
}

/// I of soft grains varies with depth and passes a pair, where the second derivative jumps. Panels
/// end at the rows at least: a jump of order one inside one of them leaves 1/12 of its share of the
/// layer to the third power.
TEST(TabulatedFriction, SteadyQuadratureHardlyFeelsThePairsThatAFlowPasses) {
  const MuPhi law = tabulated({0.0, 0.1, 0.2, 0.6}, {0.30, 0.35, 0.50, 0.80}, frictional_spheres());
  const ChuteCase soft = chute(24.5, 52.2, {.stiffness = 2e3});
  const SteadyOptions usual;
  const auto few = steady_chute(table_of(law), soft, usual).profile;
  const auto many = steady_chute(table_of(law), soft, {.panels = 20000}).profile;
  ASSERT_GT(few.rows.front().inertial_number, 0.2);
  ASSERT_LT(few.rows.back().inertial_number, 0.2);
  EXPECT_NEAR(few.surface_velocity,
              many.surface_velocity,
              std::pow(usual.rows - 1, -3.0) / 12.0 * many.surface_velocity);
}

}  // namespace
}  // namespace grainlaw::continuum
