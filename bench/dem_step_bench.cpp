// What a scene does not need costs nothing: one chute under laws that leave more and more out, in
// million grain steps per second of one core, with the working memory of the engine per grain.
#include <benchmark/benchmark.h>

#include <cmath>
#include <ctime>
#include <numbers>

#include "dem/contact_law.h"
#include "dem/flow_setup.h"
#include "dem/packing.h"
#include "dem/simulation.h"

namespace {

using namespace grainlaw::dem;

constexpr double stiffness = 2e4;

Scene chute(double size_ratio) {
  Scene scene;
  scene.grains.size_ratio = size_ratio;
  scene.normal = Hooke{.stiffness = stiffness, .damping = 16.26};
  Chute geometry;
  geometry.inclination = 24.0 * std::numbers::pi / 180.0;
  geometry.length = 20.0;
  geometry.width = 20.0;
  geometry.grains = 4000;
  scene.geometry = geometry;
  return scene;
}

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

template <class T>
double bytes(const std::vector<T>& values) {
  return static_cast<double>(values.size() * sizeof(T));
}

double bytes_per_grain(const SimulationBase& simulation) {
  const Particles& p = simulation.particles();
  double sum = bytes(p.state) + bytes(p.spin) + bytes(p.load) + bytes(p.half) + bytes(p.half_spin);
  sum += static_cast<double>(simulation.neighbours().pairs()) * 12.0 +
         bytes(simulation.memory().spring) + bytes(simulation.memory().bridge);
  for (const Strip& strip : simulation.strips()) {
    sum += 4.0 * (bytes(strip.near.first) + bytes(strip.acting.first));
  }
  return sum / static_cast<double>(p.mobile);
}

/// The same packing, fallen together and set flowing, under another law each time.
template <class Law>
void flow(benchmark::State& state, const Law& law, double size_ratio = 1.0) {
  const Scene scene = chute(size_ratio);
  const InitialState packing = initial_state(scene);
  Simulation simulation(law, flow_setup(scene, packing), packing);
  for (int k = 0; k < 20'000; ++k) simulation.step();
  constexpr int steps = 2000;
  double seconds = 0.0;
  for (auto _ : state) {
    const double start = cpu_seconds();
    for (int k = 0; k < steps; ++k) simulation.step();
    const double taken = cpu_seconds() - start;
    state.SetIterationTime(taken);
    seconds += taken;
  }
  const double grain_steps = 4000.0 * steps * static_cast<double>(state.iterations());
  state.counters["Mgrainsteps_per_s"] = grain_steps / seconds * 1e-6;
  state.counters["bytes_per_grain"] = bytes_per_grain(simulation);
  state.counters["acting_per_grain"] = static_cast<double>(simulation.acting_pairs()) / 4000.0;
}

const Hooke hooke{.stiffness = stiffness, .damping = 16.26};
const Hertz hertz{.stiffness = 10.0 * stiffness, .damping = 16.26};
const Sliding sliding{.coefficient = 0.5, .stiffness = 2.0 / 7.0 * stiffness};
const ReversibleAdhesion adhesion{.largest_force = 1.0, .slope = stiffness};

void grainlaw_bench(const char* name, void (*run)(benchmark::State&)) {
  benchmark::RegisterBenchmark(name, run)->Iterations(5)->UseManualTime();
}

}  // namespace

int main(int argc, char** argv) {
  grainlaw_bench("friction", [](auto& s) { flow(s, ContactLaw{hooke, Cohesionless{}, sliding}); });
  grainlaw_bench("no friction", [](auto& s) {
    flow(s, ContactLaw{hooke, Cohesionless{}, Frictionless{}});
  });
  grainlaw_bench("friction, adhesion", [](auto& s) {
    flow(s, ContactLaw{hooke, adhesion, sliding});
  });
  grainlaw_bench("friction, Hertz", [](auto& s) {
    flow(s, ContactLaw{hertz, Cohesionless{}, sliding});
  });
  grainlaw_bench("friction, sizes 1:2", [](auto& s) {
    flow(s, ContactLaw{hooke, Cohesionless{}, sliding}, 2.0);
  });
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
