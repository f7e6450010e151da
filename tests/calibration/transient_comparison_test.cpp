#include "calibration/transient_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "support/synthetic_chute.h"

namespace grainlaw::calibration {
namespace {

using continuum::ChuteEvent;
using continuum::Profile;
using testing::local_data;

using Course = std::function<double(double)>;  ///< share of the full flow against time

constexpr double frame_length = 2.0;
constexpr double change_time = 60.0;  ///< of 120
constexpr double degree = std::numbers::pi / 180.0;

/// A prediction that says exactly what was measured, velocities times `factor`.
Profile profile_of(const dem::LocalData& data, double factor) {
  Profile profile;
  for (const dem::LocalRow& row : data.rows) {
    profile.rows.push_back(
        {.z = row.z, .mass_above = row.mass_above, .velocity = factor * row.velocity.value});
  }
  profile.height = data.rows.back().z + 0.5;
  return profile;
}

/// The full flow of the synthetic chute times what a course says at the middle of each frame.
dem::LocalData run_of(const Course& course, double window_begin = 100.0) {
  dem::LocalData data = local_data({.no_slip_height = 0.0});
  data.window.begin = window_begin;
  for (dem::ProfileFrame& frame : data.frames.frames) {
    for (dem::BinMoments& bin : frame.bins)
      bin.momentum[0] *= course(0.5 * (frame.begin + frame.end));
  }
  return data;
}

dem::LocalData tilted(dem::LocalData data, double before = 23.0, double after = 26.0) {
  data.conditions.tilts = {{0.0, before * degree}, {change_time, after * degree}};
  data.conditions.inclination = after * degree;
  return data;
}

/// Snapshots of the full flow of a run times a course, at the middle of its frames.
continuum::TransientChute prediction_of(const Course& course) {
  const dem::LocalData full = local_data({.no_slip_height = 0.0});
  continuum::TransientChute result;
  for (const dem::ProfileFrame& frame : full.frames.frames) {
    const double time = 0.5 * (frame.begin + frame.end);
    result.snapshots.push_back({.time = time, .profile = profile_of(full, course(time))});
  }
  return result;
}

double full_flow(double) {
  return 1.0;
}

double at_rest(double) {
  return 0.0;
}

/// Slows down from the change on and stands still after `stop`.
Course stopping(double stop) {
  return [=](double t) { return std::clamp(1.0 - (t - change_time) / stop, 0.0, 1.0); };
}

TEST(CompareInTime, AFlowHasNoErrorAgainstItself) {
  const auto stretches = compare_in_time(run_of(full_flow), prediction_of(full_flow));
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].change, Change::start);
  ASSERT_EQ(stretches[0].moments.size(), 60u);
  EXPECT_NEAR(stretches[0].error, 0.0, 1e-14);
  // Means over the same mass: bins against trapezes between their centres, which leave out half a
  // bin at each end; the curvature of u^1.5 over a bin and those ends are below 1/40 of it.
  const Moment& moment = stretches[0].moments.front();
  EXPECT_NEAR(moment.predicted_mean, moment.measured_mean, moment.measured_mean / 40.0);
}

TEST(CompareInTime, ALayerThatRestsIsOffByTheWholeFlow) {
  const auto stretches = compare_in_time(run_of(full_flow), prediction_of(at_rest));
  EXPECT_NEAR(stretches.at(0).error, 1.0, 1e-14);
  EXPECT_EQ(stretches[0].moments.front().predicted_mean, 0.0);
}

TEST(CompareInTime, ATimeWithoutFrameIsSkipped) {
  continuum::TransientChute late;
  late.snapshots = {{.time = 1e6, .profile = {}}};
  EXPECT_TRUE(compare_in_time(run_of(full_flow), late).at(0).moments.empty());
}

TEST(CompareInTime, ErrorsAreMeasuredByTheFasterOfTheSteadyFlowsAroundAChange) {
  const auto measured = [](double t) { return t < change_time ? 0.5 : 1.0; };
  const auto predicted = [&](double t) { return measured(t) - 0.1; };
  const auto stretches = compare_in_time(tilted(run_of(measured)), prediction_of(predicted));
  ASSERT_EQ(stretches.size(), 2u);
  EXPECT_EQ(stretches[0].change, Change::start);
  EXPECT_EQ(stretches[1].change, Change::tilt_step);
  EXPECT_EQ(stretches[1].inclination_before, 23.0 * degree);
  EXPECT_NEAR(stretches[0].error, 0.2, 1e-14);
  EXPECT_NEAR(stretches[1].error, 0.1, 1e-14);
}

TEST(CompareInTime, AnExponentialApproachIsWithinFivePercentAfterThreeTimeConstants) {
  const auto approaching = [](double time_constant) {
    return [=](double t) { return 1.0 - std::exp(-t / time_constant); };
  };
  const auto stretches = compare_in_time(run_of(approaching(5.0)), prediction_of(approaching(8.0)));
  ASSERT_TRUE(stretches.at(0).to_steady.has_value());
  const TimeToSteady& times = *stretches[0].to_steady;
  EXPECT_EQ(times.share, 0.05);
  EXPECT_NEAR(times.measured.value, 5.0 * std::log(20.0), 0.5 * frame_length);
  EXPECT_NEAR(times.predicted.value, 8.0 * std::log(20.0), 0.5 * frame_length);
  EXPECT_NEAR(times.measured.error, frame_length / std::sqrt(12.0), 1e-14);
}

TEST(CompareInTime, AStepCountsFromItsChangeAndByTheWayBetweenItsFlows) {
  const auto course = [](double t) {
    return t < change_time ? 0.5 : 1.0 - 0.5 * std::exp(-(t - change_time) / 5.0);
  };
  const auto stretches = compare_in_time(tilted(run_of(course)), prediction_of(course));
  ASSERT_TRUE(stretches.at(1).to_steady.has_value());
  EXPECT_NEAR(stretches[1].to_steady->measured.value, 5.0 * std::log(20.0), 0.5 * frame_length);
}

TEST(CompareInTime, NoTimeToSteadyIsGivenOfAFlowThatStillDrifts) {
  const auto growing = [](double t) { return t / 120.0; };
  const auto stretches = compare_in_time(run_of(growing, 60.0), prediction_of(growing));
  EXPECT_FALSE(stretches.at(0).to_steady.has_value());
}

TEST(CompareInTime, AnArrestIsJudgedByItsTimeAndByTheFlowBeforeIt) {
  dem::LocalData data = tilted(run_of(stopping(20.0)), 24.0, 18.0);
  for (dem::LocalRow& row : data.rows) row.velocity.value = 0.0;  // of the window at rest
  data.window = {.steady = false, .begin = 80.0, .end = 120.0, .arrested_at = 80.0};
  continuum::TransientChute predicted = prediction_of(stopping(24.0));
  predicted.events = {{ChuteEvent::Kind::start, 0.0}, {ChuteEvent::Kind::arrest, 84.0}};
  const auto stretches = compare_in_time(data, predicted);
  EXPECT_EQ(stretches.at(0).change, Change::start);
  const Stretch& arrest = stretches.at(1);
  EXPECT_EQ(arrest.change, Change::arrest);
  ASSERT_TRUE(arrest.stop && arrest.stop->measured && arrest.stop->predicted);
  EXPECT_EQ(arrest.stop->measured->value, 19.0);  // within the frame that ends at 80
  EXPECT_EQ(*arrest.stop->predicted, 24.0);
  EXPECT_FALSE(arrest.to_steady.has_value());
  double squares = 0.0;
  int frames = 0;
  for (double t = change_time + 1.0; t < 84.0; t += frame_length, ++frames)
    squares += std::pow(stopping(20.0)(t) - stopping(24.0)(t), 2);
  EXPECT_NEAR(arrest.error, std::sqrt(squares / frames), 1e-14);
}

TEST(CompareInTime, AnArrestOfOneSideOnlyIsSeen) {
  const dem::LocalData data = tilted(run_of(full_flow), 24.0, 18.0);
  continuum::TransientChute predicted = prediction_of(stopping(24.0));
  predicted.events = {{ChuteEvent::Kind::arrest, 84.0}};
  const Stretch stretch = compare_in_time(data, predicted).at(1);
  EXPECT_EQ(stretch.change, Change::arrest);
  EXPECT_FALSE(stretch.stop->measured.has_value());
}

TEST(CompareInTime, ARunBegunInTheFlowOfItsFirstTiltIsFollowedFromTheChange) {
  dem::LocalData data = tilted(run_of(full_flow));
  data.frames.from_rest = false;
  const auto stretches = compare_in_time(data, prediction_of(full_flow));
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].change, Change::tilt_step);
  EXPECT_EQ(stretches[0].begin, change_time);
}

TEST(CompareInTime, ATiltThatTheRunDidNotReachDoesNotCount) {
  dem::LocalData data = tilted(run_of(full_flow));
  data.conditions.tilts.push_back({500.0, 30.0 * degree});
  EXPECT_EQ(tilts_of(data).size(), 2u);
  EXPECT_EQ(compare_in_time(data, prediction_of(full_flow)).size(), 2u);
}

}  // namespace
}  // namespace grainlaw::calibration
