#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "calibration/least_squares.h"

namespace grainlaw::calibration {

/// Residuals with exact derivatives from one templated text: `model(x, r)` is called with doubles
/// for values and with dual numbers of N unknowns for the Jacobian. For .cpp files only, so that no
/// type of the minimiser stands in a header of the physics.
template <int N, class Model>
Residuals differentiate(Model model) {
  return [model = std::move(model)](
             std::span<const double> x, std::span<double> r, std::span<double> jacobian) {
    if (jacobian.empty()) {
      std::array<double, N> values{};
      std::copy_n(x.begin(), N, values.begin());
      model(values, r);
      return;
    }
    using Dual = ceres::Jet<double, N>;
    std::array<Dual, N> unknowns{};
    for (int j = 0; j < N; ++j) unknowns[j] = Dual(x[j], j);
    std::vector<Dual> dual(r.size());
    model(unknowns, std::span<Dual>(dual));
    for (std::size_t i = 0; i < r.size(); ++i) {
      r[i] = dual[i].a;
      for (int j = 0; j < N; ++j) jacobian[i * N + j] = dual[i].v[j];
    }
  };
}

}  // namespace grainlaw::calibration
