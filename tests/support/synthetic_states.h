#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "calibration/material_fit.h"

namespace grainlaw::testing {

/// States of homogeneous shear on a grid, with the values a law gives there.
struct StateGrid {
  std::vector<double> inertial_numbers;
  std::vector<double> softnesses;
  std::vector<double> bond_numbers;
};

/// Relative scatter of what is measured; also what is claimed as standard error.
struct StateNoise {
  double friction = 0.0;
  double volume_fraction = 0.0;
  double inertial_number = 0.0;
  std::uint64_t seed = 1;
};

inline dem::Estimate noisy(double truth, double relative, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double error = relative * truth;
  return {truth + error * normal(random), error};
}

inline std::vector<calibration::StatePoint> states(const continuum::MuPhi& law,
                                                   const StateGrid& grid,
                                                   const StateNoise& noise = {}) {
  std::mt19937_64 random(noise.seed);
  std::vector<calibration::StatePoint> points;
  for (const double p : grid.softnesses) {
    for (const double Bo : grid.bond_numbers) {
      for (const double I : grid.inertial_numbers) {
        const continuum::Confinement at{.softness = (1.0 + Bo) * p, .bond_number = Bo};
        const double mu = continuum::friction(law, I, at);
        const double phi = continuum::volume_fraction(law, I, at);
        if (!(mu > 0.0) || !(phi > 0.0)) continue;
        calibration::StatePoint point{.name = {},
                                      .inertial_number = noisy(I, noise.inertial_number, random),
                                      .softness = {p, 0.0},
                                      .bond_number = {Bo, 0.0}};
        point.friction = noisy(mu, noise.friction, random);
        point.volume_fraction = noisy(phi, noise.volume_fraction, random);
        points.push_back(point);
      }
    }
  }
  return points;
}

}  // namespace grainlaw::testing
