// The cross-section of a ring cell against a closed form and the path of least torque, which is
// found by other means (split_bottom.cpp).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "continuum/ring_flow.h"
#include "continuum/torque_balance.h"
#include "tests/continuum/example_laws.h"
#include "tests/verification/verified.h"

namespace grainlaw::continuum {
namespace {

/// Far above the bottom a uniform viscosity makes omega = (1/R_i^2 - 1/r^2) / (1/R_i^2 - 1/R_o^2).
double error_of_couette_flow(double cell_width) {
  const RingMesh mesh(2.0, 5.0, 6.0, 40.0, cell_width);
  TorqueBalance balance(mesh, 5.0);
  std::vector<double> unknowns(balance.unknowns());
  balance.solve(std::vector<double>(mesh.cells(), 3.0), unknowns);
  const std::vector<double> rotation = balance.scatter(unknowns);
  Largest error;
  for (std::size_t i = 0; i < mesh.r().size(); ++i) {
    const double r = mesh.r()[i];
    const double exact = (0.25 - 1.0 / (r * r)) / (0.25 - 1.0 / 36.0);
    error.add(rotation[mesh.node(i, mesh.rows())] - exact);
  }
  return error.value();
}

/// The ring cell of Shi et al. 2020, section 2.3, with rigid grains of mu_p = 0.01.
RingFlowCase ring(double rotation_rate, std::optional<double> amplitude = {}) {
  return {.cell = {.split_radius = 38.6, .depth = 16.8, .rotation_rate = rotation_rate},
          .inner_radius = 6.7,
          .outer_radius = 50.0,
          .nonlocal_amplitude = amplitude};
}

const RheologyTable table = table_of(slippery_spheres());

TEST(V16RingCell, HasTheCouetteFlowBetweenTallCylindersAtSecondOrder) {
  const double coarse = error_of_couette_flow(0.25), fine = error_of_couette_flow(0.125);
  verify("V16",
         "uniform viscosity, tall cylinders, error of omega, cells of 0.125 d",
         0.0,
         fine,
         1e-3);
  verify("V16", "uniform viscosity, order in cells", 2.0, std::log2(coarse / fine), 0.2);
}

/// A law without rate is a plastic material: among all rotations it takes the one of least torque,
/// a band on the path of Unger et al. (2004). Finite cells can only add to the torque.
TEST(V16RingCell, ASlowLocalFlowTakesThePathOfLeastTorque) {
  const SplitBottom path = split_bottom(table, ring(1e-8).cell, 2000);
  for (const double width : {0.5, 0.25}) {
    const RingFlow flow = ring_flow(table, ring(1e-8), {.cell_width = width});
    ASSERT_EQ(flow.answer.outcome, Outcome::steady) << flow.answer.text;
    verify_relative("V16",
                    fmt::format("torque of a slow local flow, cells of {} d", width),
                    path.torque,
                    flow.torque,
                    0.02 * width / 0.5);
    EXPECT_GT(flow.torque, path.torque);
    Largest off;
    for (const RingFlowRow& row : flow.rows) {
      const auto near = std::ranges::min_element(
          path.rows, {}, [&](const SplitBottomRow& other) { return std::abs(other.z - row.z); });
      off.add(row.centre - near->radius);
    }
    verify("V16",
           fmt::format("its R_c off the path, all heights, cells of {} d", width),
           0.0,
           off.value(),
           width);
  }
}

/// The jump at the split is of order 0: a mesh twice as fine halves the error.
TEST(V16RingCell, ConvergesWithFirstOrder) {
  const auto error = [&](double width) {
    return ring_flow(table, ring(0.028, 0.3), {.cell_width = width}).discretisation_error;
  };
  const double coarse = error(0.5), fine = error(0.25);
  verify("V16", "A = 0.3, distance of cells of 0.25 and 0.5 d", 0.0, fine, 0.01);
  verify("V16", "A = 0.3, order in cells", 1.0, std::log2(coarse / fine), 0.25);
}

}  // namespace
}  // namespace grainlaw::continuum
