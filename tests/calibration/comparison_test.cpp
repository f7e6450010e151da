#include "calibration/comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calibration/bagnold_fit.h"
#include "calibration/mu_phi_fit.h"
#include "support/calibration_checks.h"
#include "support/synthetic_chute.h"

namespace grainlaw::calibration {
namespace {

using continuum::Profile;
using continuum::ProfileRow;
using testing::failure;
using testing::local_data;
using testing::SyntheticChute;

constexpr double degree = std::numbers::pi / 180.0;

/// A prediction that says exactly what was measured, velocities times `factor`.
Profile profile_of(const dem::LocalData& data, double factor = 1.0) {
  Profile profile;
  for (const dem::LocalRow& row : data.rows) {
    profile.rows.push_back({.z = row.z,
                            .mass_above = row.mass_above,
                            .velocity = factor * row.velocity.value,
                            .shear_rate = factor * row.shear_rate.value,
                            .shear_stress = row.shear_stress.value,
                            .pressure = row.normal_stress.value,
                            .volume_fraction = row.volume_fraction.value});
  }
  profile.height = data.rows.back().z + 0.5;
  return profile;
}

TEST(SampleKind, IsDecidedByTheFittedTilts) {
  const std::vector<double> fitted{21 * degree, 25 * degree};
  EXPECT_EQ(sample_kind(21 * degree, fitted), SampleKind::in_sample);
  EXPECT_EQ(sample_kind(23 * degree, fitted), SampleKind::interpolation);
  EXPECT_EQ(sample_kind(26 * degree, fitted), SampleKind::extrapolation);
  EXPECT_EQ(sample_kind(20 * degree, fitted), SampleKind::extrapolation);
  EXPECT_EQ(sample_kind(23 * degree, {}), SampleKind::independent);
  EXPECT_EQ(name(SampleKind::in_sample), "in sample");
  EXPECT_EQ(name(SampleKind::interpolation), "interpolation");
  EXPECT_EQ(name(SampleKind::extrapolation), "extrapolation");
  EXPECT_EQ(name(SampleKind::leave_one_out), "left out");
  EXPECT_EQ(name(SampleKind::cross_geometry), "cross geometry");
  EXPECT_EQ(name(SampleKind::independent), "independent table");
}

TEST(ProfileError, IdenticalProfilesHaveNone) {
  const dem::LocalData data = local_data({.velocity_noise = 0.1});
  const ProfileError error = profile_error(data, profile_of(data));
  EXPECT_EQ(error.velocity.value, 0.0);
  EXPECT_EQ(error.velocity_maximum.value, 0.0);
  EXPECT_EQ(error.volume_fraction.value, 0.0);
  EXPECT_EQ(error.friction.value, 0.0);
  EXPECT_EQ(error.surface_velocity.value, 0.0);
  EXPECT_EQ(error.flux.value, 0.0);
  EXPECT_EQ(error.in_standard_errors, 0.0);
}

TEST(ProfileError, ScaledVelocityIsOffByItsFactorInEveryNorm) {
  const dem::LocalData data = local_data({.velocity_noise = 0.1});
  const ProfileError error = profile_error(data, profile_of(data, 1.05));
  EXPECT_NEAR(error.velocity.value, 0.05, 1e-12);
  EXPECT_NEAR(error.velocity_maximum.value, 0.05, 1e-12);
  EXPECT_NEAR(error.surface_velocity.value, 0.05, 1e-12);
  EXPECT_NEAR(error.flux.value, 0.05, 1e-12);
  EXPECT_EQ(error.volume_fraction.value, 0.0);
  EXPECT_EQ(error.friction.value, 0.0);
  const ProfileError slow = profile_error(data, profile_of(data, 0.95));
  EXPECT_NEAR(slow.surface_velocity.value, -0.05, 1e-12);
  EXPECT_NEAR(slow.flux.value, -0.05, 1e-12);
}

TEST(ProfileError, ScatterOfTheDemProfileIsItsStandardError) {
  // A prediction 5 % too fast: the surface error is u_p / u - 1, so its error is that of u, times
  // u_p / u^2, which the run itself states.
  const dem::LocalData data = local_data({.velocity_noise = 1.0, .frames = 240});
  const ProfileError error = profile_error(data, profile_of(data, 1.05));
  const dem::Estimate& surface = data.rows.back().velocity;
  const double expected = 1.05 * surface.error / surface.value;
  // An error from about n blocks is itself known to 1/sqrt(2n): 20 blocks, three times 16 %.
  EXPECT_NEAR(error.surface_velocity.error, expected, 0.5 * expected);
  EXPECT_GT(error.velocity.error, 0.0);
}

TEST(ProfileError, BaseLayerCountsAndSaltatingLayerDoesNot) {
  dem::LocalData data = local_data({.height = 20});
  data.rows.back().volume_fraction.value = 0.2;  // below half of the bulk
  data.rows.back().velocity.value = 1e6;
  const Profile exact = profile_of(local_data({.height = 20}));
  EXPECT_EQ(profile_error(data, exact).velocity.value, 0.0);
  data.rows.front().velocity.value = 1e6;  // z = -0.5, in the pockets
  EXPECT_EQ(profile_error(data, exact).velocity.value, 0.0);
  data.rows[1].velocity.value = 1.0;  // z = 0.5
  EXPECT_GT(profile_error(data, exact).velocity.value, 0.0);
}

TEST(ProfileError, PhiAndMuWithinReachOfTheSurfaceDoNotCountVelocityDoes) {
  dem::LocalData data = local_data({.height = 20});
  data.frames.kernel = {dem::KernelShape::lucy, 1.0};  // reaches 2
  const Profile exact = profile_of(local_data({.height = 20}));
  dem::LocalRow& high = data.rows[data.rows.size() - 2];  // z = 18.5, the surface is at 20
  high.volume_fraction.value *= 0.8;
  high.shear_stress.value *= 1.5;
  ProfileError error = profile_error(data, exact);
  EXPECT_EQ(error.volume_fraction.value, 0.0);
  EXPECT_EQ(error.friction.value, 0.0);
  EXPECT_EQ(error.velocity_top, 20.0);
  EXPECT_EQ(error.fraction_top, 18.0);
  high.velocity.value *= 2.0;
  EXPECT_GT(profile_error(data, exact).velocity.value, 0.0);
  data.rows[data.rows.size() - 3].volume_fraction.value *= 0.8;  // z = 17.5
  EXPECT_GT(profile_error(data, exact).volume_fraction.value, 0.0);
}

TEST(ProfileError, BandAndScatterAreGivenInTheNormOfTheError) {
  const dem::LocalData exact = local_data({});
  dem::LocalData data = exact;
  for (dem::LocalRow& row : data.rows) row.velocity.error = 0.02 * row.velocity.value;
  Profile predicted = profile_of(exact, 1.05);
  for (ProfileRow& row : predicted.rows) row.velocity_error = 0.03 * row.velocity / 1.05;
  const ProfileError error = profile_error(data, predicted);
  EXPECT_NEAR(error.statistics, 0.02, 1e-12);
  EXPECT_NEAR(error.law, 0.03, 1e-12);
  EXPECT_NEAR(velocity_distance(data, predicted, profile_of(exact)), 0.05, 1e-12);
}

TEST(ErrorBudget, TheRestIsWhatThePartsLeaveInSquares) {
  const ErrorBudget budget{
      .total = 0.13, .statistics = 0.03, .law = 0.04, .geometry = 0.0, .numerics = 0.0};
  EXPECT_NEAR(budget.rest(), 0.12, 1e-15);
  EXPECT_EQ((ErrorBudget{.total = 0.01, .statistics = 0.03}).rest(), 0.0);
}

TEST(ProfileError, NothingToCompareIsRefused) {
  EXPECT_NE(failure([] { profile_error(local_data({}), {}); }).find("no profile"),
            std::string::npos);
  dem::LocalData data = local_data({});
  data.rows.clear();
  EXPECT_NE(failure([&] { profile_error(data, profile_of(local_data({}))); }).find("no rows"),
            std::string::npos);
}

TEST(VelocityAt, IsAtRestBelowTheNoSlipHeightAndConstantAboveTheSurface) {
  const Profile profile{.rows = {{.z = 1.0, .velocity = 0.0}, {.z = 3.0, .velocity = 4.0}}};
  EXPECT_EQ(velocity_at(profile, 0.5), 0.0);
  EXPECT_EQ(velocity_at(profile, 2.0), 2.0);
  EXPECT_EQ(velocity_at(profile, 9.0), 4.0);
  EXPECT_EQ(velocity_at({}, 1.0), 0.0);
}

TEST(NaiveGuess, IsExactForBagnoldFlowsOfEqualCoefficient) {
  const SyntheticChute near{.no_slip_height = 0.0, .height = 20};
  const SyntheticChute target{.inclination = 25 * degree, .no_slip_height = 0.0, .height = 40};
  // With nothing in the pockets the masses are as the heights.
  dem::ChuteConditions wanted = testing::conditions_of(target);
  dem::LocalData nearest = local_data(near);
  nearest.conditions.mass_per_area = 20.0;
  wanted.mass_per_area = 40.0;
  const Profile guess = naive_guess(nearest, wanted);
  for (std::size_t k = 1; k < guess.rows.size(); ++k) {
    const dem::LocalRow exact = testing::exact_row(target, guess.rows[k].z);
    EXPECT_NEAR(guess.rows[k].velocity, exact.velocity.value, 1e-12 * exact.velocity.value);
    EXPECT_NEAR(guess.rows[k].shear_rate, exact.shear_rate.value, 1e-12 * exact.shear_rate.value);
    EXPECT_NEAR(
        guess.rows[k].shear_stress, exact.shear_stress.value, 1e-12 * exact.shear_stress.value);
  }
  EXPECT_NEAR(guess.height, 40.0, 1e-12);
}

TEST(NaiveGuess, OfARunForItselfIsItsOwnProfile) {
  const dem::LocalData data = local_data({.b = 5.0});
  const ProfileError error = profile_error(data, naive_guess(data, data.conditions));
  EXPECT_NEAR(error.velocity.value, 0.0, 1e-14);
  EXPECT_NEAR(error.flux.value, 0.0, 1e-14);
}

TEST(Calibration, BagnoldTablePredictsTheRunItWasFittedTo) {
  // Law, density, mass and base of the table are those of the run: what remains is the linear
  // interpolation between the 101 rows of the prediction, u'' h^2 / 8 with h = 0.4 and u'' = gd /
  // (2 depth): at half depth 0.01 gd / 20 = 2e-5 u, more against the small u near the base.
  const dem::LocalData data = local_data({.b = 5.0});
  const continuum::SteadyChute steady =
      continuum::steady_chute(fit_bagnold(data).table, chute_case(data.conditions));
  ASSERT_EQ(steady.answer.outcome, continuum::Outcome::steady) << steady.answer.text;
  EXPECT_LT(profile_error(data, steady.profile).velocity.value, 1e-4);
}

TEST(Calibration, MuPhiTablePredictsAChuteItWasNotFittedTo) {
  const double mu0 = 0.353, beta = 0.5, phi0 = 0.6, I_phi = 5.4;
  const auto run = [&](double tilt, int height) {
    const double inclination = tilt * degree;
    const double I = continuum::inertial_number_of(mu0, beta, 0.0, std::tan(inclination));
    return local_data({.name = std::to_string(tilt),
                       .inclination = inclination,
                       .a = testing::bagnold_coefficient(I, inclination),
                       .volume_fraction = continuum::inertial_volume_fraction(phi0, I_phi, I),
                       .height = height});
  };
  const std::vector<dem::LocalData> fitted{run(21, 30), run(23, 30), run(25, 30)};
  const dem::LocalData other = run(24, 45);
  const continuum::SteadyChute steady =
      continuum::steady_chute(fit_mu_phi(fitted).table, chute_case(other.conditions));
  ASSERT_EQ(steady.answer.outcome, continuum::Outcome::steady) << steady.answer.text;
  const ProfileError error = profile_error(other, steady.profile);
  // The mass below the no-slip height is a mean over runs whose phi differ by up to 0.03, that is
  // by 1.1 * 0.03 rho_p d of the 26 that flow; u goes with its power 1.5. Half of it from the
  // middle.
  const double allowed = 0.5 * 1.5 * 1.1 * 0.03 / 26.0;
  EXPECT_LT(error.velocity.value, allowed);
  EXPECT_NEAR(error.flux.value, 0.0, allowed);
}

}  // namespace
}  // namespace grainlaw::calibration
