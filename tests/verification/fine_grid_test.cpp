// A grid far finer than any answer needs: some ten seconds.
#include <gtest/gtest.h>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

TEST(FineGrid, AHundredThousandCellsReachTheQuadrature) {
  const auto run =
      start_from_rest(table_of(frictional_spheres()), chute(24, 52.2), {.cells = 100'000});
  ASSERT_EQ(run.answer.outcome, Outcome::steady) << run.answer.text;
  // the grid leaves 1.4e-6 (400 / 100 000)^2 = 2e-11, the residual 1e-8
  EXPECT_NEAR(run.final_profile.surface_velocity / *run.quadrature_surface_velocity, 1.0, 1e-8);
}

}  // namespace
}  // namespace grainlaw::continuum
