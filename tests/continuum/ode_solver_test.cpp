#include "continuum/ode_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace grainlaw::continuum {
namespace {

/// y_i' = -10^i y_i: stiff, exact. Its event is y_0 = 1/2.
struct Decay : OdeSystem {
  bool fails = false;
  void rate(double t, std::span<const double> y, std::span<double> dydt) const override {
    if (fails && t > 0.1) throw std::domain_error("no law there");
    for (std::size_t i = 0; i < y.size(); ++i) dydt[i] = -std::pow(10.0, i) * y[i];
  }
  void jacobian(double, std::span<const double> y, TridiagonalView matrix) const override {
    for (std::size_t i = 0; i < y.size(); ++i) matrix(i, i) = -std::pow(10.0, i);
  }
  double event(double, std::span<const double> y) const override { return y[0] - 0.5; }
  std::string component_name(std::size_t i) const override {
    return std::string("y").append(std::to_string(i));
  }
};

/// y' = y^2 reaches infinity at t = 1.
struct BlowUp : Decay {
  void rate(double, std::span<const double> y, std::span<double> dydt) const override {
    for (std::size_t i = 0; i < y.size(); ++i) dydt[i] = y[i] * y[i];
  }
  void jacobian(double, std::span<const double> y, TridiagonalView matrix) const override {
    for (std::size_t i = 0; i < y.size(); ++i) matrix(i, i) = 2.0 * y[i];
  }
};

const std::vector<double> ones(5, 1.0);

TEST(OdeSolver, FollowsAStiffDecayWithinItsTolerance) {
  const Decay system;
  OdeSolver solver(system, ones, {.end_time = 1.0, .stop_at_event = false});
  while (solver.step() != OdeSolver::Step::end) {
  }
  EXPECT_EQ(solver.time(), 1.0);
  // local errors of 1e-6 per step add up over some hundred steps
  const double steps = static_cast<double>(solver.statistics().steps);
  EXPECT_NEAR(solver.state()[0], std::exp(-1.0), 1e-6 * steps);
  EXPECT_NEAR(solver.state()[4], 0.0, 1e-9);
  EXPECT_LT(steps, 1e4 / 2.0);  // an explicit method is held to 2 / 1e4 per step
}

TEST(OdeSolver, StopsAtTheEvent) {
  const Decay system;
  OdeSolver solver(system, ones, {.end_time = 10.0});
  auto last = OdeSolver::Step::advanced;
  while (last == OdeSolver::Step::advanced) last = solver.step();
  EXPECT_EQ(last, OdeSolver::Step::event);
  EXPECT_NEAR(solver.time(), std::log(2.0), 1e-6 * static_cast<double>(solver.statistics().steps));
}

TEST(OdeSolver, PassesOnWhatTheSystemThrows) {
  Decay system;
  system.fails = true;
  OdeSolver solver(system, ones, {.end_time = 1.0, .stop_at_event = false});
  EXPECT_THROW(while (solver.step() != OdeSolver::Step::end){}, std::domain_error);
}

TEST(OdeSolver, NamesTimeAndUnknownWhenItFails) {
  const BlowUp system;
  const std::vector<double> start{0.5, 1.0, 0.5};
  OdeSolver solver(system, start, {.end_time = 2.0, .stop_at_event = false, .time_unit = " s"});
  try {
    while (solver.step() != OdeSolver::Step::end) {
    }
    FAIL() << "went through infinity";
  } catch (const SolverError& error) {
    EXPECT_NE(std::string(error.what()).find("t = 0.9999"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(" s with"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("y1"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace grainlaw::continuum
