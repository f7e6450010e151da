#include "dem/steady_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace grainlaw::dem {
namespace {

/// Frames of 2 time units whose mean velocity follows a function of time plus correlated noise.
std::vector<ProfileFrame> frames_of(const std::function<double(double)>& velocity,
                                    double noise,
                                    int count,
                                    unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<ProfileFrame> frames;
  double correlated = normal(random);
  for (int k = 0; k < count; ++k) {
    correlated = 0.7 * correlated + std::sqrt(1.0 - 0.49) * normal(random);
    const double v = velocity(2.0 * k + 1.0) + noise * correlated;
    BinMoments bin;
    bin.mass = 1.0;
    bin.momentum[0] = v;
    frames.push_back({.begin = 2.0 * k,
                      .end = 2.0 * k + 2.0,
                      .samples = 20,
                      .centre_of_mass = 6.0 + 0.01 * v,
                      .kinetic_energy = 0.5 * v * v + 0.05,
                      .bins = {bin}});
  }
  return frames;
}

const SteadyCriteria criteria{.averaging_time = 200.0, .runaway_velocity = 12.0};

TEST(SteadyState, StationarySeriesIsSteady) {
  int steady = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const auto frames = frames_of([](double) { return 2.0; }, 0.1, 160, seed);
    steady += assess(frames, criteria).state == FlowState::steady;
  }
  EXPECT_GE(steady, 36);  // three series tested at 99 %, one in about 30 looks drifting at a time
}

TEST(SteadyState, RelaxingSeriesIsSteadyAfterItsStartWasCut) {
  const auto frames =
      frames_of([](double t) { return 2.0 * (1.0 - std::exp(-t / 30.0)); }, 0.05, 250);
  const Assessment assessment = assess(frames, criteria);
  EXPECT_EQ(assessment.state, FlowState::steady) << assessment.reason;
  // Left of the start at the cut: below the noise, exp(-t/30) < 0.05 / 2 at t = 110.
  EXPECT_GT(frames[assessment.first_frame].begin, 60.0);
}

TEST(SteadyState, RelaxingSeriesIsNotSteadyTooEarly) {
  const auto rising = [](double t) { return 2.0 * (1.0 - std::exp(-t / 300.0)); };
  const Assessment assessment = assess(frames_of(rising, 0.05, 160), criteria);
  EXPECT_NE(assessment.state, FlowState::steady) << assessment.reason;
  EXPECT_FALSE(assessment.certain);
}

TEST(SteadyState, ASlowRelaxationIsNotTakenForSteadyBeforeThreeOfItsTimes) {
  constexpr double relaxation = 100.0;
  const auto approach = [&](double t) { return 2.0 * (1.0 - std::exp(-t / relaxation)); };
  for (int frames = 20; frames <= 400; frames += 10) {
    const auto series = frames_of(approach, 0.06, frames);
    const Assessment assessment = assess(series, criteria);
    if (assessment.state != FlowState::steady) continue;
    // The noise of 3 % lets the velocity pass 63 % a little early: a fifth of a relaxation time.
    EXPECT_GE(series[assessment.first_frame].begin, 3.0 * 0.8 * relaxation) << frames;
  }
}

TEST(SteadyState, ShortSeriesIsShort) {
  const Assessment assessment = assess(frames_of([](double) { return 2.0; }, 0.1, 30), criteria);
  EXPECT_EQ(assessment.state, FlowState::too_short) << assessment.reason;
  EXPECT_FALSE(assessment.certain);
}

TEST(SteadyState, LinearGainBeyondAnyDenseFlowIsCertainlyAccelerating) {
  const auto ramp = [](double t) { return 0.18 * t; };
  const Assessment early = assess(frames_of(ramp, 0.05, 20), criteria);
  EXPECT_EQ(early.state, FlowState::accelerating) << early.reason;
  EXPECT_FALSE(early.certain);  // it could still level off
  const Assessment late = assess(frames_of(ramp, 0.05, 40), criteria);
  EXPECT_EQ(late.state, FlowState::accelerating) << late.reason;
  EXPECT_TRUE(late.certain);
}

TEST(SteadyState, LayerThatStopsIsArrested) {
  const auto stopping = [](double t) { return t < 40.0 ? 0.5 - t / 80.0 : 0.0; };
  const Assessment assessment = assess(frames_of(stopping, 0.0, 40), criteria);
  EXPECT_EQ(assessment.state, FlowState::arrested) << assessment.reason;
  EXPECT_TRUE(assessment.certain);
}

TEST(SteadyState, LayerThatSlowsDownIsDrifting) {
  const auto slowing = [](double t) { return 2.0 - t / 400.0; };
  const Assessment assessment = assess(frames_of(slowing, 0.02, 120), criteria);
  EXPECT_EQ(assessment.state, FlowState::drifting) << assessment.reason;
}

}  // namespace
}  // namespace grainlaw::dem
