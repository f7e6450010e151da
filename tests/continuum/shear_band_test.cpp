#include "continuum/shear_band.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

/// Linear mu(I) at constant phi: closed forms exist.
MuPhi linear_law() {
  return {.friction = {.mu0 = 0.35, .beta = 1.2},
          .volume_fraction = {.phi0 = 0.6, .I_phi = INFINITY}};
}

ShearBandCase plane_shear(WallDrive drive, double gravity = 0.0, double height = 60.0) {
  return {.flow = PlaneShear{
              .drive = drive, .extent = {.height = height}, .load = 10.0, .gravity = gravity}};
}

TEST(PlaneShear, WithoutGravityTheVelocityIsLinearAndTheLawSetsTheStress) {
  const auto band = shear_band(table_of(frictional_spheres()), plane_shear({.velocity = 30.0}));
  const double I = 30.0 / 60.0 / std::sqrt(10.0);
  const double mu = 0.3530 + (0.7148 - 0.3530) * I / (I + 0.7184);
  EXPECT_EQ(band.answer.outcome, Outcome::steady);
  EXPECT_NEAR(band.driving_stress, 10.0 * mu, 1e-11 * 10.0 * mu);
  for (const auto& row : band.profile.rows) {
    EXPECT_NEAR(row.velocity, 30.0 * row.z / 60.0, 1e-11 * 30.0);
    EXPECT_NEAR(row.volume_fraction, 0.595 * (1.0 - I / 5.383), 1e-11);
  }
  EXPECT_FALSE(band.local_band_collapse);
}

/// mu = mu0 + beta I: gd = (tau - mu0 p) / (beta sqrt(p)), integrated over p = load + rho g y.
TEST(PlaneShear, UnderGravityTheBandEndsWhereThePressureHoldsTheStress) {
  const double tau = 4.5, mu0 = 0.35, beta = 1.2, rho_g = 0.6;
  const double edge_pressure = tau / mu0;
  const auto primitive = [&](double p) {
    return (2.0 * tau * std::sqrt(p) - 2.0 / 3.0 * mu0 * std::pow(p, 1.5)) / (beta * rho_g);
  };
  const auto band = shear_band(table_of(linear_law()), plane_shear({.stress = tau}, 1.0));
  EXPECT_NEAR(band.yielded_width, (edge_pressure - 10.0) / rho_g, 1e-12 * 60.0);
  const double exact = primitive(edge_pressure) - primitive(10.0);
  EXPECT_NEAR(band.driving_velocity, exact, 2.0 * band.discretisation_error * exact);
  EXPECT_LT(band.discretisation_error, 2e-6);
  for (const auto& row : band.profile.rows)
    if (row.z < 60.0 - band.yielded_width) {
      EXPECT_EQ(row.shear_rate, 0.0);  // no creep
    }
}

/// tau = tau_i (R_i/r)^2, so r gd is elementary: omega(R_i) R_i in closed form.
TEST(AnnularShear, HasTheClosedFormOfALinearLaw) {
  const double inner = 50.0, p = 10.0, tau = 4.5, mu0 = 0.35, beta = 1.2;
  const double edge = inner * std::sqrt(tau / (mu0 * p));
  const auto band = shear_band(
      table_of(linear_law()),
      {.flow = AnnularShear{
           .drive = {.stress = tau}, .inner_radius = inner, .outer_radius = 110.0, .pressure = p}});
  const auto primitive = [&](double r) {  // of gd / r = (tau_i R_i^2/r^3 - mu0 p/r)/(beta sqrt(p))
    return (-0.5 * tau * inner * inner / (r * r) - mu0 * p * std::log(r)) / (beta * std::sqrt(p));
  };
  const double exact = inner * (primitive(edge) - primitive(inner));
  EXPECT_NEAR(band.yielded_width, edge - inner, 2e-5 * edge);  // linear interpolation of tau(r)
  EXPECT_NEAR(band.driving_velocity, exact, 2.0 * band.discretisation_error * exact);
  EXPECT_LT(band.discretisation_error, 4e-6);
}

/// Constant phi: tau = rho F L/(2 pi) cos(2 pi y/L); linear law: gd = (tau - mu0 p)/(beta sqrt p).
TEST(BodyForceBox, HasTheClosedFormOfALinearLaw) {
  const double L = 40.0, F = 1.2, p = 10.0, mu0 = 0.35, beta = 1.2, k = 2.0 * std::numbers::pi / L;
  const auto band =
      shear_band(table_of(linear_law()),
                 {.flow = BodyForceBox{.extent = {.height = L}, .amplitude = F, .pressure = p}});
  const double peak = 0.6 * F / k;
  const double edge = std::acos(mu0 * p / peak) / k;
  const double exact = (peak / k * std::sin(k * edge) - mu0 * p * edge) / (beta * std::sqrt(p));
  // sums of midpoint values of sin: 1 + (k h)^2/24, h = L/1600
  EXPECT_NEAR(band.driving_stress, peak, 1e-6 * peak);
  EXPECT_NEAR(band.yielded_width, 2.0 * edge, 2e-4 * edge);
  EXPECT_NEAR(band.driving_velocity, exact, 3.0 * band.discretisation_error * exact);
  EXPECT_LT(band.discretisation_error, 1e-4);
}

TEST(BodyForceBox, ProfileIsPeriodicAndItsMeanVelocityVanishes) {
  const auto band =
      shear_band(table_of(frictional_spheres()),
                 {.flow = BodyForceBox{
                      .extent = {.mass_per_area = 24.0}, .amplitude = 1.3, .pressure = 10.0}});
  const auto& rows = band.profile.rows;
  ASSERT_EQ(band.answer.outcome, Outcome::steady);
  EXPECT_NEAR(rows.front().mass_above, 24.0, 1e-12 * 24.0);
  EXPECT_NEAR(rows.back().mass_above, 0.0, 1e-12 * 24.0);
  EXPECT_NEAR(rows.back().z, band.profile.height, 1e-12 * band.profile.height);
  EXPECT_NEAR(rows.front().shear_stress, rows.back().shear_stress, 1e-12 * 10.0);
  double momentum = 0.0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_GT(rows[i].z, rows[i - 1].z);
    momentum += 0.5 * (rows[i].velocity + rows[i - 1].velocity) *
                (rows[i - 1].mass_above - rows[i].mass_above);
  }
  EXPECT_NEAR(momentum, 0.0, 1e-10 * 24.0 * band.driving_velocity);
}

TEST(LocalBand, ThinsWithoutLimitAsTheWallSlowsAndSaysSo) {
  double before = INFINITY;
  for (const double velocity : {10.0, 1e-1, 1e-3, 1e-5}) {
    const auto band = shear_band(table_of(linear_law()), plane_shear({.velocity = velocity}, 1.0));
    EXPECT_NEAR(band.driving_velocity, velocity, 1e-11 * velocity);
    EXPECT_LT(band.yielded_width, before);
    EXPECT_EQ(band.local_band_collapse, band.yielded_width < 5.0);
    before = band.yielded_width;
  }
  // near the edge gd grows with the distance from it: the velocity is its square, w ~ sqrt(V)
  EXPECT_LT(before, 0.02);
}

TEST(NonlocalBand, KeepsAFiniteWidthAsTheWallSlows) {
  for (const double velocity : {1e-2, 1e-4, 1e-6}) {
    auto slow = plane_shear({.velocity = velocity}, 1.0);
    slow.nonlocal_amplitude = 0.48;
    const auto band = shear_band(table_of(linear_law()), slow);
    EXPECT_EQ(band.answer.outcome, Outcome::steady) << band.answer.text;
    EXPECT_GT(band.band_width, 3.0);
    EXPECT_LT(band.band_width, 8.0);
    EXPECT_FALSE(band.local_band_collapse);
  }
}

TEST(NonlocalBand, NeedsMoreStressThanTheLocalLawToFlow) {
  auto weak = plane_shear({.stress = 3.6}, 1.0);
  EXPECT_EQ(shear_band(table_of(linear_law()), weak).answer.outcome, Outcome::steady);
  weak.nonlocal_amplitude = 0.48;
  const auto band = shear_band(table_of(linear_law()), weak);
  EXPECT_EQ(band.answer.outcome, Outcome::arrested);
  EXPECT_NE(band.answer.text.find("only rest"), std::string::npos);
}

/// mu passes mu_s inside some cell at every stress: nothing jumps there. Velocity is smooth in the
/// stress, so its third differences vanish like the step cubed.
TEST(NonlocalBand, YieldInsideACellLeavesNoTrace) {
  std::vector<double> velocity;
  for (int k = 0; k < 4; ++k) {
    auto band = plane_shear({.stress = 4.5 + 0.01 * k}, 1.0);
    band.nonlocal_amplitude = 0.48;
    velocity.push_back(shear_band(table_of(linear_law()), band).driving_velocity);
  }
  const double first = velocity[1] - velocity[0];
  const double third = velocity[3] - 3.0 * velocity[2] + 3.0 * velocity[1] - velocity[0];
  EXPECT_LT(std::abs(third), 1e-4 * first);
}

/// xi far above the gap: g is uniform, and the mean of its gain decides. xi far below a cell: the
/// local law. Both run.
TEST(NonlocalBand, RunsForAnyCooperativityLength) {
  const auto outcome = [](double amplitude, double stress) {
    auto band = plane_shear({.stress = stress}, 1.0, 6.0);
    band.nonlocal_amplitude = amplitude;
    return shear_band(table_of(linear_law()), band);
  };
  // tau / p falls from stress / 10 to stress / 13.6 through the gap, the mean of its excess over
  // mu0 = 0.35 is stress ln(1.36) / 3.6 - 0.35
  EXPECT_EQ(outcome(1e3, 4.0).answer.outcome, Outcome::arrested);
  EXPECT_EQ(outcome(1e3, 4.2).answer.outcome, Outcome::steady);
  const double local = outcome(0.0, 4.2).driving_velocity;
  EXPECT_NEAR(outcome(1e-5, 4.2).driving_velocity, local, 1e-4 * local);
}

TEST(NonlocalBand, OfSoftOrCohesiveGrainsIsCalledExperimental) {
  auto band = plane_shear({.stress = 4.0}, 1.0);
  band.nonlocal_amplitude = 0.48;
  const auto rigid = shear_band(table_of(frictional_spheres()), band);
  EXPECT_EQ(rigid.answer.text.find("experimental"), std::string::npos) << rigid.answer.text;
  band.grains.stiffness = 1e5;
  const auto soft = shear_band(table_of(frictional_spheres()), band);
  EXPECT_NE(soft.answer.text.find("experimental"), std::string::npos) << soft.answer.text;
}

TEST(ShearBand, ExtremeDrivesEndInTypedAnswers) {
  const auto outcome = [](const MuPhi& law, const ShearBandCase& band) {
    return shear_band(table_of(law), band).answer.outcome;
  };
  const MuPhi spheres = frictional_spheres();  // mu0 .353, mu_inf .7148, I_phi 5.383: mu .6722
  EXPECT_EQ(outcome(spheres, plane_shear({.stress = 3.5})), Outcome::arrested);
  EXPECT_EQ(outcome(spheres, plane_shear({.stress = 3.54})), Outcome::steady);
  EXPECT_EQ(outcome(spheres, plane_shear({.stress = 6.8})), Outcome::no_dense_state);
  EXPECT_EQ(outcome(spheres, plane_shear({.stress = 7.2})), Outcome::no_steady);
  EXPECT_EQ(outcome(spheres, plane_shear({.velocity = 1e4})), Outcome::no_dense_state);
  const MuPhi coulomb{.friction = {.mu0 = 0.4},
                      .volume_fraction = {.phi0 = 0.6, .I_phi = INFINITY}};
  EXPECT_EQ(outcome(coulomb, plane_shear({.velocity = 1.0})), Outcome::no_steady);
  EXPECT_EQ(outcome(coulomb, plane_shear({.stress = 3.9})), Outcome::arrested);
  auto nonlocal = plane_shear({.stress = 7.2});
  nonlocal.nonlocal_amplitude = 0.48;
  EXPECT_EQ(outcome(spheres, nonlocal), Outcome::no_steady);
  auto soft = plane_shear({.velocity = 1.0});
  soft.grains.stiffness = 20.0;  // p* = 0.5 > p_mu = 0.39
  EXPECT_EQ(outcome(spheres, soft), Outcome::no_steady);
}

TEST(ShearBand, IsTheSameInSiUnits) {
  const double d = 2e-3, rho = 2500.0, g = 9.81;
  const double time = std::sqrt(d / g), stress = rho * g * d;
  auto plain = plane_shear({.velocity = 3.0}, 1.0);
  plain.grains = {.stiffness = 1e5, .adhesion = 2.0};
  const ShearBandCase si{.flow = PlaneShear{.drive = {.velocity = 3.0 * d / time},
                                            .extent = {.height = 60.0 * d},
                                            .load = 10.0 * stress,
                                            .gravity = g},
                         .grains = {.diameter = d,
                                    .density = rho,
                                    .stiffness = 1e5 * stress * d,
                                    .adhesion = 2.0 * stress * d * d}};
  for (const double A : {0.0, 0.48}) {
    auto one = plain, other = si;
    one.nonlocal_amplitude = other.nonlocal_amplitude = A;
    const auto table = table_of(frictional_spheres());
    const auto a = shear_band(table, one), b = shear_band(table, other);
    EXPECT_NEAR(b.driving_stress / stress, a.driving_stress, 1e-10 * a.driving_stress);
    EXPECT_NEAR(b.band_width / d, a.band_width, 1e-10 * 60.0);
  }
}

/// In uniform plane shear tau = p mu(I) at a given speed: d tau = p (d mu0 + I d beta).
TEST(ShearBand, CarriesTheCovarianceOfTheTableThrough) {
  auto table = table_of(linear_law());
  table.covariance = Covariance{{"mu0", "beta"}, {1e-4, -2e-4, -2e-4, 9e-4}};
  const auto question = plane_shear({.velocity = 30.0});
  auto band = shear_band(table, question);
  add_error(band, table, question);
  const double I = 0.5 / std::sqrt(10.0);
  const double exact = 10.0 * std::sqrt(1e-4 - 2.0 * 2e-4 * I + 9e-4 * I * I);
  EXPECT_NEAR(band.error, exact, 1e-6 * exact);  // rounding 1e-12 over a step of 1e-2 errors
}

TEST(ShearBand, CountsTheRangeOnlyWhereItShears) {
  auto table = table_of(linear_law());
  table.range.inertial_number = Range{0.0, 0.01};
  const auto fast = shear_band(table, plane_shear({.stress = 4.5}, 1.0));
  ASSERT_FALSE(fast.answer.out_of_domain.empty());
  EXPECT_EQ(fast.answer.out_of_domain.front().quantity, "I");
  table.range.inertial_number = Range{0.0, 0.2};
  EXPECT_TRUE(shear_band(table, plane_shear({.stress = 4.5}, 1.0)).answer.out_of_domain.empty());
}

TEST(ShearBand, RefusesWhatHasNoMeaning) {
  const auto table = table_of(linear_law());
  EXPECT_THROW(
      shear_band(table_of(bagnold_at_24_degrees(1.3, 0.8, 0.0)), plane_shear({.stress = 4})),
      TableError);
  auto power_law = linear_law();
  power_law.friction.exponent = 0.8;
  ShearBandCase nonlocal = plane_shear({.stress = 4.0});
  nonlocal.nonlocal_amplitude = 0.48;
  EXPECT_THROW(shear_band(table_of(power_law), nonlocal), TableError);
  EXPECT_THROW(shear_band(table, plane_shear({})), std::invalid_argument);
  EXPECT_THROW(shear_band(table, plane_shear({.velocity = 1.0, .stress = 4.0})),
               std::invalid_argument);
  EXPECT_THROW(shear_band(table, plane_shear({.velocity = -1.0})), std::invalid_argument);
  EXPECT_THROW(shear_band(table,
                          {.flow = AnnularShear{.drive = {.stress = 4.0},
                                                .inner_radius = 50.0,
                                                .outer_radius = 40.0,
                                                .pressure = 10.0}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace grainlaw::continuum
