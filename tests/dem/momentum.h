#pragma once

#include "tests/dem/support.h"

namespace grainlaw::dem::test {

/// Sum of the momenta, and of their sizes, of velocities without shear_rate y.
template <class Law>
std::pair<Vec3, double> peculiar_momentum(const Simulation<Law>& box, double shear_rate) {
  std::pair<Vec3, double> sums{};
  const double middle = 0.5 * box.box().period.y;
  for (std::size_t i = 0; i < box.particles().mobile; ++i) {
    const GrainState& grain = box.particles().state[i];
    const Vec3 mean{shear_rate * (grain.position.y - middle), 0.0, 0.0};
    const Vec3 momentum = 1.0 / grain.inverse_mass * (box.velocity(i) - mean);
    sums.first += momentum;
    sums.second += length(momentum);
  }
  return sums;
}

/// A small box of rough grains that lose nothing in the normal direction and do not slip.
inline auto periodic_box() {
  const Hooke elastic{.stiffness = 2e4, .damping = 0.0};
  const SimulationSetup setup = free_space(elastic.contact_time(0.5) / 50.0);
  return Simulation(smooth(elastic), setup, gas(4.0, 24, 1.0));
}
/// The same size, sheared: rough grains that lose what the shear does.
inline auto sheared_box() {
  SimulationSetup setup = free_space(soft.contact_time(0.5) / 50.0);
  setup.drive = BoxDrive{.shear_rate = 1.0};
  InitialState start = gas(4.0, 24, 1.0);
  for (InitialGrain& grain : start.grains) grain.velocity.x += grain.position.y - 2.0;
  return Simulation(rough(soft, 0.5), setup, start);
}

/// |sum m v'| / sum m |v'| that the box has gained after some steps of collisions. Where grains
/// gather in y, v' of all of them changes with the frame; a box without momentum along y has no
/// such freedom but one: each grain that crosses takes shear_rate L_y with it, which its place
/// undoes.
template <class Law>
double momentum_gained(Simulation<Law> box, long steps) {
  const auto* drive = std::get_if<BoxDrive>(&box.setup().drive);
  const double rate = drive ? drive->shear_rate : 0.0;
  const Vec3 before = peculiar_momentum(box, rate).first;
  for (long k = 0; k < steps; ++k) box.step();
  EXPECT_GT(box.rebuilds(), steps / 2000);
  const auto [momentum, size] = peculiar_momentum(box, rate);
  return length(momentum - before) / size;
}

}  // namespace grainlaw::dem::test
