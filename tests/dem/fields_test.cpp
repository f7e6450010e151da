#include "dem/fields.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dem/coarse_graining.h"
#include "dem/local_data.h"
#include "dem/run.h"
#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

constexpr double area = 16.0;
const Bins fine_bins{.begin = -2.0, .width = 0.25, .area = area, .count = 40};

std::vector<Kernel> kernels() {
  std::vector<Kernel> all;
  for (const KernelShape shape : {KernelShape::lucy, KernelShape::gaussian}) {
    for (const double width : {0.5, 1.0, 2.0}) all.push_back({shape, width});
  }
  return all;
}

ProfileFrames grid_of(const Bins& bins, std::size_t bins_per_row) {
  return {.z_begin = bins.begin,
          .bin_width = bins.width,
          .frames = {},
          .bins_per_row = bins_per_row,
          .periodic = bins.periodic};
}

ChuteConditions unit_conditions() {
  ChuteConditions conditions;
  conditions.grain_density = 1.0;
  conditions.stiffness = 1.0;
  return conditions;
}

Particles at_rest_or_moving(const InitialState& initial) {
  Particles particles = make_particles(initial, unit_density, false);
  restart_half_step(particles, {});
  return particles;
}

FrameMoments sampled(const Bins& bins,
                     const Particles& particles,
                     const std::vector<ContactSample>& contacts = {}) {
  FrameSampler sampler(bins.count);
  sampler.sample(bins, particles, {}, contacts);
  return {sampler.finish().bins, {}};
}

/// Grains at heights without a pattern, and contacts between them that are no real ones: sums do
/// not care.
struct Heap {
  Particles particles;
  std::vector<ContactSample> contacts;
};
Heap make_heap() {
  InitialState initial;
  for (std::size_t k = 0; k < 60; ++k) {
    const Vec3 place = 2.0 * scatter(k);
    initial.grains.push_back(
        {.position = place + Vec3{0.0, 0.0, 3.0}, .velocity = 3.0 * scatter(k + 100)});
  }
  for (std::size_t k = 0; k < 10; ++k) {
    initial.grains.push_back({.position = scatter(k + 300), .body = Body::base});
  }
  Heap heap{at_rest_or_moving(initial), {}};
  for (std::uint32_t k = 0; k < 60; ++k) {
    const std::uint32_t other = k % 3 == 0 ? 60 + k % 10 : (k + 7) % 60;
    if (other == k) continue;
    heap.contacts.push_back({k, other, 0.9 * scatter(k + 200), 5.0 * scatter(k + 400)});
  }
  return heap;
}

/// Sums over the grains and contacts of a heap.
struct Sums {
  double mass = 0.0;
  Vec3 momentum;
  std::array<double, 9> contact_stress{};  // xx yy zz xy xz yz yx zx zy
  Vec3 wall_force;
};
Sums sums_of(const Heap& heap) {
  Sums sums;
  for (std::size_t i = 0; i < heap.particles.mobile; ++i) {
    const double mass = 1.0 / heap.particles.state[i].inverse_mass;
    sums.mass += mass;
    sums.momentum += mass * velocity(heap.particles, i, Dynamics{});
  }
  for (const ContactSample& contact : heap.contacts) {
    const bool wall = heap.particles.state[contact.second].inverse_mass == 0.0;
    const Vec3 b = (wall ? 0.5 : 1.0) * contact.branch;
    const Vec3& f = contact.force;
    const std::array<double, 9> dyad{f.x * b.x,
                                     f.y * b.y,
                                     f.z * b.z,
                                     f.x * b.y,
                                     f.x * b.z,
                                     f.y * b.z,
                                     f.y * b.x,
                                     f.z * b.x,
                                     f.z * b.y};
    for (std::size_t k = 0; k < 9; ++k) sums.contact_stress[k] += dyad[k];
    if (wall) sums.wall_force += f;
  }
  return sums;
}

TEST(CoarseGrain, SumsOverRowsAreTheSumsOverGrainsAndContacts) {
  const Heap heap = make_heap();
  const FrameMoments moments = sampled(fine_bins, heap.particles, heap.contacts);
  const Sums sums = sums_of(heap);
  constexpr double rounding = 1e-12;
  for (const Kernel& kernel : kernels()) {
    const ProfileFrames grid = grid_of(fine_bins, 4);
    const double volume = grid.row_width() * area;
    Sums fields;
    for (const FieldRow& row : coarse_grain(moments, grid, kernel, unit_conditions())) {
      fields.mass += volume * row.density;
      fields.momentum += volume * Vec3{row.momentum[0], row.momentum[1], row.momentum[2]};
      fields.wall_force += volume * Vec3{row.wall_force[0], row.wall_force[1], row.wall_force[2]};
      for (std::size_t k = 0; k < 9; ++k) {
        fields.contact_stress[k] += volume * row.contact_stress[k];
      }
    }
    EXPECT_NEAR(fields.mass, sums.mass, rounding * sums.mass);
    EXPECT_LT(length(fields.momentum - sums.momentum), rounding * sums.mass);
    EXPECT_LT(length(fields.wall_force - sums.wall_force), rounding * 100.0);
    for (std::size_t k = 0; k < 9; ++k) {
      EXPECT_NEAR(fields.contact_stress[k], sums.contact_stress[k], rounding * 100.0);
    }
  }
}

TEST(CoarseGrain, PeriodicAxisKeepsTheSumsToo) {
  const Bins around{.axis = ProfileAxis::y,
                    .periodic = true,
                    .begin = -2.0,
                    .width = 0.25,
                    .area = area,
                    .count = 16};  // shorter than the widest kernel reaches
  const Heap heap = make_heap();
  const FrameMoments moments = sampled(around, heap.particles, heap.contacts);
  const Sums sums = sums_of(heap);
  for (const Kernel& kernel : kernels()) {
    double mass = 0.0, stress_xy = 0.0;
    const ProfileFrames grid = grid_of(around, 4);
    for (const FieldRow& row : coarse_grain(moments, grid, kernel, unit_conditions())) {
      mass += grid.row_width() * area * row.density;
      stress_xy += grid.row_width() * area * row.contact_stress[3];
    }
    EXPECT_NEAR(mass, sums.mass, 1e-12 * sums.mass);
    EXPECT_NEAR(stress_xy, sums.contact_stress[3], 1e-10);
  }
}

/// Grains at heights without a pattern, moving as the field of a flow says.
template <class Flow>
Particles flowing(std::size_t grains, Flow&& flow) {
  InitialState initial;
  for (std::size_t k = 0; k < grains; ++k) {
    const Vec3 place = 2.0 * scatter(k) + Vec3{0.0, 0.0, 3.0};
    initial.grains.push_back({.position = place, .velocity = flow(place.z)});
  }
  return at_rest_or_moving(initial);
}

TEST(CoarseGrain, AffineFlowHasNoFluctuationAtAnyWidth) {
  const auto flow = [](double z) { return Vec3{0.3 + 0.7 * z, -0.2 * z, 0.05 * z}; };
  const FrameMoments moments = sampled(fine_bins, flowing(40, flow));
  constexpr double speed2 = 16.0;  // of the fastest: what is subtracted
  for (const Kernel& kernel : kernels()) {
    const ProfileFrames grid = grid_of(fine_bins, 4);
    const auto rows = coarse_grain(moments, grid, kernel, unit_conditions());
    const std::size_t margin = margin_rows(grid, kernel);
    int filled = 0;
    for (std::size_t k = 3; k < 7; ++k) {  // z from 1 to 5: where grains are
      const FieldRow& row = rows[k + margin];
      const double z = grid.row_centre(k);
      ASSERT_GT(row.density, 0.0);
      EXPECT_NEAR(row.temperature, 0.0, 1e-14 * speed2);
      for (const double stress : row.kinetic_stress) {
        EXPECT_NEAR(stress, 0.0, 1e-14 * speed2 * row.density);
      }
      EXPECT_NEAR(row.velocity, 0.3 + 0.7 * z, 1e-12);
      EXPECT_NEAR(row.shear_rate, 0.7, 1e-12);
      EXPECT_NEAR(row.velocity_gradient[1], -0.2, 1e-12);
      ++filled;
    }
    EXPECT_EQ(filled, 4);
  }
}

/// Grains closely at equal distances, all over the bins and 10 d beyond.
template <class Flow>
FrameMoments dense_flow(const Bins& bins, Flow&& flow) {
  InitialState initial;
  constexpr int per_bin = 200;
  const double distance = bins.width / per_bin;
  for (int k = 0; k < per_bin * static_cast<int>(bins.count); ++k) {
    const double z = bins.begin + (k + 0.5) * distance;
    initial.grains.push_back({.position = {0.0, 0.0, z}, .velocity = flow(z)});
  }
  return sampled(bins, at_rest_or_moving(initial));
}

TEST(CoarseGrain, CurvedFlowLeavesTheSquareOfWhatTheKernelRounds) {
  // v = q z^2 around a line through its neighbourhood: v - V = q (o^2 - s^2), o the distance from
  // the middle of a bin and s^2 the variance of kernel and bin. The mean square over a bin of width
  // h is q^2 (s^4 - s^2 h^2 / 6 + h^4 / 80).
  constexpr double q = 0.4;
  const Bins tall{.begin = -10.0, .width = 0.25, .area = area, .count = 80};
  const FrameMoments moments = dense_flow(tall, [](double z) { return Vec3{q * z * z, 0.0, 0.0}; });
  const double h2 = tall.width * tall.width;
  for (const Kernel& kernel : kernels()) {
    const ProfileFrames grid = grid_of(tall, 4);
    const std::size_t middle = margin_rows(grid, kernel) + 10;
    const FieldRow row = coarse_grain(moments, grid, kernel, unit_conditions())[middle];
    const double s2 = kernel.variance() + h2 / 12.0;
    const double left = q * q * (s2 * s2 - s2 * h2 / 6.0 + h2 * h2 / 80.0);
    EXPECT_NEAR(row.temperature, left / 3.0, 1e-3 * left) << kernel.width;
    EXPECT_NEAR(row.kinetic_stress[2], 0.0, 1e-12);
    EXPECT_NEAR(row.kinetic_stress[4], 0.0, 1e-12);
  }
}

TEST(CoarseGrain, HomogeneousBoxSubtractsTheMeanVelocityOnly) {
  const Bins box{.axis = ProfileAxis::y,
                 .periodic = true,
                 .begin = -2.0,
                 .width = 4.0,
                 .area = area,
                 .count = 1};
  const Particles gas = flowing(50, [](double z) { return scatter(std::lround(1e6 * z)); });
  const FieldRow row =
      coarse_grain(sampled(box, gas), grid_of(box, 1), Kernel{}, unit_conditions()).front();
  Vec3 mean;
  double square_sum = 0.0;
  for (std::size_t i = 0; i < 50; ++i) {
    mean += 0.02 * velocity(gas, i, Dynamics{});
    square_sum += 0.02 * square(velocity(gas, i, Dynamics{}));
  }
  // The box as a whole may drift: nothing in it feels that.
  EXPECT_NEAR(row.velocity, 0.0, 1e-14);
  EXPECT_NEAR(row.temperature, (square_sum - square(mean)) / 3.0, 1e-13);
}

TEST(CoarseGrain, FabricAndCoordinationAreThoseOfTheContacts) {
  const Heap heap = make_heap();
  const ProfileFrames grid = grid_of(fine_bins, 40);  // one row of all
  const FieldRow row =
      coarse_grain(
          sampled(fine_bins, heap.particles, heap.contacts), grid, Kernel{}, unit_conditions())
          .front();
  double incidences = 0.0, fabric_xz = 0.0;
  for (const ContactSample& contact : heap.contacts) {
    if (square(contact.branch) >= 1.0) continue;  // not touching
    const bool wall = heap.particles.state[contact.second].inverse_mass == 0.0;
    const double ends = wall ? 1.0 : 2.0;
    incidences += ends;
    fabric_xz += ends * contact.branch.x * contact.branch.z / square(contact.branch);
  }
  EXPECT_NEAR(row.coordination, incidences / 60.0, 1e-12);
  EXPECT_NEAR(row.fabric[4], fabric_xz / incidences, 1e-12);
  EXPECT_NEAR(row.fabric[0] + row.fabric[1] + row.fabric[2], 1.0, 1e-12);
  EXPECT_TRUE(std::isnan(row.sliding_share));
}
}  // namespace
}  // namespace grainlaw::dem
