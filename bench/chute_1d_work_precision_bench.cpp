// Error against run time of the continuum solver: mu(I, p*), phi(I) chute at 24 degrees.
// The counter `error` is the largest difference of the steady velocity from the quadrature with
// four times the panels, over the surface velocity. Quadrature and CVODE stand side by side.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "continuum/chute_1d.h"

namespace {

using namespace grainlaw::continuum;

RheologyTable frictional_table() {  // Shi et al. 2020, tables 3 and 7, mu_p = 0.5
  RheologyTable table;
  constexpr double mu0 = 0.3530;
  constexpr double mu_inf = 0.7148;
  constexpr double I_mu = 0.7184;
  table.law = MuPhi{.friction = {mu0, (mu_inf - mu0) / I_mu, 1.0 / I_mu},
                    .softness_friction = SoftnessFriction{.p_mu = 0.3905},
                    .cohesion_friction = {},
                    .volume_fraction = {.phi0 = 0.595, .I_phi = 5.383},
                    .softness_volume_fraction = {},
                    .cohesion_volume_fraction = {}};
  return table;
}

ChuteCase deep_chute() {
  ChuteCase chute;
  chute.inclination = 24.0 * std::numbers::pi / 180.0;
  chute.mass_per_area = 30.0;
  chute.grains.stiffness = 1e4;
  return chute;
}

double reference_surface_velocity() {
  static const double value =
      steady_chute(frictional_table(), deep_chute(), {.panels = 64}).profile.surface_velocity;
  return value;
}

void record(benchmark::State& state, double surface_velocity) {
  state.counters["error"] = std::abs(surface_velocity / reference_surface_velocity() - 1.0);
}

void quadrature(benchmark::State& state) {
  // Two rows: every interval between rows takes a panel of its own at least.
  const SteadyOptions options{.panels = static_cast<int>(state.range(0)), .rows = 2};
  double velocity = 0.0;
  for (auto _ : state) {
    velocity = steady_chute(frictional_table(), deep_chute(), options).profile.surface_velocity;
  }
  record(state, velocity);
}
BENCHMARK(quadrature)->RangeMultiplier(2)->Range(1, 32);

void start_from_rest_to_steady(benchmark::State& state) {
  TransientOptions options;
  options.cells = static_cast<int>(state.range(0));
  options.relative_tolerance = std::pow(10.0, -static_cast<double>(state.range(1)));
  double velocity = 0.0;
  for (auto _ : state) {
    velocity =
        start_from_rest(frictional_table(), deep_chute(), options).final_profile.surface_velocity;
  }
  record(state, velocity);
}
BENCHMARK(start_from_rest_to_steady)
    ->ArgNames({"cells", "minus_log_tolerance"})
    ->ArgsProduct({{25, 50, 100, 200, 400}, {3, 4, 6, 8}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
