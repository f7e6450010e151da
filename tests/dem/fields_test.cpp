#include "dem/fields.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dem/coarse_graining.h"
#include "dem/local_data.h"
#include "dem/run.h"
#include "dem/statistics.h"
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

/// The whole weight at once: what carries the mass above a row is the stress in it and the walls
/// above it.
double imbalance_zz(const FieldRow& row, double weight_of_mass) {
  return row.normal_stress + row.wall_force_above[2] - weight_of_mass * row.mass_above;
}
double imbalance_xz(const FieldRow& row, double pull_of_mass) {
  return row.shear_stress - row.wall_force_above[0] - pull_of_mass * row.mass_above;
}

/// A chute on 5 d by 5 d, 6 d deep, in steady flow.
const LocalData& steady_chute() {
  static const LocalData data = [] {
    Scene scene = small_chute(25.0, 170);
    std::get<Chute>(scene.geometry).length = 5.0;
    std::get<Chute>(scene.geometry).width = 5.0;
    scene.measurement.averaging_time = 100.0;
    scene.measurement.time_limit = 400.0;
    return run(scene);
  }();
  return data;
}

/// Stress, weight and walls balance where the kernel reaches into the base and above the surface
/// as they do in the bulk. The base takes the whole weight, so the rows next to it would be off by
/// all of it without the wall force.
TEST(SteadyChute, CarriesItsWeightInEveryRowAtEveryWidthOfBothKernels) {
  const LocalData& data = steady_chute();
  const double theta = data.conditions.inclination;
  const double base_pressure = data.conditions.mass_per_area * std::cos(theta);
  ASSERT_TRUE(data.window.steady) << data.window.reason;
  std::vector<WidthFields> all = data.fields;
  ASSERT_EQ(all.size(), 3u);
  ProfileFrames frames = data.frames;  // another kernel, after the fact
  frames.kernel.shape = KernelShape::gaussian;
  for (WidthFields& fields : fields_at_widths(frames, data.conditions, data.window)) {
    all.push_back(std::move(fields));
  }
  for (const WidthFields& fields : all) {
    for (std::size_t k = 0; k < fields.values.size(); ++k) {
      const FieldRow& row = fields.values[k];
      const FieldRow& error = fields.errors[k];
      const double sampling = std::hypot(error.normal_stress, error.wall_force_above[2]);
      EXPECT_LE(std::abs(imbalance_zz(row, std::cos(theta))),
                std::max(1e-3 * base_pressure, 3.0 * sampling))
          << "w = " << fields.width << ", row " << k;
      // The mean velocity may still change by three errors over the window.
      const double speeding = 3.0 * data.rows.back().velocity.error *
                              data.conditions.mass_per_area / (data.window.end - data.window.begin);
      const double pull = std::hypot(error.shear_stress, error.wall_force_above[0]);
      EXPECT_LE(std::abs(imbalance_xz(row, std::sin(theta))),
                std::max(1e-3 * base_pressure, 3.0 * pull) + speeding)
          << "w = " << fields.width << ", row " << k;
    }
  }
}

TEST(SteadyChute, FrictionIsTheSlopeThroughTheBulk) {
  const LocalData& data = steady_chute();
  const double slope = std::tan(data.conditions.inclination);
  for (const WidthFields& fields : data.fields) {
    double densest = 0.0;
    for (const FieldRow& row : fields.values) densest = std::max(densest, row.density);
    int bulk = 0;
    for (std::size_t k = 0; k < fields.values.size(); ++k) {
      if (fields.values[k].density < 0.9 * densest) continue;
      EXPECT_NEAR(fields.values[k].friction,
                  slope,
                  std::max(0.01 * slope, 3.0 * fields.errors[k].friction));
      ++bulk;
    }
    EXPECT_GE(bulk, 2);
  }
}

TEST(SteadyChute, BothPressuresAreGivenAndAgreeInADenseFlow) {
  for (const LocalRow& row : steady_chute().rows) {
    if (row.volume_fraction.value < 0.5) continue;
    // Normal stresses of dense chutes differ by up to a tenth (Silbert et al. 2001, fig. 8).
    EXPECT_NEAR(row.pressure.value, row.normal_stress.value, 0.1 * row.normal_stress.value);
    EXPECT_NE(row.pressure.value, row.normal_stress.value);
  }
}

TEST(SteadyChute, ContactsDissipateWhatGravityPutsIn) {
  // Energy balance of steady flow over the whole layer, frame by frame: g sin(theta) times the flux
  // goes into contacts. What springs of contacts still hold at their end is not in their
  // dissipation; it is lost too, and bounded by mu F delta_t / 2 of a contact.
  const LocalData& data = steady_chute();
  std::vector<double> missing;
  double work = 0.0, sliding = 0.0, dissipation = 0.0;
  for (const ProfileFrame& frame : data.frames.frames) {
    if (frame.begin < data.window.begin) continue;
    double lost = 0.0, gained = 0.0;
    for (std::size_t k = 0; k < frame.bins.size(); ++k) {
      lost += frame.bins[k].dissipation;
      gained += frame.bins[k].momentum[0] * std::sin(data.conditions.inclination);
      sliding += frame.sliding[k].dissipation;
    }
    work += gained;
    dissipation += lost;
    missing.push_back(gained - lost);
  }
  const BlockAverage average = block_average(missing);
  const double frames = static_cast<double>(missing.size());
  EXPECT_NEAR(average.mean, 0.0, 4.0 * average.error);
  EXPECT_LT(average.error, 0.05 * work / frames);  // it says something
  EXPECT_GT(sliding, 0.1 * dissipation);
  EXPECT_LT(sliding, 0.9 * dissipation);
  for (const LocalRow& row : data.rows) {
    if (row.volume_fraction.value < 0.5) continue;
    EXPECT_GT(row.sliding_share.value, 0.02);
    EXPECT_LT(row.sliding_share.value, 0.9);
    EXPECT_GT(row.dissipation.value, 0.0);
  }
}

TEST(ContactLoss, OfAllContactsIsWhatTheLedgerBooks) {
  const auto law = rough(soft, 0.5);
  const Scene scene = with(small_shear(10.0), law, 50.0);
  Simulation box = flow(scene, law);
  run_until(box, 2.0);
  const double before = box.ledger().normal_dashpot + box.ledger().slip;
  double told = 0.0, slid = 0.0;
  const double slip_before = box.ledger().slip;
  for (int k = 0; k < 50; ++k) {
    box.step([&](std::uint32_t, std::uint32_t, const Vec3&, const Vec3&, const ContactLoss& loss) {
      told += loss.all;
      slid += loss.sliding;
    });
  }
  const EnergyLedger& after = box.ledger();
  EXPECT_NEAR(told, after.normal_dashpot + after.slip - before, 1e-11 * before);
  EXPECT_NEAR(slid, after.slip - slip_before, 1e-11 * before);
  EXPECT_GT(slid, 0.0);
}

TEST(FrictionlessFlow, StoresNothingAboutSliding) {
  Scene scene = small_shear(10.0);
  scene.friction = Frictionless{};
  scene.measurement.averaging_time = 10.0;
  scene.measurement.time_limit = 20.0;
  const LocalData data = run(scene);
  for (const ProfileFrame& frame : data.frames.frames) EXPECT_TRUE(frame.sliding.empty());
  ASSERT_EQ(data.rows.size(), 1u);
  EXPECT_TRUE(std::isnan(data.rows.front().sliding_share.value));
  EXPECT_GT(data.rows.front().dissipation.value, 0.0);
}

}  // namespace
}  // namespace grainlaw::dem
