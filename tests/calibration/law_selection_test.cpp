#include "calibration/law_selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "calibration/material_laws.h"
#include "support/calibration_checks.h"

namespace grainlaw::calibration {
namespace {

using testing::IntervalCoverage;

/// mu_p = 0.5 of Shi et al. 2020, table 7, in the numbers of the fit.
const Slots<double> friction_truth{
    0.3530, 0.3618 / 0.7184, 1.0 / 0.7184, 1.0, 1.0 / std::sqrt(0.3905), 0.2551, 1.5125};

/// The law at a state with errors in I and in the value, relative and Gaussian.
LawDatum measure(const FittableLaw& law,
                 const Slots<double>& truth,
                 const State& state,
                 double I_noise,
                 double y_noise,
                 std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double y = law.value(truth, state);
  LawDatum datum{.state = state, .error = {}, .y = y * (1.0 + y_noise * normal(random))};
  datum.y_error = y_noise * y;
  datum.error.inertial_number = I_noise * state.inertial_number;
  datum.state.inertial_number *= 1.0 + I_noise * normal(random);
  return datum;
}

std::vector<double> logarithmic(double low, double high, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(low * std::pow(high / low, i / (count - 1.0)));
  return values;
}

/// 24 points along I alone, as in a fit of mu(I).
std::vector<LawDatum> rigid_series(double largest_I, double I_noise, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const FittableLaw law = friction_law({});
  std::vector<LawDatum> data;
  for (const double I : logarithmic(0.005, largest_I, 24)) {
    data.push_back(measure(law, friction_truth, {.inertial_number = I}, I_noise, 0.01, random));
  }
  return data;
}

/// Share of 95 % intervals that hold the truth, by coefficient of the fit.
using Coverages = std::map<std::string, IntervalCoverage>;

void add_coverage(const FittableLaw& law,
                  const std::vector<LawDatum>& data,
                  const std::vector<std::size_t>& active,
                  const Slots<double>& truth,
                  Coverages& coverages) {
  const SelectedLaw fit{.solved = solve_law(law, data, active), .dropped = {}, .scores = {}};
  const FitSummary summary = summarise(law, fit);
  for (std::size_t k = 0; k < active.size(); ++k) {
    const Slot& slot = law.slots[active[k]];
    coverages[slot.name].add(summary.coefficients[k].interval,
                             std::pow(truth[active[k]], slot.power));
  }
}

/// 1000 binomial trials at 95 % scatter by 0.7 %: 93 to 97 % is three of these.
void expect_honest(const Coverages& coverages) {
  for (const auto& [name, coverage] : coverages) {
    ::testing::Test::RecordProperty(name, std::to_string(coverage.inside()));
    EXPECT_GE(coverage.inside(), 0.93) << name;
    EXPECT_LE(coverage.inside(), 0.97) << name;
  }
}

constexpr std::uint64_t data_sets = 1000;

TEST(LawSelection, IntervalsOfACurvedLawHoldTheTruthAsOftenAsTheySay) {
  Coverages coverages;
  for (std::uint64_t seed = 1; seed <= data_sets; ++seed) {
    add_coverage(
        friction_law({}), rigid_series(0.25, 0.0, seed), {0, 1, 2}, friction_truth, coverages);
  }
  expect_honest(coverages);
}

TEST(LawSelection, IntervalsHoldTheTruthWithErrorsInBothAxes) {
  Coverages coverages;
  for (std::uint64_t seed = 1; seed <= data_sets; ++seed) {
    add_coverage(
        friction_law({}), rigid_series(0.5, 0.05, seed), {0, 1, 2}, friction_truth, coverages);
  }
  expect_honest(coverages);
}

TEST(LawSelection, IntervalsOfTheWholeFrictionLawHoldTheTruth) {
  const FittableLaw law = friction_law({});
  Coverages coverages;
  for (std::uint64_t seed = 1; seed <= data_sets; ++seed) {
    std::mt19937_64 random(seed);
    std::vector<LawDatum> data;
    for (const double I : logarithmic(0.005, 0.5, 5)) {
      for (const double p : {0.002, 0.02}) {
        for (const double Bo : {0.0, 0.5, 2.0, 5.0}) {
          data.push_back(measure(law,
                                 friction_truth,
                                 {.inertial_number = I, .softness = p, .bond_number = Bo},
                                 0.02,
                                 0.02,
                                 random));
        }
      }
    }
    add_coverage(law, data, {0, 1, 2, 4, 5, 6}, friction_truth, coverages);
  }
  expect_honest(coverages);
}

TEST(LawSelection, IntervalsOfTheVolumeFractionLawHoldTheTruth) {
  const FittableLaw law = volume_fraction_law();
  const Slots<double> truth{0.595, 1.0 / 5.383, 1.0 / 0.287, -0.1359, 0.0668, -0.0162, 0.0015};
  Coverages coverages;
  for (std::uint64_t seed = 1; seed <= data_sets; ++seed) {
    std::mt19937_64 random(seed);
    std::vector<LawDatum> data;
    for (const double I : logarithmic(0.005, 0.25, 3)) {
      for (const double p : {0.002, 0.02}) {
        for (const double Bo : {0.0, 0.5, 1.0, 2.0, 3.0, 5.0}) {
          data.push_back(measure(law,
                                 truth,
                                 {.inertial_number = I, .softness = p, .bond_number = Bo},
                                 0.02,
                                 0.003,
                                 random));
        }
      }
    }
    add_coverage(law, data, {0, 1, 2, 3, 4, 5, 6}, truth, coverages);
  }
  expect_honest(coverages);
}

TEST(FrictionLaw, NamesTheTermsItHas) {
  continuum::MuPhi law;
  law.friction = {.mu0 = 0.3, .beta = 0.5};
  EXPECT_EQ(words(law), "mu0 + beta I");
  law.softness_friction = continuum::SoftnessFriction{.p_mu = 0.4};
  law.cohesion_friction = continuum::CohesionFriction{.alpha = 0.3};
  EXPECT_EQ(words(law), "mu0 + beta I, f_p square root, f_B = 1 + alpha Bo");
  EXPECT_EQ(friction_law({}).name,
            "mu0 + beta I/(1 + kappa I), f_p square root, f_B = 1 + alpha Bo^beta");
}

}  // namespace
}  // namespace grainlaw::calibration
