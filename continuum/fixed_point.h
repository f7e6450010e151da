#pragma once

#include <functional>
#include <span>
#include <vector>

namespace grainlaw::continuum {

struct FixedPointOptions {
  double tolerance = 1e-6;  ///< largest |G(x) - x| of all unknowns
  int most_iterations = 1000;
  int memory = 5;  ///< earlier iterates that are mixed in (Anderson)
};

struct FixedPoint {
  std::vector<double> x;
  int iterations = 0;
  bool converged = false;
};

/// x = G(x) by Anderson's acceleration of the iteration x <- G(x) (KINSOL). What G throws comes out
/// again. Throws SolverError where KINSOL itself fails.
FixedPoint solve_fixed_point(
    const std::function<void(std::span<const double> x, std::span<double> image)>& map,
    std::span<const double> start,
    const FixedPointOptions& options = {});

}  // namespace grainlaw::continuum
