#include "dem/ring_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dem/fields.h"
#include "dem/local_data.h"
#include "dem/ring_sampler.h"
#include "dem/run.h"
#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

/// Radii from 10 to 16 and heights from 0 to 6, in bins of 1/4.
RingBins fine_bins(const Kernel& kernel) {
  const double wedge = 0.5 * std::numbers::pi;
  return {.radial = {.axis = ProfileAxis::radius,
                     .begin = 10.0,
                     .width = 0.25,
                     .area = wedge,
                     .count = 24},
          .axial = {.begin = 0.0, .width = 0.25, .count = 24},
          .wedge = wedge,
          .bins_per_row = 4,
          .kernel = kernel};
}

std::vector<Kernel> kernels() {
  std::vector<Kernel> all{Kernel{}};
  for (const KernelShape shape : {KernelShape::lucy, KernelShape::gaussian}) {
    for (const double width : {0.5, 1.0, 2.0}) all.push_back({shape, width});
  }
  return all;
}

ChuteConditions unit_conditions() {
  ChuteConditions conditions;
  conditions.geometry = "split_bottom";
  conditions.grain_density = 1e-3;  // every cell with a grain counts
  conditions.stiffness = 1.0;
  return conditions;
}

Vec3 at(double r, double angle, double z) {
  return {r * std::cos(angle), r * std::sin(angle), z};
}

Particles moving(const InitialState& initial) {
  Particles particles = make_particles(initial, unit_density, false);
  restart_half_step(particles, {});
  return particles;
}

/// Places without a pattern, 2 d and more inside the bins.
Vec3 place(std::size_t k) {
  const Vec3 s = scatter(k);
  return at(13.0 + s.x, 0.25 * std::numbers::pi * (1.0 + s.y), 3.0 + s.z);
}

/// Grains anywhere, and contacts that are no real ones: sums do not care.
struct Heap {
  Particles particles;
  std::vector<ContactSample> contacts;
};
Heap make_heap() {
  InitialState initial;
  for (std::size_t k = 0; k < 60; ++k) {
    initial.grains.push_back({.position = place(k), .velocity = 3.0 * scatter(k + 100)});
  }
  for (std::size_t k = 0; k < 10; ++k) {
    initial.grains.push_back({.position = place(k + 300), .body = Body::base});
  }
  Heap heap{moving(initial), {}};
  for (std::uint32_t k = 0; k < 60; ++k) {
    const std::uint32_t other = k % 3 == 0 ? 60 + k % 10 : (k + 7) % 60;
    heap.contacts.push_back({k, other, 0.9 * scatter(k + 200), 5.0 * scatter(k + 400)});
  }
  return heap;
}

/// What one cell with everything in it would hold, offsets from r = z = 0.
CellMoments sums_of(const Heap& heap) {
  CellMoments sums;
  for (std::size_t i = 0; i < heap.particles.mobile; ++i) {
    const Vec3& x = heap.particles.state[i].position;
    const Vec3 v = cylindrical(x, velocity(heap.particles, i, Dynamics{}));
    const double mass = 1.0 / heap.particles.state[i].inverse_mass;
    const double r = std::hypot(x.x, x.y);
    sums.mass += mass;
    sums.grains += 1.0;
    add_vector(sums.momentum, v, mass);
    add_dyad(sums.momentum_flux, v, v, mass);
    add_vector(sums.momentum_offset_r, v, mass * r);
    add_vector(sums.momentum_offset_z, v, mass * x.z);
    sums.mass_offset[0] += mass * r;
    sums.mass_offset[1] += mass * x.z;
    sums.mass_offset_square[0] += mass * r * r;
    sums.mass_offset_square[1] += mass * x.z * x.z;
    sums.mass_offset_square[2] += mass * r * x.z;
  }
  for (const ContactSample& contact : heap.contacts) {
    const bool wall = heap.particles.state[contact.second].inverse_mass == 0.0;
    const Vec3 arm = (wall ? 0.5 : 1.0) * contact.branch;
    const Vec3 middle = heap.particles.state[contact.first].position - 0.5 * arm;
    add_tensor(
        sums.contact_stress, cylindrical(middle, contact.force), cylindrical(middle, arm), 1.0);
    if (square(contact.branch) < 1.0) sums.contacts += wall ? 1.0 : 2.0;
  }
  return sums;
}

RingFrame sampled(RingSampler& sampler,
                  const Particles& particles,
                  const std::vector<ContactSample>& contacts = {}) {
  sampler.sample(particles, {}, contacts);
  return sampler.finish();
}

/// Numbers of sums, without those of second order in offsets, which the kernel widens.
std::vector<double> numbers(const CellMoments& cell) {
  std::vector<double> all{cell.mass, cell.grains, cell.contacts};
  const auto add = [&](const auto& list) { all.insert(all.end(), list.begin(), list.end()); };
  add(cell.momentum);
  add(cell.momentum_flux);
  add(cell.contact_stress);
  add(cell.mass_offset);
  add(cell.momentum_offset_r);
  add(cell.momentum_offset_z);
  return all;
}

TEST(RingSampler, SumsOverCellsAreTheSumsOverGrainsAndContacts) {
  const Heap heap = make_heap();
  const std::vector<double> expected = numbers(sums_of(heap));
  for (const Kernel& kernel : kernels()) {
    RingSampler sampler(fine_bins(kernel));
    const RingFrame frame = sampled(sampler, heap.particles, heap.contacts);
    const RingGrid& grid = sampler.grid();
    CellMoments sums;
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const double r = grid.radius(k % grid.columns), z = grid.height(k / grid.columns);
      add_cell(sums, frame.cells[k], r, z, 1.0);
    }
    const std::vector<double> found = numbers(sums);
    for (std::size_t n = 0; n < expected.size(); ++n) {
      // The largest number is the first moment of the mass, 800.
      EXPECT_NEAR(found[n], expected[n], 1e-12 * 800.0) << "number " << n << ", w " << kernel.width;
    }
  }
}

TEST(RingSampler, SumOverHeightIsTheProfileOverTheRadius) {
  const Heap heap = make_heap();
  for (const Kernel& kernel : kernels()) {
    const RingBins bins = fine_bins(kernel);
    RingSampler ring(bins);
    const RingFrame frame = sampled(ring, heap.particles, heap.contacts);
    FrameSampler shells(bins.radial.count);
    shells.sample(bins.radial, heap.particles, {}, heap.contacts);
    const ProfileFrames profile{.z_begin = bins.radial.begin,
                                .bin_width = bins.radial.width,
                                .frames = {},
                                .bins_per_row = bins.bins_per_row};
    const auto rows = coarse_grain({shells.finish().bins, {}}, profile, kernel, unit_conditions());
    const RingGrid& grid = ring.grid();
    ASSERT_EQ(rows.size(), grid.columns);
    for (std::size_t i = 0; i < grid.columns; ++i) {
      CellMoments column;
      for (std::size_t k = 0; k < grid.rows; ++k) {
        add_cell(column, frame.cells[grid.index(i, k)], 0.0, 0.0, 1.0);
      }
      const double volume = grid.wedge * grid.radius(i) * grid.width;
      EXPECT_NEAR(column.mass / volume, rows[i].density, 1e-12);
      EXPECT_NEAR(column.momentum[0] / volume, rows[i].momentum[0], 1e-12);
      EXPECT_NEAR(column.contact_stress[4] / volume, rows[i].contact_stress[4], 1e-11);
    }
  }
}

TEST(RingField, RigidRotationHasNeitherShearNorTemperature) {
  constexpr double omega = 0.3;
  InitialState initial;
  for (std::size_t k = 0; k < 300; ++k) {
    const Vec3 x = place(k);
    initial.grains.push_back({.position = x, .velocity = {-omega * x.y, omega * x.x, 0.0}});
  }
  const Particles particles = moving(initial);
  constexpr double speed2 = 16.0;  // (0.3 * 14)^2: what is subtracted
  for (const Kernel& kernel : kernels()) {
    RingSampler sampler(fine_bins(kernel));
    const std::vector<RingFrame> frames{sampled(sampler, particles)};
    const RingGrid& grid = sampler.grid();
    int filled = 0;
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const CellMoments& cell = frames.front().cells[k];
      const std::size_t i = k % grid.columns;
      const bool bulk = std::abs(grid.radius(i) - 13.0) < 1.0 &&
                        std::abs(grid.height(k / grid.columns) - 3.0) < 1.0;
      if (!bulk) continue;
      const RingField field = ring_field(cell, grid.radius(i), grid.volume(i), unit_conditions());
      EXPECT_NEAR(field.angular_velocity, omega, 1e-13);
      EXPECT_NEAR(field.shear_rate, 0.0, 1e-11);
      EXPECT_NEAR(field.temperature, 0.0, 1e-13 * speed2);
      EXPECT_NEAR(field.shear_stress, 0.0, 1e-13 * speed2 * cell.mass / grid.volume(i));
      ++filled;
    }
    EXPECT_EQ(filled, 4);
  }
}

/// Grains closely all over the bins, of uniform mass per volume.
template <class Flow>
Particles dense_flow(const RingBins& bins, Flow&& flow) {
  constexpr int per_bin = 5;
  const double distance = bins.radial.width / per_bin;
  InitialState initial;
  for (int i = 0; i < per_bin * static_cast<int>(bins.radial.count); ++i) {
    for (int k = 0; k < per_bin * static_cast<int>(bins.axial.count); ++k) {
      const double r = bins.radial.begin + (i + 0.5) * distance;
      const double z = bins.axial.begin + (k + 0.5) * distance;
      initial.grains.push_back({.position = at(r, 0.0, z),
                                .velocity = {0.0, flow(r, z), 0.0},
                                .diameter = std::cbrt(r)});
    }
  }
  return moving(initial);
}

TEST(RingField, TwistOverTheHeightIsShearToTheSquareOfTheKernel) {
  // v = r w(z), w' constant. In the plane through it, weighted with r and the kernel, the product
  // of both offsets gives dv/dz its mean offset in r, s^2/r, s^2 the variance of kernel and cell.
  constexpr double twist = 0.05;
  const auto flow = [](double r, double z) { return r * (0.1 - twist * z); };
  for (const Kernel& kernel : {Kernel{}, Kernel{KernelShape::lucy, 1.0}}) {
    const RingBins bins = fine_bins(kernel);
    RingSampler sampler(bins);
    const RingFrame frame = sampled(sampler, dense_flow(bins, flow));
    const RingGrid& grid = sampler.grid();
    const std::size_t i = grid.columns / 2, k = grid.rows / 2;  // nothing cut off
    const double r = grid.radius(i);
    const RingField field =
        ring_field(frame.cells[grid.index(i, k)], r, grid.volume(i), unit_conditions());
    const double s2 = (kernel.width > 0.0 ? kernel.variance() : 0.0) + 1.0 / 12.0;
    // Lattice and bins change s^2 by 1/25 of h^2/12 and the fourth order of h/w: below 1 %.
    EXPECT_NEAR(field.shear_rate_z, -twist * (r + s2 / r), 0.01 * twist * s2 / r);
    EXPECT_NEAR(field.shear_rate_r, 0.0, 1e-11);
    EXPECT_NEAR(field.shear_rate, twist * r, 1.01 * twist * s2 / r);
    EXPECT_NEAR(field.velocity, flow(r, grid.height(k)), 1e-12);
  }
}

TEST(RingField, OuterGrainsThatDragInnerOnesGivePositiveShearStress) {
  InitialState initial;
  initial.grains = {{.position = at(12.6, 0.0, 3.5)}, {.position = at(13.4, 0.0, 3.5)}};
  RingSampler sampler(fine_bins({}));
  // The first, inner one is pulled along the azimuth, and up, by the second.
  const RingFrame frame =
      sampled(sampler, moving(initial), {{0, 1, {-0.8, 0.0, 0.0}, {-3.0, 2.0, 1.0}}});
  CellMoments all;
  for (const CellMoments& cell : frame.cells) add_cell(all, cell, 0.0, 0.0, 1.0);
  const RingField field = ring_field(all, 13.0, 1.0, unit_conditions());
  EXPECT_NEAR(field.shear_stress_r, 0.8 * 2.0, 1e-12);
  EXPECT_NEAR(field.shear_stress_z, 0.0, 1e-12);
  EXPECT_NEAR(field.pressure, 0.8 * 3.0 / 3.0, 1e-12);
  EXPECT_NEAR(field.friction, 1.6 / 0.8, 1e-12);
  EXPECT_NEAR(field.coordination, 1.0, 1e-12);
}

TEST(RingCell, NormalStressAtRestIsTheWeightAbove) {
  // Smooth walls take no weight.
  const auto law = smooth(soft);
  const Scene scene = with(small_ring(), law, 50.0);
  const InitialState packing = initial_state(scene);
  Simulation simulation(law, *settling_setup(scene, packing), packing);
  run_until(simulation, 20.0);
  RingBins bins = *ring_bins(scene);
  bins.kernel = {};  // averages over cells
  RingSampler sampler(bins);
  const double start = simulation.time();
  const double speed = std::sqrt(2.0 * simulation.kinetic_energy() / grains(scene));
  std::vector<ContactSample> contacts;
  while (simulation.time() < start + 3.0) {
    contacts.clear();
    simulation.step([&](std::uint32_t i, std::uint32_t j, const Vec3& branch, const Vec3& force) {
      contacts.push_back({i, j, branch, force});
    });
    sampler.sample(simulation.particles(), simulation.setup().dynamics, contacts);
  }
  const double acceleration = 2.0 * speed / (simulation.time() - start);  // mean, of all, at most
  EXPECT_LT(acceleration, 0.01);
  const RingGrid& grid = sampler.grid();
  const RingFrame frame = sampler.finish();
  double above = 0.0;  // mass
  int compared = 0;
  for (std::size_t k = grid.rows; k-- > 0;) {
    CellMoments row;
    for (std::size_t i = 0; i < grid.columns; ++i) {
      add_cell(row, frame.cells[grid.index(i, k)], 0.0, 0.0, 1.0);
    }
    // Averaged over the row: a grain in it counts by the share of the row below.
    const double carried = above + 0.5 * row.mass + row.mass_offset[1] / grid.width;
    above += row.mass;
    if (grid.height(k) < 0.0 || row.mass < 1.0) continue;  // contacts with the bottom are below
    const RingField field = ring_field(row, 5.5, grid.width, unit_conditions());  // times area
    EXPECT_NEAR(field.normal_stress, carried, acceleration * grains(scene)) << grid.height(k);
    ++compared;
  }
  EXPECT_NEAR(above, grains(scene), 1e-9);
  EXPECT_GE(compared, 2);
}

Scene short_ring() {
  Scene scene = small_ring();
  scene.measurement.averaging_time = 20.0;
  scene.measurement.time_limit = 24.0;
  return scene;
}

TEST(RingCell, AngularVelocityGoesFromThatOfTheOuterWallToRest) {
  const Scene scene = short_ring();
  const auto& cell = std::get<SplitBottom>(scene.geometry);
  const LocalData data = run(scene);
  ASSERT_TRUE(data.ring);
  const RingGrid& grid = data.ring->grid;
  ASSERT_EQ(data.ring->values.size(), grid.size());
  ASSERT_EQ(data.ring->errors.size(), grid.size());
  int filled = 0;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const RingField& field = data.ring->values[k];
    const RingField& error = data.ring->errors[k];
    if (!(field.volume_fraction > 0.3)) continue;
    EXPECT_GE(field.angular_velocity, -4.0 * error.angular_velocity);
    EXPECT_LE(field.angular_velocity, cell.rotation_rate + 4.0 * error.angular_velocity);
    EXPECT_GE(field.temperature, 0.0);
    EXPECT_GT(error.pressure, 0.0);
    ++filled;
  }
  EXPECT_GE(filled, 8);
}

TEST(RingCell, RunThatGoesOnFromACheckpointHasTheSameFields) {
  const Scene scene = short_ring();
  const LocalData whole = run(scene);
  Checkpoint kept;
  RunOptions stopping;
  stopping.observer = [](const Progress& p) { return p.settling || p.time < 10.0; };
  stopping.save = [&](const Checkpoint& checkpoint) { kept = checkpoint; };
  run(scene, stopping);
  RunOptions resuming;
  resuming.resume = &kept;
  const LocalData again = run(scene, resuming);
  ASSERT_TRUE(whole.ring && again.ring);
  ASSERT_EQ(whole.ring->values.size(), again.ring->values.size());
  for (std::size_t k = 0; k < whole.ring->values.size(); ++k) {
    const RingField &a = whole.ring->values[k], &b = again.ring->values[k];
    if (std::isnan(a.velocity)) continue;
    EXPECT_EQ(a.velocity, b.velocity);
    EXPECT_EQ(a.shear_stress, b.shear_stress);
    EXPECT_EQ(whole.ring->errors[k].friction, again.ring->errors[k].friction);
  }
}

}  // namespace
}  // namespace grainlaw::dem
