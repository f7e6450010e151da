// Speed of the DEM engine on a flowing chute, in million grain-steps per second of one core.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "dem/run.h"

namespace {

using namespace grainlaw::dem;

Scene chute(int grains, double side) {
  Scene scene;
  scene.normal = Hooke{.stiffness = 2e4, .damping = 16.26};
  scene.friction = Sliding{.coefficient = 0.5, .stiffness = 2e4 * 2.0 / 7.0, .damping = 0.0};
  scene.geometry.inclination = 24.0 * std::numbers::pi / 180.0;
  scene.geometry.length = side;
  scene.geometry.width = side;
  scene.geometry.grains = grains;
  return scene;
}

void chute_step(benchmark::State& state) {
  const auto grains = static_cast<int>(state.range(0));
  const Scene scene = chute(grains, static_cast<double>(state.range(1)));
  double seconds = 0.0;
  for (auto _ : state) {
    seconds = measure_step_seconds(scene);
    state.SetIterationTime(seconds);
  }
  state.counters["Mgrainsteps_per_s"] = static_cast<double>(grains) / seconds * 1e-6;
}
BENCHMARK(chute_step)
    ->ArgNames({"grains", "side"})
    ->Args({835, 8})
    ->Args({4000, 20})
    ->Iterations(5)
    ->UseManualTime();

}  // namespace
