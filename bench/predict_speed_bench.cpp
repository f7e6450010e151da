// What a person waits for: the steady chute with 64 nodes of quadrature, and the start from rest to
// the steady flow on 200 cells, without a plug and under one; a body-force box likewise. A person
// sweeps steady flows, so they may take a millisecond; a start is looked at once.
#include <benchmark/benchmark.h>

#include "continuum/shear_band_start.h"
#include "tests/continuum/example_laws.h"

namespace {

using namespace grainlaw::continuum;

/// 11 panels of 6 points are 66 nodes; two rows, as every interval between rows takes a panel.
void steady_chute_of_66_nodes(benchmark::State& state) {
  const RheologyTable table = table_of(frictional_spheres());
  const ChuteCase layer = chute(24, 52.2, {.stiffness = 381971.8634});
  for (auto _ : state)
    benchmark::DoNotOptimize(
        steady_chute(table, layer, {.panels = 11, .rows = 2}).profile.surface_velocity);
}
BENCHMARK(steady_chute_of_66_nodes)->Unit(benchmark::kMicrosecond);

void start_on_200_cells(benchmark::State& state, const RheologyTable& table, double mass) {
  long steps = 0;
  for (auto _ : state) {
    const TransientChute run = start_from_rest(table, chute(24, mass), {.cells = 200});
    if (!flows(run.answer.outcome)) state.SkipWithError("not steady");
    steps = run.statistics.steps;
  }
  state.counters["steps"] = static_cast<double>(steps);
}

void start_without_plug(benchmark::State& state) {
  start_on_200_cells(state, table_of(frictional_spheres()), 52.2);
}
BENCHMARK(start_without_plug)->Unit(benchmark::kMillisecond);

/// Generalised Bagnold, a 1.3, b 0.8, tau_c 6: the upper half rests on the rest.
void start_with_plug(benchmark::State& state) {
  start_on_200_cells(state, table_of(bagnold_at_24_degrees(1.3, 0.8, 6.0)), 29.0);
}
BENCHMARK(start_with_plug)->Unit(benchmark::kMillisecond);

ShearBandCase body_force_box() {
  return {.flow = BodyForceBox{.extent = {.height = 40.0}, .amplitude = 0.2, .pressure = 2.0}};
}

void steady_box(benchmark::State& state) {
  const RheologyTable table = table_of(frictional_spheres());
  for (auto _ : state)
    benchmark::DoNotOptimize(shear_band(table, body_force_box()).driving_velocity);
}
BENCHMARK(steady_box)->Unit(benchmark::kMicrosecond);

void start_of_a_box(benchmark::State& state) {
  const RheologyTable table = table_of(frictional_spheres());
  for (auto _ : state)
    benchmark::DoNotOptimize(start_band(table, body_force_box()).driving_velocity);
}
BENCHMARK(start_of_a_box)->Unit(benchmark::kMillisecond);

}  // namespace
