// Time-dependent chute against exact solutions: errors and orders in the number of cells.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "tests/continuum/example_laws.h"
#include "tests/verification/verified.h"

namespace grainlaw::continuum {
namespace {

constexpr std::array<int, 5> cells = {25, 50, 100, 200, 400};

void expect_second_order(const char* id,
                         const std::string& of,
                         const std::array<double, 5>& error) {
  for (std::size_t i = 1; i < error.size(); ++i)
    verify(id,
           fmt::format("order in cells, {}, {} to {}", of, cells[i - 1], cells[i]),
           2.0,
           std::log2(error[i - 1] / error[i]),
           0.1);
}

TEST(V1BagnoldFlow, FromRestReachesTheSteadyProfileWithSecondOrder) {
  const auto table = table_of(incompressible_spheres());
  const auto exact = [&](double mass_above) {  // shape of u; the scale is that of the quadrature
    return std::pow(29.0, 1.5) - std::pow(mass_above, 1.5);
  };
  const double scale =
      steady_chute(table, chute(24, 29)).profile.surface_velocity / std::pow(29.0, 1.5);
  std::array<double, 5> error{};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto run = start_from_rest(table, chute(24, 29), {.cells = cells[i]});
    ASSERT_EQ(run.answer.outcome, Outcome::steady) << run.answer.text;
    error[i] = velocity_error(run.final_profile, [&](double mass) { return scale * exact(mass); });
  }
  expect_second_order("V1", "from rest to steady", error);
  verify("V1", "error from rest to steady, 400 cells", 0.0, error.back(), 1.4e-6);
}

/// Start-up of a linear fluid, u = (g sin(theta) / nu) [H z - z^2/2 - (2/H) sum sin(l z)
/// exp(-nu l^2 t) / l^3], l = (k + 1/2) pi / H.
double newtonian_start(double z, double height, double nu, double t) {
  double sum = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double l = (k + 0.5) * std::numbers::pi / height;
    sum += std::sin(l * z) * std::exp(-nu * l * l * t) / (l * l * l);
  }
  return std::sin(24 * degree) / nu * (height * z - 0.5 * z * z - 2.0 / height * sum);
}

std::array<double, 5> newtonian_errors(double relative_tolerance) {
  const double phi = 0.58, height = 50.0, b = 50.0, nu = b / phi;
  const double time = 0.2 * height * height / nu;
  std::array<double, 5> error{};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto run = start_from_rest(table_of(bagnold_at_24_degrees(0, b, 0)),
                                     chute(24, phi * height),
                                     {.cells = cells[i],
                                      .grading = 1.0,
                                      .relative_tolerance = relative_tolerance,
                                      .time_limit = time,
                                      .output_times = {time},
                                      .stop_when_steady = false});
    error[i] = velocity_error(run.snapshots.at(0).profile, [&](double mass) {
      return newtonian_start(height - mass / phi, height, nu, time);
    });
  }
  return error;
}

TEST(V4NewtonianStart, FollowsTheFourierSeriesWithSecondOrderAtAnyTolerance) {
  const std::array<double, 5> known = {1.04e-3, 2.65e-4, 6.69e-5, 1.68e-5, 4.2e-6};
  for (const double relative_tolerance : {1e-6, 1e-8}) {
    const auto error = newtonian_errors(relative_tolerance);
    const std::string tolerance = fmt::format("rtol {:g}", relative_tolerance);
    expect_second_order("V4", tolerance, error);
    for (std::size_t i = 0; i < known.size(); ++i)  // half a unit of the last digit printed
      verify("V4",
             fmt::format("error, {}, {} cells", tolerance, cells[i]),
             known[i],
             error[i],
             i == 4 ? 0.5e-7 : 0.005 * known[i]);
  }
}

TEST(V5FullLaw, FromRestReachesTheQuadratureWithSecondOrder) {
  const auto table = table_of(frictional_spheres());
  const auto fine = steady_chute(table, chute(24, 52.2), {.rows = 40001}).profile;
  const auto exact = [&](double mass_above) {
    const double at = (1.0 - mass_above / 52.2) * 40000.0;
    const auto i = std::min<std::size_t>(39999, static_cast<std::size_t>(at));
    const double part = at - static_cast<double>(i);
    return (1.0 - part) * fine.rows[i].velocity + part * fine.rows[i + 1].velocity;
  };
  std::array<double, 5> error{};
  for (std::size_t i = 0; i < cells.size(); ++i)
    error[i] = velocity_error(
        start_from_rest(table, chute(24, 52.2), {.cells = cells[i]}).final_profile, exact);
  expect_second_order("V5", "from rest to steady", error);
  verify("V5", "error from rest to steady, 400 cells", 0.0, error.back(), 1.4e-6);
}

}  // namespace
}  // namespace grainlaw::continuum
