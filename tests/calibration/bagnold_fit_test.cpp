#include "calibration/bagnold_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "support/calibration_checks.h"
#include "support/synthetic_chute.h"

namespace grainlaw::calibration {
namespace {

using testing::Coverage;
using testing::failure;
using testing::local_data;
using testing::mentions;
using testing::SyntheticChute;

const continuum::GeneralisedBagnold& law_of(const BagnoldFit& fit) {
  return std::get<continuum::GeneralisedBagnold>(fit.table.law);
}

double shear_rate_at_half_mass(const SyntheticChute& chute) {
  const double mass = testing::conditions_of(chute).mass_per_area;
  return continuum::bagnold_shear_rate(chute.a, chute.b, 0.5 * mass * std::sin(chute.inclination));
}

TEST(BagnoldFit, ExactProfileGivesBackItsCoefficients) {
  const SyntheticChute chute{.a = 26.0, .b = 5.0, .no_slip_height = 1.1};
  const BagnoldFit fit = fit_bagnold(local_data(chute));
  EXPECT_NEAR(law_of(fit).a, 26.0, 1e-8 * 26.0);
  EXPECT_NEAR(law_of(fit).b, 5.0, 1e-8 * 5.0);
  EXPECT_NEAR(fit.table.base->no_slip_height, 1.1, 1e-8);
  // Grains in the pockets below z = 0 and the layer between z = 0 and the no-slip height.
  EXPECT_NEAR(fit.table.base->mass_below, testing::pocket_fraction + 0.58 * 1.1, 1e-8);
  const double ratio = 5.0 / (26.0 * shear_rate_at_half_mass(chute));
  EXPECT_NEAR(fit.ratio_mid_depth.value, ratio, 1e-8);
}

TEST(BagnoldFit, TableSaysWhereItHoldsAndWhereItComesFrom) {
  const dem::LocalData data = local_data({.b = 5.0, .velocity_noise = 0.1});
  const continuum::RheologyTable table = fit_bagnold(data).table;
  EXPECT_NO_THROW(continuum::validate(table));
  EXPECT_EQ(std::get<continuum::GeneralisedBagnold>(table.law).inclination,
            data.conditions.inclination);
  EXPECT_EQ(table.provenance.data, std::vector<std::string>{"synthetic"});
  EXPECT_EQ(table.base->recipe, "synthetic bumpy base");
  ASSERT_TRUE(table.range.softness && table.range.inertial_number);
  // The lowest row used is the one at z = 1.5.
  EXPECT_DOUBLE_EQ(table.range.softness->upper, data.rows[2].softness.value);
  EXPECT_EQ(table.covariance->names,
            (std::vector<std::string>{"a", "b", "no_slip_height", "mass_below"}));
}

TEST(BagnoldFit, ErrorsCoverTheTruthAsOftenAsTheyPromise) {
  SyntheticChute chute{.a = 26.0, .b = 5.0, .velocity_noise = 0.1, .stress_noise = 0.02};
  const double ratio = chute.b / (chute.a * shear_rate_at_half_mass(chute));
  Coverage a, b, height, mid_depth;
  for (chute.seed = 1; chute.seed <= 200; ++chute.seed) {
    const BagnoldFit fit = fit_bagnold(local_data(chute));
    a.add(fit.summary["a"], chute.a);
    b.add(fit.summary["b"], chute.b);
    height.add(fit.summary["no_slip_height"], chute.no_slip_height);
    mid_depth.add(fit.ratio_mid_depth, ratio);
  }
  for (const Coverage* coverage : {&a, &b, &height, &mid_depth}) coverage->expect_honest();
}

TEST(BagnoldFit, RowsTakenAsIndependentWouldPromiseTooMuch) {
  dem::LocalData data = local_data({.b = 5.0, .velocity_noise = 0.1, .stress_noise = 0.02});
  const BagnoldFit honest = fit_bagnold(data);
  data.frames.frames.clear();
  const BagnoldFit naive = fit_bagnold(data);
  EXPECT_TRUE(mentions(naive.summary.notes, "independent"));
  EXPECT_FALSE(mentions(honest.summary.notes, "independent"));
  EXPECT_EQ(naive.summary["no_slip_height"].value, honest.summary["no_slip_height"].value);
  EXPECT_LT(naive.summary["no_slip_height"].error, honest.summary["no_slip_height"].error);
}

TEST(BagnoldFit, FlowWithoutLinearTermEndsAtItsBoundHalfOfTheTime) {
  SyntheticChute chute{.a = 26.0, .b = 0.0, .velocity_noise = 0.1, .stress_noise = 0.02};
  int at_bound = 0;
  int seeds = 0;
  Coverage a;
  for (chute.seed = 1; chute.seed <= 100; ++chute.seed, ++seeds) {
    const BagnoldFit fit = fit_bagnold(local_data(chute));
    a.add(fit.summary["a"], chute.a);
    EXPECT_GE(fit.summary["b"].value, 0.0);
    EXPECT_GT(fit.summary["b"].error, 0.0);
    if (!fit.summary["b"].at_bound) continue;
    ++at_bound;
    EXPECT_EQ(fit.ratio_mid_depth.value, 0.0);
    EXPECT_GT(fit.ratio_mid_depth.error, 0.0);
    EXPECT_TRUE(mentions(fit.summary.notes, "one-sided"));
  }
  EXPECT_NEAR(at_bound, 0.5 * seeds, 3.0 * std::sqrt(0.25 * seeds));  // binomial
}

TEST(BagnoldFit, LinearFlowIsFittedWithoutQuadraticTerm) {
  const SyntheticChute chute{.a = 0.0, .b = 60.0};
  const BagnoldFit fit = fit_bagnold(local_data(chute));
  EXPECT_NEAR(law_of(fit).b, 60.0, 1e-8 * 60.0);
  EXPECT_NEAR(fit.table.base->no_slip_height, 1.1, 1e-8);
  // What is left of a gd^2 beside b gd.
  EXPECT_LT(law_of(fit).a * shear_rate_at_half_mass(chute), 1e-8 * 60.0);
}

TEST(BagnoldFit, NoisyLinearFlowNeverAborts) {
  SyntheticChute chute{.a = 0.0, .b = 60.0, .velocity_noise = 0.02, .stress_noise = 0.02};
  for (chute.seed = 1; chute.seed <= 40; ++chute.seed) {
    const BagnoldFit fit = fit_bagnold(local_data(chute));
    EXPECT_GE(law_of(fit).a, 0.0);
    EXPECT_NEAR(law_of(fit).b, 60.0, 5.0 * fit.summary["b"].error);
    if (fit.summary["a"].at_bound) {
      EXPECT_EQ(fit.ratio_mid_depth.value, std::numeric_limits<double>::infinity());
    }
  }
}

TEST(BagnoldFit, NoSlipForcedAtTheBaseTopDestroysTheLinearTerm) {
  // The fixed base has to bend the whole profile; b pays for it by many of its own errors.
  const BagnoldFit fit = fit_bagnold(local_data({.b = 5.0, .velocity_noise = 0.1}));
  const FittedCoefficient& fixed = fit.fixed_base_summary["b"];
  EXPECT_LT(fixed.value, 5.0 - 5.0 * fixed.error);
  EXPECT_LT(fit.ratio_mid_depth_fixed.value,
            fit.ratio_mid_depth.value - 5.0 * fit.ratio_mid_depth.error);
  EXPECT_TRUE(mentions(fit.fixed_base_summary.notes, "does not follow the profile"));
  EXPECT_FALSE(mentions(fit.summary.notes, "does not follow the profile"));
}

TEST(BagnoldFit, NoSlipAtTheBaseTopNeedsNoOffset) {
  const BagnoldFit fit = fit_bagnold(local_data({.b = 5.0, .no_slip_height = 0.0}));
  EXPECT_NEAR(fit.table.base->no_slip_height, 0.0, 1e-8);
  EXPECT_NEAR(fit.fixed_base_summary["b"].value, 5.0, 1e-8 * 5.0);
}

TEST(BagnoldFit, SlippingBaseIsSaidNotExtrapolated) {
  const BagnoldFit fit = fit_bagnold(local_data({.b = 5.0, .no_slip_height = -3.0}));
  EXPECT_TRUE(fit.summary["no_slip_height"].at_bound);
  EXPECT_NEAR(fit.table.base->no_slip_height, 0.0, 1e-12);
  EXPECT_TRUE(mentions(fit.summary.notes, "no_slip_height is held at its bound"));
}

TEST(BagnoldFit, RowThatIsNotANumberIsLeftOutAndNamed) {
  dem::LocalData data = local_data({.b = 5.0});
  data.rows[20].shear_rate.value = std::nan("");
  const BagnoldFit fit = fit_bagnold(data);
  EXPECT_TRUE(mentions(fit.summary.left_out, "1 row at z = 19.5"));
  EXPECT_NEAR(law_of(fit).b, 5.0, 1e-8 * 5.0);
}

TEST(BagnoldFit, RunThatIsNotSteadyIsRefusedWithItsReason) {
  dem::LocalData data = local_data({});
  data.window.steady = false;
  data.window.reason = "still accelerating";
  const std::string message = failure([&] { fit_bagnold(data); });
  EXPECT_NE(message.find("'synthetic' is not steady (still accelerating)"), std::string::npos);
}

TEST(BagnoldFit, TooFewRowsAreRefusedWithWhatIsMissing) {
  const std::string message = failure([] { fit_bagnold(local_data({.height = 4})); });
  EXPECT_NE(message.find("has 3 usable rows of 5, at least 4"), std::string::npos) << message;
}

TEST(BagnoldFit, LayerThatDoesNotShearIsRefused) {
  dem::LocalData data = local_data({});
  for (dem::LocalRow& row : data.rows) row.velocity.value = 1.0 - 0.01 * row.z;
  EXPECT_NE(failure([&] { fit_bagnold(data); }).find("does not rise"), std::string::npos);
}

TEST(BagnoldFit, ProfileAndPairsAloneGiveTheSameLaw) {
  const SyntheticChute chute{.a = 26.0, .b = 5.0};
  const BagnoldFit fit = fit_bagnold(local_data(chute));
  ASSERT_EQ(fit.variants.size(), 5u);
  for (const BagnoldVariant& variant : fit.variants) {
    if (variant.data != "pairs" && !variant.free_base) continue;  // u = 0 at the wrong height
    EXPECT_NEAR(variant.summary["a"].value, 26.0, 1e-6 * 26.0) << variant.data;
    EXPECT_NEAR(variant.summary["b"].value, 5.0, 1e-6 * 26.0) << variant.data;
    // Xi = b / (a gd) grows towards the surface.
    EXPECT_LT(variant.ratios[0].value, variant.ratios[1].value);
    EXPECT_LT(variant.ratios[1].value, variant.ratios[2].value);
  }
}

TEST(BagnoldFit, VelocityAloneKnowsTheLinearTermLeast) {
  const BagnoldFit fit =
      fit_bagnold(local_data({.b = 5.0, .velocity_noise = 0.1, .stress_noise = 0.02}));
  EXPECT_GT(fit.variants[2].summary["b"].error, fit.variants[0].summary["b"].error);
}

/// How often each law is the one that the data ask for, over 60 seeds.
int times_chosen(const std::string& name, SyntheticChute chute) {
  int times = 0;
  for (chute.seed = 1; chute.seed <= 60; ++chute.seed) {
    for (const ModelScore& model : fit_bagnold(local_data(chute)).models) {
      times += model.chosen && model.name == name ? 1 : 0;
    }
  }
  return times;
}

TEST(BagnoldFit, SimplestLawThatTheDataAskForIsTheTrueOne) {
  // A term that is not there is kept by chance in 5 % of the runs: 57 of 60, three binomial
  // standard deviations are 5.1.
  EXPECT_GE(times_chosen("Bagnold", {.a = 26.0, .b = 0.0, .velocity_noise = 0.02}), 52);
  EXPECT_GE(times_chosen("linear", {.a = 0.0, .b = 60.0, .velocity_noise = 0.02}), 52);
  EXPECT_EQ(times_chosen("generalised", {.a = 26.0, .b = 8.0, .velocity_noise = 0.02}), 60);
}

TEST(BagnoldFit, PlugOfCohesiveGrainsGivesTheirYieldStressTwice) {
  const double tau_c = 3.0;
  const SyntheticChute chute{
      .a = 26.0, .b = 5.0, .tau_c = tau_c, .velocity_noise = 0.01, .stress_noise = 0.002};
  const BagnoldFit fit = fit_bagnold(local_data(chute), {.cohesive = true, .mu0 = 0.353});
  ASSERT_TRUE(fit.plug);
  const double thickness = tau_c / (testing::grain_density * 0.58 * std::sin(chute.inclination));
  EXPECT_NEAR(fit.plug->height, chute.height - thickness, 1.0);  // one bin
  // The plug ends within the bin: a uniform error stays within sqrt(3) of its own deviations.
  const dem::Estimate& weight = fit.plug->yield_stress_from_weight;
  EXPECT_NEAR(weight.value, tau_c, 2.0 * std::sqrt(3.0) * weight.error);
  EXPECT_NEAR(fit.summary["tau_c"].value, tau_c, 4.0 * fit.summary["tau_c"].error);
  EXPECT_NEAR(
      fit.variants[4].summary["tau_c"].value, tau_c, 4.0 * fit.variants[4].summary["tau_c"].error);
  const double share = 1.0 - 0.353 / std::tan(chute.inclination);
  EXPECT_NEAR(fit.cohesion->value, share * fit.summary["tau_c"].value, 1e-12);
  EXPECT_TRUE(mentions(fit.summary.left_out, "they move as a plug"));
  EXPECT_NO_THROW(continuum::validate(fit.table));
}

TEST(BagnoldFit, CohesiveGrainsWithoutAPlugHaveNoYieldStress) {
  const BagnoldFit fit =
      fit_bagnold(local_data({.b = 5.0, .velocity_noise = 0.01}), {.cohesive = true});
  EXPECT_FALSE(fit.plug);
  EXPECT_TRUE(mentions(fit.summary.left_out, "no plug"));
}

}  // namespace
}  // namespace grainlaw::calibration
