#include "calibration/information.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/box_points.h"
#include "calibration/material_band.h"
#include "support/synthetic_box.h"
#include "support/synthetic_states.h"

namespace grainlaw::calibration {
namespace {

using testing::local_data;
using testing::StateGrid;
using testing::states;

continuum::MuPhi law() {
  continuum::MuPhi result;
  result.friction = {.mu0 = 0.35, .beta = 0.5, .kappa = 1.4};
  result.softness_friction = continuum::SoftnessFriction{.p_mu = 0.4};
  result.volume_fraction = {.phi0 = 0.6, .I_phi = 5.0};
  result.softness_volume_fraction = continuum::SoftnessVolumeFraction{.p_phi = 0.3};
  return result;
}

const StateGrid grid{.inertial_numbers = {0.01, 0.03, 0.1, 0.2, 0.4},
                     .softnesses = {0.003, 0.01, 0.02},
                     .bond_numbers = {0}};

std::vector<StatePoint> named_states(const continuum::MuPhi& truth, const StateGrid& at) {
  std::vector<StatePoint> points = states(truth, at);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].name = points[i].run = "run" + std::to_string(i);
    points[i].wall_seconds = 1.0 + static_cast<double>(i);
  }
  return points;
}

const RunInformation& of_run(const LawInformation& information, const std::string& name) {
  for (const RunInformation& run : information.runs) {
    if (run.run == name) return run;
  }
  throw std::out_of_range(name);
}

TEST(Information, ErrorsWithoutARunAreThoseOfAFitWithoutIt) {
  // States on the law itself: the fit without a run has the same minimum and the same weights.
  const std::vector<StatePoint> points = named_states(law(), grid);
  const MaterialFit fit = fit_material(points);
  const LawInformation information = friction_information(points, fit);
  ASSERT_EQ(information.runs.size(), points.size());
  for (const std::size_t out : {0u, 7u, 12u}) {
    std::vector<StatePoint> rest = points;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(out));
    const MaterialFit without = fit_material(rest);
    ASSERT_EQ(without.friction.coefficients.size(), fit.friction.coefficients.size());
    const RunInformation& run = of_run(information, points[out].run);
    for (std::size_t k = 0; k < information.coefficients.size(); ++k) {
      const double ratio =
          without.friction.coefficients[k].error / fit.friction.coefficients[k].error;
      // Both minima are found to 1e-8 of an error or so.
      EXPECT_NEAR(1.0 + run.error_increase[k], ratio, 1e-5) << information.coefficients[k];
    }
  }
}

TEST(Information, RunsAreOrderedByWhatASecondOfThemTells) {
  const std::vector<StatePoint> points = named_states(law(), grid);
  const LawInformation information = friction_information(points, fit_material(points));
  for (std::size_t k = 0; k < information.runs.size(); ++k) {
    const RunInformation& run = information.runs[k];
    EXPECT_DOUBLE_EQ(run.gain_per_second, run.gain / run.wall_seconds);
    if (k > 0) {
      EXPECT_LE(run.gain_per_second, information.runs[k - 1].gain_per_second);
    }
  }
}

TEST(Information, OnlyRunWithCohesionTellsAllOfIt) {
  continuum::MuPhi truth = law();
  truth.cohesion_friction = continuum::CohesionFriction{.alpha = 0.3, .beta = 1.0};
  std::vector<StatePoint> points = named_states(truth, grid);
  StateGrid one = grid;
  one.inertial_numbers = {0.1};
  one.softnesses = {0.01};
  one.bond_numbers = {1.0};
  points.push_back(states(truth, one).front());
  points.back().name = points.back().run = "cohesive";
  const LawInformation information = friction_information(points, fit_material(points));
  const RunInformation& cohesive = of_run(information, "cohesive");
  EXPECT_TRUE(std::isinf(cohesive.gain));
  EXPECT_TRUE(std::isnan(cohesive.gain_per_second));  // its cost is not known
  EXPECT_EQ(information.runs.back().run, "cohesive");
}

/// Boxes on the law with noise in every frame.
std::vector<dem::LocalData> boxes(double noise, int frames = 640) {
  std::vector<dem::LocalData> runs;
  const continuum::MuPhi truth = law();
  for (const double p : grid.softnesses) {
    for (const double I : grid.inertial_numbers) {
      const continuum::Confinement at{.softness = p, .bond_number = 0.0};
      runs.push_back(local_data({.name = "box" + std::to_string(runs.size()),
                                 .inertial_number = I,
                                 .softness = p,
                                 .friction = continuum::friction(truth, I, at),
                                 .volume_fraction = continuum::volume_fraction(truth, I, at),
                                 .friction_noise = noise,
                                 .fraction_noise = 0.1 * noise,
                                 .frames = frames,
                                 .seed = runs.size() + 1}));
    }
  }
  return runs;
}

TEST(CostOfCoefficients, ErrorsFallAsTheRootOfTheAveragingTime) {
  const std::vector<dem::LocalData> runs = boxes(0.03);
  std::vector<std::string> left_out;
  const std::vector<StatePoint> points = state_points(runs, left_out);
  const MaterialFit fit = fit_material(points);
  const auto cost = cost_of_coefficients(runs, points, fit);
  ASSERT_EQ(cost.size(), 5u);
  EXPECT_DOUBLE_EQ(cost[2].dem_wall_seconds, 15.0 * (2.0 + 0.25 * 8.0));
  ASSERT_EQ(cost[2].failure, "");
  // A quarter of 640 frames makes 29 blocks: errors of a point to 1/sqrt(2 * 1.5 * 28), of 15
  // together to 3 %; the Jacobian moves with the coefficients by a few percent more. Five of 4 %.
  for (std::size_t k = 0; k < fit.volume_fraction.coefficients.size(); ++k) {
    const double ratio = cost[2].volume_fraction[k].error / cost[4].volume_fraction[k].error;
    EXPECT_NEAR(ratio, 2.0, 0.4) << fit.volume_fraction.coefficients[k].name;
  }
  EXPECT_NEAR(cost[4].friction[0].value, fit.friction.coefficients[0].value, 1e-8);
}

TEST(CostOfCoefficients, ScatterIsUnknownWhereNoPointHasAnError) {
  // 16 frames: a sixteenth is one, which scatters by nothing.
  const std::vector<dem::LocalData> runs = boxes(0.01, 16);
  std::vector<std::string> left_out;
  const std::vector<StatePoint> points = state_points(runs, left_out);
  const auto cost = cost_of_coefficients(runs, points, fit_material(points));
  ASSERT_EQ(cost.size(), 5u);
  ASSERT_EQ(cost.front().failure, "");
  EXPECT_TRUE(std::isnan(cost.front().friction_scatter));
  EXPECT_TRUE(std::isnan(cost.front().fraction_scatter));
  EXPECT_TRUE(std::isfinite(cost.back().friction_scatter));
}

TEST(CostOfCoefficients, RunsWithoutFramesHaveNone) {
  std::vector<dem::LocalData> runs = boxes(0.03);
  for (dem::LocalData& run : runs) run.frames.frames.clear();
  std::vector<std::string> left_out;
  const std::vector<StatePoint> points = state_points(runs, left_out);
  EXPECT_TRUE(cost_of_coefficients(runs, points, fit_material(points)).empty());
}

TEST(MaterialBand, IsAsWideAsTheCovarianceSays) {
  const std::vector<dem::LocalData> runs = boxes(0.03);
  std::vector<std::string> left_out;
  const std::vector<StatePoint> points = state_points(runs, left_out);
  const MaterialFit fit = fit_material(points);
  const std::vector<State> at{{0.01, 0.01, 0.0}};
  const MaterialBand band = material_band(runs, points, fit, at);
  EXPECT_EQ(band.friction.replicates, 200);
  const auto& fitted = std::get<continuum::MuPhi>(fit.table.law);
  const double phi = continuum::volume_fraction(fitted, 0.01, {0.01, 0.0});
  EXPECT_LT(band.volume_fraction.lower[0], phi);
  EXPECT_GT(band.volume_fraction.upper[0], phi);
  // phi at small I is phi0 (1 + p*/p_phi): the error from the covariance of these two.
  const continuum::Covariance& c = *fit.table.covariance;
  const auto place = [&](const char* name) {
    return static_cast<std::size_t>(std::find(c.names.begin(), c.names.end(), name) -
                                    c.names.begin());
  };
  const std::size_t a = place("phi0"), b = place("I_phi"), d = place("p_phi");
  const double phi0 = fitted.volume_fraction.phi0, I_phi = fitted.volume_fraction.I_phi;
  const double p_phi = fitted.softness_volume_fraction->p_phi;
  const std::array<double, 3> slope{phi / phi0,
                                    phi0 * (1.0 + 0.01 / p_phi) * 0.01 / (I_phi * I_phi),
                                    -phi0 * (1.0 - 0.01 / I_phi) * 0.01 / (p_phi * p_phi)};
  const std::array<std::size_t, 3> at_slot{a, b, d};
  double variance = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      variance += slope[i] * c(at_slot[i], at_slot[j]) * slope[j];
    }
  }
  // Quantiles of 200 replicates are known to 10 % each side, 7 % together; errors of the points to
  // 3 %. Four of both.
  const double width = (band.volume_fraction.upper[0] - band.volume_fraction.lower[0]) /
                       (2.0 * 1.96 * std::sqrt(variance));
  EXPECT_NEAR(width, 1.0, 0.3);
}

}  // namespace
}  // namespace grainlaw::calibration
