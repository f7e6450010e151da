#include "continuum/steady_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "continuum/bracket.h"
#include "continuum/thin_layer.h"
#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

constexpr double phi = 0.58;  // of incompressible_spheres

/// I of a rigid layer at this tilt.
double inertial_number(const MuPhi& law, double tilt) {
  return inertial_number_of(law.friction, std::tan(tilt));
}

/// Of uniform I and phi: Q = int M |du/dM| dM with du/dM = I sqrt(M cos(theta)) / phi.
double exact_flow(double I, double tilt, double volume_fraction, double mass) {
  return 0.4 * I * std::sqrt(std::cos(tilt)) / volume_fraction * std::pow(mass, 2.5);
}

RheologyTable rigid_table() {
  auto table = table_of(incompressible_spheres());
  table.range.inertial_number = Range{0.005, 0.25};
  return table;
}

TEST(SteadySearch, FindsTheExactMassOfAFlow) {
  const double tilt = 24 * degree;
  const double I = inertial_number(incompressible_spheres(), tilt);
  for (const double flow : {1e-6, 1.0, 1e3, 1e9}) {
    const auto found =
        find_chute(rigid_table(), {.chute = {}, .inclination = tilt, .mass_flow = flow});
    // the search ends at 1e-13 of the flow, the quadrature of the flow at 1e-13
    EXPECT_NEAR(exact_flow(I, tilt, phi, found.chute.mass_per_area) / flow, 1.0, 1e-12) << flow;
    EXPECT_NEAR(found.mass_flow / flow, 1.0, 1e-12);
  }
}

TEST(SteadySearch, AFlowBeyondEveryLayerThatIsTriedIsToldSo) {
  const auto why = [](double flow) {
    try {
      find_chute(rigid_table(), {.chute = {}, .inclination = 24 * degree, .mass_flow = flow});
    } catch (const NoSuchFlow& missing) {
      return std::string(missing.what());
    }
    return std::string("found");
  };
  EXPECT_EQ(why(1e300), "that of a layer 1e+15 d deep, and no deeper one is tried");
  EXPECT_EQ(why(1e-300),
            "that of a layer of 1e-12 rho_p d above the base, and no thinner one is tried");
}

TEST(SteadySearch, FindsTheExactTiltOfAFlow) {
  const double tilt = 24 * degree;
  const double I = inertial_number(incompressible_spheres(), tilt);
  const double flow = exact_flow(I, tilt, phi, 30.0);
  const auto of_mass =
      find_chute(rigid_table(), {.chute = {}, .mass_per_area = 30.0, .mass_flow = flow});
  const auto of_depth =
      find_chute(rigid_table(), {.chute = {}, .depth = 30.0 / phi, .mass_flow = flow});
  EXPECT_NEAR(of_mass.chute.inclination, tilt, 1e-12);
  EXPECT_NEAR(of_depth.chute.inclination, tilt, 1e-9);  // its depth is found to 1e-9 at worst
  EXPECT_NEAR(of_depth.chute.mass_per_area, 30.0, 1e-7);
}

/// All that a chute can have, and each alone.
std::vector<std::pair<RheologyTable, ChuteCase>> every_kind() {
  RheologyTable table = table_of(frictional_spheres());
  const auto soft = chute(24, 40.0, {.stiffness = 2e4});
  const auto cohesive = chute(26, 40.0, {.adhesion = 0.5});
  auto walled = chute(24, 30.0);
  walled.walls = SideWalls{.width = 200.0, .friction = 0.3};
  auto all = chute(28, 40.0, {.stiffness = 2e5, .adhesion = 0.2});
  all.walls = SideWalls{.width = 300.0, .friction = 0.3};
  all.slip_length = 0.5;
  auto based = table;
  based.base = EffectiveBase{.no_slip_height = 1.1, .mass_below = 0.6, .recipe = {}};
  return {
      {table, soft}, {table, cohesive}, {table, walled}, {based, chute(24, 20.0)}, {based, all}};
}

TEST(SteadySearch, EveryQuestionLeadsBackToTheSameFlow) {
  for (const auto& [table, known] : every_kind()) {
    const auto start = find_chute(
        table,
        {.chute = known, .inclination = known.inclination, .mass_per_area = known.mass_per_area});
    ASSERT_TRUE(flows(start.steady.answer.outcome)) << start.steady.answer.text;
    const double depth = start.steady.profile.height;
    const std::vector<ChuteQuestion> questions = {
        {.chute = known, .inclination = known.inclination, .depth = depth},
        {.chute = known, .inclination = known.inclination, .mass_flow = start.mass_flow},
        {.chute = known, .mass_per_area = known.mass_per_area, .mass_flow = start.mass_flow},
        {.chute = known, .depth = depth, .mass_flow = start.mass_flow}};
    for (const ChuteQuestion& question : questions) {
      const auto found = find_chute(table, question);
      // found to 1e-9 of depth and flow; both change by at least their own size over a radian
      EXPECT_NEAR(found.chute.inclination, known.inclination, 1e-8);
      EXPECT_NEAR(found.chute.mass_per_area / known.mass_per_area, 1.0, 1e-8);
      EXPECT_NEAR(found.mass_flow / start.mass_flow, 1.0, 1e-8);
    }
  }
}

TEST(SteadySearch, RigidLayerOfAGivenMassIsEndedByTheDataAlone) {
  auto table = table_of(frictional_spheres());
  table.range.inertial_number = Range{0.005, 0.25};
  const auto law = frictional_spheres();
  const auto largest = largest_flow(table, {.chute = {}, .mass_per_area = 30.0});
  EXPECT_TRUE(largest.ended_by_data);
  EXPECT_FALSE(largest.law);
  EXPECT_EQ(largest.law_end, Outcome::no_dense_state);
  EXPECT_NEAR(std::tan(largest.found.chute.inclination), friction(law, 0.25), 1e-9);
  EXPECT_NEAR(std::tan(largest.law_limit), friction(law, law.volume_fraction.I_phi), 1e-9);
}

TEST(SteadySearch, LayerOfAGivenDepthCarriesMostWhereThinningOutweighsSpeed) {
  const auto law = frictional_spheres();
  const auto largest = largest_flow(table_of(law), {.chute = {}, .depth = 40.0});
  ASSERT_TRUE(largest.law);
  EXPECT_FALSE(largest.ended_by_data);
  const double tilt = largest.found.chute.inclination;
  const double I = inertial_number(law, tilt);
  // Q ~ I phi^(3/2) sqrt(cos(theta)) and phi ~ 1 - I/I_phi: d ln Q / d theta vanishes
  const double dI = 1e-6 * I;
  const double slope = (friction(law, I + dI) - friction(law, I - dI)) / (2.0 * dI);
  const double cosine = std::cos(tilt);
  const double by_I = 1.0 / I - 1.5 / (law.volume_fraction.I_phi - I) -
                      0.5 * std::tan(tilt) * slope * cosine * cosine;
  // a maximum is found to the root of the rounding of its value, 1e-13
  EXPECT_NEAR(by_I * I, 0.0, 1e-4);
  EXPECT_THROW(
      find_chute(table_of(law),
                 {.chute = {}, .depth = 40.0, .mass_flow = 1.001 * largest.law->mass_flow}),
      NoSuchFlow);
  const auto below = find_chute(
      table_of(law), {.chute = {}, .depth = 40.0, .mass_flow = 0.999 * largest.law->mass_flow});
  EXPECT_LT(below.chute.inclination, tilt);
}

TEST(SteadySearch, SoftGrainsHaveAGreatestDepth) {
  auto table = table_of(frictional_spheres());
  table.range.inertial_number = Range{0.005, 0.5};
  const auto law = frictional_spheres();
  const double tilt = 24 * degree;
  const auto largest =
      largest_flow(table, {.chute = {.grains = {.stiffness = 2e4}}, .inclination = tilt});
  EXPECT_TRUE(largest.ended_by_data);
  EXPECT_NEAR(largest.found.steady.profile.rows.front().inertial_number, 0.5, 1e-9);
  // tan(theta) = mu(I_phi) (1 - sqrt(p d / (k_n p_mu))) at the base
  const double root = 1.0 - std::tan(tilt) / friction(law.friction, law.volume_fraction.I_phi);
  const double pressure = 2e4 * law.softness_friction->p_mu * root * root;
  EXPECT_NEAR(largest.law_limit * std::cos(tilt) / pressure, 1.0, 1e-9);
  EXPECT_THROW(largest_flow(table, {.chute = {}, .inclination = tilt}), NoSuchFlow);
}

TEST(SteadySearch, SideWallsLimitTheFlowOfAnyDepth) {
  auto walled = chute(24, 1.0);
  walled.walls = SideWalls{.width = 60.0, .friction = 0.3};
  const auto table = table_of(frictional_spheres());
  const auto largest = largest_flow(table, {.chute = walled, .inclination = walled.inclination});
  ASSERT_TRUE(largest.law);
  walled.mass_per_area = 4.0 * largest.law_limit;
  const auto deeper = steady_chute(table, walled);
  EXPECT_NEAR(largest.law->mass_flow / std::abs(deeper.profile.flux), 1.0, 1e-6);  // of the march
  EXPECT_THROW(find_chute(table,
                          {.chute = walled,
                           .inclination = walled.inclination,
                           .mass_flow = 1.01 * largest.law->mass_flow}),
               NoSuchFlow);
}

TEST(SteadySearch, SaysWhyNothingFlows) {
  const auto table = table_of(frictional_spheres());
  const ChuteQuestion flat{.chute = {}, .inclination = 15 * degree, .mass_flow = 1.0};
  try {
    find_chute(table, flat);
    FAIL() << "a layer below its repose cannot carry anything";
  } catch (const NoSuchFlow& missing) {
    EXPECT_FALSE(missing.nearest);
    EXPECT_NE(std::string(missing.what()).find("rests"), std::string::npos) << missing.what();
  }
  const ChuteCase held{.grains = {.adhesion = 1e6}};
  EXPECT_THROW(largest_flow(table, {.chute = held, .mass_per_area = 10.0}), NoSuchFlow);
}

TEST(SteadySearch, BagnoldTableIsNotAskedForATilt) {
  const auto table = table_of(bagnold_at_24_degrees(1.0, 0.3, 0.0));
  EXPECT_THROW(find_chute(table, {.chute = {}, .mass_per_area = 30.0, .mass_flow = 10.0}),
               std::invalid_argument);
  EXPECT_THROW(largest_flow(table, {.chute = {}, .depth = 30.0}), std::invalid_argument);
  const auto found =
      find_chute(table, {.chute = {}, .inclination = 24 * degree, .mass_flow = 10.0});
  EXPECT_NEAR(found.mass_flow, 10.0, 1e-10);
}

TEST(SteadySearch, ErrorOfTheMassFoundIsThatOfTheExactSolution) {
  auto table = table_of(incompressible_spheres());
  const double error = 1e-3;
  table.covariance = Covariance{{"mu0"}, {error * error}};
  const double tilt = 24 * degree;
  const auto find = [&](const RheologyTable& moved) {
    return find_chute(moved, {.chute = {}, .inclination = tilt, .mass_flow = 500.0});
  };
  const auto errors = search_errors(table, find);
  ASSERT_TRUE(errors);
  // M ~ I^(-2/5), I = e / (beta - kappa e), e = tan(theta) - mu0
  const auto friction = incompressible_spheres().friction;
  const double e = std::tan(tilt) - friction.mu0;
  const double rest = friction.beta - friction.kappa * e;
  const double relative = 0.4 * friction.beta / (rest * e) * error;
  const double mass = find(table).chute.mass_per_area;
  EXPECT_NEAR(errors->mass_per_area / (mass * relative), 1.0, 1e-3);  // of the finite differences
  EXPECT_NEAR(errors->mass_flow / 500.0, 0.0, 1e-9);
  EXPECT_EQ(errors->inclination, 0.0);
}

TEST(SteadySearch, ErrorsOfALayerThatIsGivenAreThoseOfItsBand) {
  auto table = table_of(frictional_spheres());
  table.covariance = Covariance{{"mu0", "beta"}, {1e-6, -1e-6, -1e-6, 1e-4}};
  const auto given = chute(24, 30.0, {.stiffness = 2e5});
  const auto find = [&](const RheologyTable& moved) {
    return find_chute(
        moved,
        {.chute = given, .inclination = given.inclination, .mass_per_area = given.mass_per_area});
  };
  const auto errors = search_errors(table, find);
  ASSERT_TRUE(errors);
  auto steady = steady_chute(table, given);
  add_error_band(steady, table, given);
  const auto& surface = steady.profile.rows.back();
  EXPECT_NEAR(errors->surface_velocity / surface.velocity_error, 1.0, 1e-9);
  EXPECT_EQ(errors->mass_per_area, 0.0);
}

TEST(SteadySearch, DataEndTheFlowOverTiltsWithOrWithoutAskingTheLaw) {
  auto table = table_of(frictional_spheres());
  table.range.inertial_number = Range{0.005, 0.25};
  const ChuteQuestion question{.chute = chute(0, 1.0, {.stiffness = 2e4}), .depth = 30.0};
  const auto largest = largest_flow(table, question);
  EXPECT_NEAR(end_of_data(table, question).mass_flow / largest.found.mass_flow, 1.0, 1e-8);
}

TEST(ThinLayer, StopDepthIsThatOfTheNonlocalFluidity) {
  const MuPhi glass{.friction = saturating_friction(0.3819, 0.6435, 0.279),
                    .volume_fraction = {.phi0 = 0.6, .I_phi = INFINITY}};
  const auto table = table_of(glass);
  for (const auto& [tilt, stop] :
       {std::pair{21.5, 6.7201}, {23.0, 3.3436}, {25.0, 2.1359}, {28.0, 1.2734}}) {
    const auto layer = chute(tilt, 0.6 * 3.0);
    const auto thin = thin_layer(table, layer, steady_chute(table, layer).profile);
    ASSERT_TRUE(thin);
    EXPECT_NEAR(thin->stop_depth, stop, 5e-5);  // the last digit given
    EXPECT_NEAR(thin->flowing_depth, 3.0, 1e-12);
    EXPECT_EQ(thin->thin(), stop > 3.0);
  }
}

TEST(Bracket, FindsRootsEdgesAndPeaks) {
  const auto cubic = root([](double x) { return x * x * x - 2.0; }, {.low = 0.0, .high = 4.0});
  EXPECT_NEAR(cubic.nearest(), std::cbrt(2.0), 1e-13);
  EXPECT_NEAR(split([](double x) { return x < 0.3; }, 0.0, 1.0).low, 0.3, 1e-12);
  EXPECT_NEAR(golden_section([](double x) { return -std::pow(x - 0.7, 2); }, 0.0, 1.0, 1.0),
              0.7,
              1e-7);  // the root of the rounding
}

}  // namespace
}  // namespace grainlaw::continuum
