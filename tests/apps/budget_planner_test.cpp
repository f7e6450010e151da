#include "apps/budget_planner.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/io/scene_text.h"
#include "tests/support/synthetic_box.h"

namespace grainlaw {
namespace {

constexpr double most = 40.0;          // strain that a run averages over
constexpr double slow_second = 4.0;    // wall time of a strain at I = 0.05
constexpr double longest_run = 204.0;  // 4 s (1 + 1.25 x 40)
constexpr double hour = 3600.0;

io::SceneFile scene_of(double inertial_number) {
  return io::parse_scene(fmt::format("units = \"stiffness\"\n"
                                     "[contact.normal]\nlaw = \"hooke\"\nrestitution = 0.88\n"
                                     "[contact.friction]\nlaw = \"sliding\"\ncoefficient = 0.5\n"
                                     "[geometry]\nkind = \"simple_shear\"\nshear_rate = {:.6g}\n"
                                     "pressure = 1e-4\ngrains = 100\n",
                                     1e-2 * inertial_number),
                         "box.toml");
}

/// A strain takes the less time the faster the box is sheared.
BudgetCandidate box(double inertial_number) {
  BudgetCandidate candidate{.planned = {.file = scene_of(inertial_number),
                                        .condition = fmt::format("I{}", inertial_number),
                                        .fitted = true},
                            .place = {std::log(inertial_number)}};
  candidate.seconds_per_unit = slow_second * 0.05 / inertial_number;
  candidate.warm_up = 1.0;
  candidate.usable = candidate.least = 2.5;
  candidate.most = most;
  return candidate;
}

/// Two processes that know a straight law from a run at either end.
struct Planned {
  Planned() {
    continuum::MuPhi law;
    law.friction = {.mu0 = 0.36, .beta = 0.6, .kappa = 0.0};
    law.volume_fraction = {.phi0 = 0.58, .I_phi = INFINITY};
    continuum::RheologyTable table;
    table.law = law;
    table.covariance = continuum::Covariance{{"mu0", "beta"}, {1e-6, 0.0, 0.0, 1e-4}};
    std::vector<MeasuredRun> runs;
    for (const double I : {0.05, 0.28}) {
      const testing::SyntheticBox run{
          .inertial_number = I, .softness = 1e-4, .friction_noise = 0.02};
      runs.push_back({testing::local_data(run), fmt::format("I{}", I), true, ""});
    }
    EXPECT_TRUE(planner.learn(table, runs));
  }

  const BudgetCandidate& candidate(const PlannedSpending& run) {
    return planner.candidates()[run.candidate];
  }

  /// When the processes are free, if each takes the next run as soon as it is.
  std::vector<double> ends(const std::vector<PlannedSpending>& runs) {
    std::vector<double> busy(2, 0.0);
    for (const PlannedSpending& run : runs) {
      *std::ranges::min_element(busy) += candidate(run).seconds(run.averaging);
    }
    return busy;
  }

  io::Campaign campaign;
  BudgetPlanner planner{campaign, {box(0.05), box(0.1), box(0.2), box(0.28)}, 2};
};

TEST(BudgetPlanner, NoRunIsAveragedForLongerThanItsSceneAsksFor) {
  Planned plan;
  const auto runs = plan.planner.next_round(0.5 * hour);
  ASSERT_FALSE(runs.empty());
  for (const PlannedSpending& run : runs) EXPECT_LE(run.averaging, most * (1.0 + 1e-12));
  for (const double end : plan.ends(runs)) EXPECT_LE(end, longest_run * (1.0 + 1e-12));
}

TEST(BudgetPlanner, AProcessWithShortRunsGetsAsManyAsFillTheRound) {
  Planned plan;
  plan.planner.candidates()[0].least = std::numeric_limits<double>::infinity();  // not again
  const auto runs = plan.planner.next_round(0.4 * hour);
  // The longest is that of I = 0.1 now, more than a sixteenth of the time left. No process is left
  // idle for more than a quarter of it.
  const double round = 0.5 * longest_run;
  EXPECT_GE(runs.size(), 3u);
  for (const double end : plan.ends(runs)) {
    EXPECT_GT(end, 0.75 * round);
    EXPECT_LE(end, round * (1.0 + 1e-12));
  }
}

TEST(BudgetPlanner, WhatIsLeftOfARoundGetsNoSliver) {
  Planned plan;
  auto& boxes = plan.planner.candidates();
  // One kind of run takes the round, the other four fifths of it: nothing follows that.
  boxes[0].seconds_per_unit = 0.8 * boxes[1].seconds_per_unit;
  boxes[2].least = boxes[3].least = std::numeric_limits<double>::infinity();  // not again
  EXPECT_LE(plan.planner.next_round(0.4 * hour).size(), 2u);
}

TEST(BudgetPlanner, ADayIsNotCutIntoRoundsOfOneRun) {
  Planned plan;
  const double day = 24.0 * hour;
  const auto runs = plan.planner.next_round(day);
  for (const PlannedSpending& run : runs) EXPECT_LE(run.averaging, most * (1.0 + 1e-12));
  for (const double end : plan.ends(runs)) {
    EXPECT_GT(end, day / 16.0 - 0.25 * longest_run);
    EXPECT_LE(end, day / 16.0 * (1.0 + 1e-12));
  }
}

TEST(BudgetPlanner, AShortBudgetGivesEveryProcessOneRunOfHalfTheTime) {
  Planned plan;
  constexpr double left = 40.0;
  const auto runs = plan.planner.next_round(left);
  ASSERT_EQ(runs.size(), 2u);
  for (const double end : plan.ends(runs)) EXPECT_NEAR(end, 0.5 * left, 1e-9);
}

TEST(BudgetPlanner, ThreeTenthsOfManyRoundsGoWhereFewRunsWereMade) {
  Planned plan;
  double all = 0.0;
  double exploring = 0.0;
  for (double left = hour; true;) {
    const auto runs = plan.planner.next_round(left);
    if (runs.empty()) break;
    for (const PlannedSpending& run : runs) {
      BudgetCandidate& one = plan.planner.candidates()[run.candidate];
      const double seconds = one.seconds(run.averaging);
      all += seconds;
      exploring += run.why == "lack of fit" ? seconds : 0.0;
      ++one.runs;
    }
    left -= std::ranges::max(plan.ends(runs));
  }
  EXPECT_GT(all, 1.7 * hour);  // of two processes
  EXPECT_NEAR(exploring / all, 0.3, 0.05);
}

TEST(BudgetCandidate, ARareDriftDoesNotLengthenTheWarmUp) {
  BudgetCandidate one = box(0.1);
  one.runs = 9;
  for (int run = 0; run < 3; ++run) one.count_unsteady(one.warm_up, true);
  EXPECT_EQ(one.warm_up, 1.0);
  EXPECT_EQ(one.tries(), 11);
}

TEST(BudgetCandidate, RunsOfOneRoundLengthenTheWarmUpOnce) {
  BudgetCandidate one = box(0.1);
  const double warm_up = one.warm_up;
  for (int run = 0; run < 4; ++run) one.count_unsteady(warm_up, true);
  EXPECT_EQ(one.warm_up, 2.0);
}

TEST(BudgetCandidate, AWarmUpGrowsToTheAveragingAtMost) {
  BudgetCandidate one = box(0.1);
  for (int run = 0; run < 20; ++run) one.count_unsteady(one.warm_up, true);
  EXPECT_EQ(one.warm_up, most);
  one.warm_up = 2.0 * most;  // as its scene says
  one.count_unsteady(one.warm_up, true);
  EXPECT_EQ(one.warm_up, 2.0 * most);
}

}  // namespace
}  // namespace grainlaw
