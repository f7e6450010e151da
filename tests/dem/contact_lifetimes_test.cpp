// Are contacts followed from their begin to their end, and nothing else changed?
#include "dem/contact_lifetimes.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "dem/run.h"
#include "dem/statistics.h"
#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

Scene followed(Scene scene, std::vector<double> distances = {1.0, 1.001, 1.01, 1.02}) {
  scene.lifetimes = Lifetimes{.contact_distances = std::move(distances)};
  return scene;
}

/// Lifetimes in free space over a time: one definition for every gap, everywhere.
LifetimeStatistics lifetimes_of(const std::vector<InitialGrain>& grains,
                                const Hooke& law,
                                const std::vector<double>& distances,
                                double duration) {
  InitialState initial;
  initial.grains = grains;
  Scene scene = followed(with(small_shear(std::nullopt), smooth(law), 50.0), distances);
  Simulation simulation(smooth(law), free_space(scene.time_step), initial);
  ContactLifetimes lifetimes(scene);
  while (simulation.time() < duration) {
    simulation.step();
    lifetimes.follow(simulation);
  }
  lifetimes.end_frame(simulation.time());
  LocalData data;
  data.rows.emplace_back().shear_rate = {1.0, 0.0};
  return lifetimes.finish(data);
}

/// Of the integrator at 50 steps per contact: its frequency is off by (omega dt)^2 / 24, and a path
/// curved by the dashpot is taken as straight over the two steps between looks, by its end: from
/// there the begin is off by gamma (2 dt)^2 / 2 at most; what follows the end is free flight.
double timing_error(const Hooke& law) {
  const double dt = law.contact_time(0.5) / 50.0;
  const double phase = std::numbers::pi / 50.0;
  return law.contact_time(0.5) * phase * phase / 24.0 + 2.0 * law.damping * dt * dt;
}

TEST(ContactLifetimes, CollisionOfTwoGrainsLastsItsCollisionTime) {
  const double speed = 1.3;
  const std::vector<InitialGrain> grains = {
      {.position = {}, .velocity = {0.5 * speed, 0.0, 0.0}},
      {.position = {1.0305, 0.0, 0.0}, .velocity = {-0.5 * speed, 0.0, 0.0}}};
  const std::vector<double> distances{1.0, 1.001, 1.01, 1.02};
  for (const Hooke& law : {soft, stiff}) {
    const LifetimeStatistics all = lifetimes_of(grains, law, distances, 0.2);
    ASSERT_EQ(all.distances.size(), distances.size());
    for (std::size_t k = 0; k < distances.size(); ++k) {
      const LifetimeDistribution& d = all.distances[k];
      const double gap = distances[k] - 1.0;
      const double flight = gap / speed * (1.0 + 1.0 / law.restitution(0.5));
      EXPECT_EQ(d.contacts, 1.0);
      EXPECT_EQ(d.unknown, 0.0);
      EXPECT_NEAR(d.distance, distances[k], 1e-15);
      // The speed of separation has an error of its own: (omega dt)^2 / 2 of what damping takes.
      const double slower = std::pow(std::numbers::pi / 50.0, 2) / 2.0 * 0.12;
      EXPECT_NEAR(
          d.mean.value, law.collision_time(0.5) + flight, timing_error(law) + slower * flight)
          << distances[k];
    }
  }
}

TEST(ContactLifetimes, HeadOnCollisionsAtAnySpeedLastEquallyLong) {
  std::vector<InitialGrain> grains;
  constexpr int pairs = 6;
  for (int k = 0; k < pairs; ++k) {
    const double y = 3.0 * k;
    const double speed = 0.1 * (k + 1);
    grains.push_back({.position = {0.0, y, 0.0}, .velocity = {0.5 * speed, 0.0, 0.0}});
    grains.push_back({.position = {1.01, y, 0.0}, .velocity = {-0.5 * speed, 0.0, 0.0}});
  }
  const LifetimeStatistics all = lifetimes_of(grains, soft, {1.0}, 0.3);
  const LifetimeDistribution& d = all.distances.front();
  EXPECT_EQ(d.contacts, pairs);
  ASSERT_EQ(d.rows.size(), 1u);  // all in one bin, of which the mode is the mean
  EXPECT_NEAR(d.mean.value, soft.collision_time(0.5), timing_error(soft));
  EXPECT_NEAR(d.mode.value, soft.collision_time(0.5), timing_error(soft));
}

TEST(ContactLifetimes, ContactsMetTooLateOrNotOverAreNotCountedAsShort) {
  const std::vector<InitialGrain> grains = {
      {.position = {}},  // overlap from the start: unknown age
      {.position = {0.99, 0.0, 0.0}},
      {.position = {0.0, 3.0, 0.0}, .velocity = {0.01, 0.0, 0.0}},  // touch just before the end
      {.position = {1.002, 3.0, 0.0}, .velocity = {-0.01, 0.0, 0.0}}};
  const LifetimeStatistics all = lifetimes_of(grains, soft, {1.0}, 0.102);
  const LifetimeDistribution& d = all.distances.front();
  EXPECT_EQ(d.contacts, 0.0);
  EXPECT_EQ(d.unknown, 1.0);
  EXPECT_EQ(d.unfinished, 1.0);
}

TEST(ContactLifetimes, EffectiveDistanceIsWhereTheWellCarriesAGrain) {
  Scene scene = followed(small_chute(23.0), {1.0});
  scene.lifetimes->effective_distance = true;
  scene.cohesion = GaussianWell{.strength = 0.6, .width = 0.01};
  // Brewster et al. (2008), below eq. 12: 1.014 d for A = 0.6.
  ASSERT_EQ(contact_gaps(scene).size(), 2u);
  EXPECT_NEAR(contact_gaps(scene).back(), 0.014, 0.0005);
  scene.cohesion = GaussianWell{.strength = 0.01, .width = 0.01};
  EXPECT_EQ(contact_gaps(scene).size(), 1u);  // too weak: d itself
  scene.cohesion = Cohesionless{};
  EXPECT_THROW(validate(scene), SceneError);
}

TEST(ContactLifetimes, ScenesWithoutOneShearRateInASliceAreRefused) {
  EXPECT_THROW(validate(followed(small_force_box())), SceneError);
  EXPECT_THROW(validate(followed(small_ring())), SceneError);
  EXPECT_THROW(validate(followed(small_chute(23.0), {0.99})), SceneError);
  EXPECT_THROW(validate(followed(small_chute(23.0), {})), SceneError);
  Scene shear = followed(small_shear(10.0));
  EXPECT_NO_THROW(validate(shear));
  shear.lifetimes->slice_centre = 1.0;
  EXPECT_THROW(validate(shear), SceneError);
}

/// A contact slips where its tangential force is at the limit.
TEST(ContactLifetimes, SlippingIsSeenFromTheForce) {
  InitialState initial;
  initial.grains = {{.position = {}}, {.position = {-0.99, 0.0, 0.0}}};
  const auto sample = [](double tangential) {
    return ContactSample{0, 1, {0.99, 0.0, 0.0}, {10.0, 0.0, tangential}};
  };
  Simulation rubbing(rough(soft, 0.5), free_space(1e-4), initial);
  EXPECT_TRUE(slips(rough(soft, 0.5), rubbing.particles(), sample(5.0)));
  EXPECT_FALSE(slips(rough(soft, 0.5), rubbing.particles(), sample(4.99)));
  EXPECT_FALSE(slips(smooth(soft), rubbing.particles(), sample(0.0)));
  // Bound by the part above the pull: 10 + 20 without adhesion.
  const ContactLaw dry{soft,
                       ReversibleAdhesion{.largest_force = 20.0, .slope = 500.0},
                       sliding(0.5, soft.stiffness)};
  EXPECT_TRUE(slips(dry, rubbing.particles(), sample(15.0)));
  EXPECT_FALSE(slips(dry, rubbing.particles(), sample(5.0)));
}

/// A chute 6 d deep, followed in its middle two bins.
Scene flowing_chute() {
  Scene scene = followed(small_chute(27.0, 170));
  std::get<Chute>(scene.geometry).length = 5.0;
  std::get<Chute>(scene.geometry).width = 5.0;
  scene.lifetimes->slice_centre = 3.0;
  scene.lifetimes->slice_half_width = 1.0;
  scene.measurement.averaging_time = 40.0;
  scene.measurement.time_limit = 60.0;
  return scene;
}

/// Z of the bins between two heights, from the counts of the fields, with its error.
Estimate coordination(const LocalData& data, double low, double high) {
  std::vector<double> series;
  for (const ProfileFrame& frame : data.frames.frames) {
    if (frame.begin < data.window.begin) continue;
    double contacts = 0.0, mass = 0.0;
    for (std::size_t k = 0; k < frame.bins.size(); ++k) {
      const double z = data.frames.bin_centre(k);
      if (z < low || z > high) continue;
      contacts += frame.bins[k].contacts;
      mass += frame.bins[k].mass;
    }
    series.push_back(contacts / mass);
  }
  const BlockAverage average = block_average(series);
  return {average.mean, average.error};
}

void expect_identity(const LocalData& data, const Estimate& z) {
  const LifetimeDistribution& d = data.lifetimes->distances.front();
  const double product = d.collision_rate.value * d.mean.value;
  const double error =
      std::hypot(z.error,
                 product * std::hypot(d.collision_rate.error / d.collision_rate.value,
                                      d.mean.error / d.mean.value));
  EXPECT_NEAR(product, z.value, 4.0 * error);
  EXPECT_LT(error, 0.1 * z.value);
}

TEST(ContactLifetimes, CollisionRateTimesMeanLifetimeIsTheCoordination) {
  const LocalData chute = run(flowing_chute());
  expect_identity(chute, coordination(chute, 2.0, 4.0));
  Scene box = followed(small_shear(10.0, 200), {1.0});
  box.measurement.averaging_time = 30.0;
  box.measurement.time_limit = 35.0;
  const LocalData sheared = run(box);
  expect_identity(sheared, coordination(sheared, -INFINITY, INFINITY));

  // Wider definitions join what a narrow one takes apart; few contacts are met too late.
  const auto& distances = chute.lifetimes->distances;
  for (std::size_t k = 0; k < distances.size(); ++k) {
    const LifetimeDistribution& d = distances[k];
    if (k > 0) {
      EXPECT_GT(d.mean.value, distances[k - 1].mean.value);
    }
    EXPECT_LT(d.unknown, 1e-3 * d.contacts);
    EXPECT_LT(d.survivors, 1e-3);
  }
  const LifetimeDistribution& touching = distances.front();
  EXPECT_NEAR(touching.mode.value, soft.collision_time(0.5), 0.05 * soft.collision_time(0.5));
  EXPECT_GT(touching.long_shear.value, touching.long_share.value);
  EXPECT_GT(touching.long_sliding.value, 0.0);
  EXPECT_LT(touching.long_sliding.value, 1.0);
}

std::vector<double> numbers(const LifetimeStatistics& all) {
  std::vector<double> n{all.begin, all.end, all.shear_rate, all.grains};
  const auto add = [&](const Estimate& x) { n.insert(n.end(), {x.value, x.error}); };
  for (const LifetimeDistribution& d : all.distances) {
    n.insert(n.end(), {d.distance, d.contacts, d.unknown, d.unfinished, d.survivors, d.split});
    add(d.mean), add(d.mode), add(d.collision_rate), add(d.long_shear), add(d.long_normal);
    add(d.long_lifetime[1]), add(d.long_sliding), add(d.short_sliding);
    for (const LifetimeRow& row : d.rows) {
      n.insert(n.end(), {row.begin, row.contacts, row.shear_share, row.normal_share});
      add(row.density);
    }
  }
  return n;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

bool same_frames(const LocalData& a, const LocalData& b) {
  if (a.frames.frames.size() != b.frames.frames.size()) return false;
  for (std::size_t k = 0; k < a.frames.frames.size(); ++k) {
    const ProfileFrame& x = a.frames.frames[k];
    const ProfileFrame& y = b.frames.frames[k];
    if (x.bins.size() != y.bins.size() ||
        std::memcmp(x.bins.data(), y.bins.data(), x.bins.size() * sizeof(BinMoments)) != 0) {
      return false;
    }
  }
  return true;
}

TEST(ContactLifetimes, RunThatIsTakenUpGivesTheSameAndFollowingChangesNoPath) {
  Scene cohesive = followed(small_shear(10.0, 150));
  cohesive.cohesion = GaussianWell{.strength = 0.1, .width = 0.01};
  for (Scene scene : {followed(small_chute(27.0)), followed(small_shear(10.0, 150)), cohesive}) {
    scene.measurement.averaging_time = 8.0;
    scene.measurement.time_limit = 10.0;
    const LocalData whole = run(scene);
    ASSERT_GT(whole.lifetimes->distances.front().contacts, 100.0) << kind(scene.geometry);
    Checkpoint checkpoint;
    RunOptions stop;
    stop.observer = [](const Progress& p) { return p.settling || p.time < 4.0; };
    stop.save = [&](const Checkpoint& saved) { checkpoint = saved; };
    run(scene, stop);
    RunOptions resume;
    resume.resume = &checkpoint;
    EXPECT_TRUE(same_bits(numbers(*whole.lifetimes), numbers(*run(scene, resume).lifetimes)))
        << kind(scene.geometry);

    scene.lifetimes.reset();
    const LocalData alone = run(scene);
    EXPECT_FALSE(alone.lifetimes.has_value());
    EXPECT_TRUE(same_frames(whole, alone));
  }
}

}  // namespace
}  // namespace grainlaw::dem
