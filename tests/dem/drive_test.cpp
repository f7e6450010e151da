// Do moving boundaries do what they are asked, and does it not matter where the box was cut?
#include "dem/drive.h"

#include <gtest/gtest.h>

#include <iostream>

#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

InitialState in_box(const Vec3& period, std::vector<InitialGrain> grains) {
  InitialState state{.box = {}, .grains = std::move(grains)};
  state.box.period = period;
  return state;
}

double default_step(const Hooke& law) {
  return law.contact_time(0.5) / 50.0;
}

TEST(LeesEdwards, GrainAtRestIsHitByTheMovingImageOfAnother) {
  SimulationSetup setup = free_space(default_step(soft));
  setup.drive = BoxDrive{.shear_rate = 1.0};
  // The image of the lower grain above lies 0.5 d higher than the upper one and comes along x with
  // speed 5 from 4 d away.
  Simulation box(
      smooth(soft),
      setup,
      in_box({10.0, 5.0, 5.0}, {{.position = {6.0, 4.7, 2.5}}, {.position = {2.0, 0.2, 2.5}}}));
  run_until(box, 0.6);  // it has come 3 d near: contact begins at a distance of sqrt(1 - 0.25) d
  EXPECT_EQ(box.acting_pairs(), 0u);
  run_until(box, 1.0);
  EXPECT_GT(motions(box).velocity[0].x, 1.0);
}

TEST(LeesEdwards, GrainAtRestIsHitByTheImageThatComesDownWithTheBox) {
  SimulationSetup setup = free_space(default_step(soft));
  setup.drive = BoxDrive{.height_rate = -5.0};
  Simulation box(
      smooth(soft),
      setup,
      in_box({5.0, 5.0, 5.0}, {{.position = {2.5, 2.0, 2.5}}, {.position = {2.5, 0.5, 2.5}}}));
  run_until(box, 0.45);  // the image above comes down from 5.5 d to 3.25 d; it touches at 3 d
  EXPECT_EQ(box.acting_pairs(), 0u);
  run_until(box, 0.52);
  EXPECT_LT(motions(box).velocity[0].y, -1.0);
}

TEST(WallDrive, WallUnderLoadHitsTheGrainItFallsOn) {
  SimulationSetup setup = free_space(default_step(soft));
  setup.drive = WallDrive{.load = 10.0};
  Simulation fall(smooth(soft),
                  setup,
                  {.box = {},
                   .grains = {{.position = {0.0, 0.0, 0.0}},
                              {.position = {0.0, 0.0, 3.0}, .body = Body::mover}}});
  run_until(fall, 0.6);  // falls 1.8 d
  EXPECT_EQ(fall.acting_pairs(), 0u);
  run_until(fall, 0.7);  // 2.45 d, where 2 d are free
  EXPECT_LT(motions(fall).velocity[0].z, -1.0);
}

TEST(LeesEdwards, ImagesMoveExactlyAtTheShearRate) {
  const auto law = rough(soft, 0.5);
  Simulation box = flow(with(small_shear(std::nullopt), law, 50.0), law);
  const Vec3 period = box.box().period;
  for (int k = 0; k < 3000; ++k) box.step();
  EXPECT_DOUBLE_EQ(box.box().top_velocity.x, 1.0 * period.y);
  EXPECT_EQ(box.box().period.y, period.y);
  const double periods = (box.time() * period.y - box.box().offset) / period.x;
  // The offset is a sum of 3000 terms.
  EXPECT_NEAR(periods, std::round(periods), 3000 * 1e-16 * 10);
}

/// Largest difference of peculiar velocities and spins of two sheared boxes.
double difference(const SimulationBase& a, const SimulationBase& b, double shear_rate) {
  const Motions of_a = motions(a);
  const Motions of_b = motions(b);
  const auto peculiar = [&](const Motions& m, std::size_t k) {
    return m.velocity[k] - Vec3{shear_rate * m.position[k].y, 0.0, 0.0};
  };
  const Vec3 shift = peculiar(of_a, 0) - peculiar(of_b, 0);  // of the frame
  double largest = 0.0;
  for (std::size_t k = 0; k < of_a.velocity.size(); ++k) {
    largest = std::max(largest, length(peculiar(of_a, k) - peculiar(of_b, k) - shift));
    largest = std::max(largest, length(of_a.spin[k] - of_b.spin[k]));
  }
  return largest;
}

/// A sheared box whose start is changed, after some contact times.
template <class Change>
auto sheared(Change&& change) {
  const auto law = rough(soft, 0.5);
  const Scene scene = with(small_shear(std::nullopt), law, 50.0);
  InitialState start = initial_state(scene);
  const SimulationSetup setup = flow_setup(scene, start);
  for (std::size_t k = 0; k < start.grains.size(); ++k) start.grains[k].velocity += scatter(k);
  change(start);
  Simulation box(law, setup, start);
  for (int k = 0; k < 600; ++k) box.step();
  return box;
}

TEST(LeesEdwards, ItDoesNotMatterWhereTheBoxIsCut) {
  const auto as_it_is = sheared([](InitialState&) {});
  EXPECT_GT(as_it_is.ledger().slip, 0.0);
  // What one last bit of the start makes of itself until then: the rounding of the changes below is
  // some bits of each grain.
  const auto nudged = sheared([](InitialState& s) {
    for (InitialGrain& grain : s.grains) grain.position.x += 1e-14;
  });
  const double growth = difference(as_it_is, nudged, 1.0);
  const auto displaced = sheared([](InitialState& s) { s.box.offset = 3.0 * s.box.period.x; });
  EXPECT_LE(difference(as_it_is, displaced, 1.0), 10.0 * growth) << "offset by whole periods";
  const auto higher = sheared([](InitialState& s) {
    for (InitialGrain& grain : s.grains) {
      grain.position += Vec3{0.0, 0.37 * s.box.period.y, 0.0};
      grain.velocity += Vec3{0.37 * s.box.period.y, 0.0, 0.0};
    }
  });
  const auto aside = sheared([](InitialState& s) {
    for (InitialGrain& grain : s.grains) grain.position += Vec3{1.3, 0.0, 2.1};
  });
  std::cout << "sheared box: a nudge of 1e-14 d grows to " << growth << ", moved across y "
            << difference(as_it_is, higher, 1.0) << ", moved along x and z "
            << difference(as_it_is, aside, 1.0) << '\n';
  EXPECT_LT(growth, 1e-9);  // so that the comparisons below mean something
  EXPECT_LE(difference(as_it_is, higher, 1.0), 10.0 * growth);
  EXPECT_LE(difference(as_it_is, aside, 1.0), 10.0 * growth);
}

/// Columns of grains along y that just touch, with a piston of some pressure.
auto lattice(double pressure) {
  constexpr int side = 4;
  InitialState state = in_box({side * 1.2, side * 1.0, side * 1.2}, {});
  for (int k = 0; k < side * side * side; ++k) {
    const Vec3 place{k % side + 0.5, k / side % side + 0.5, k / side / side + 0.5};
    state.grains.push_back({.position = {1.2 * place.x, place.y, 1.2 * place.z}});
  }
  SimulationSetup setup = free_space(default_step(soft));
  const double frequency = 2.0;  // slower than the sound that crosses the column
  const double height = side;
  const double modulus = soft.stiffness / (1.2 * 1.2);  // of columns of springs k on areas 1.44
  BoxDrive drive{.pressure = pressure};
  drive.gain = frequency * frequency / modulus;
  drive.damping = 2.0 * frequency;
  setup.drive = drive;
  setup.dynamics.field = Affine{.middle = 0.5 * height};
  return Simulation(smooth(soft), setup, state);
}

TEST(Piston, LatticeYieldsByItsStiffness) {
  constexpr double pressure = 50.0;
  Simulation box = lattice(pressure);
  run_until(box, 20.0);  // 40 damping times
  // Each contact carries pressure * 1.44 and yields by that over k.
  const double height = 4.0 * (1.0 - pressure * 1.44 / soft.stiffness);
  EXPECT_NEAR(box.stress_yy(), pressure, 1e-9 * pressure);
  EXPECT_NEAR(box.box().period.y, height, 1e-9);
}

TEST(Piston, PressureZeroIsHeld) {
  Simulation box = lattice(0.0);
  run_until(box, 5.0);
  EXPECT_NEAR(box.stress_yy(), 0.0, 1e-12);
  EXPECT_NEAR(box.box().period.y, 4.0, 1e-9);
}

TEST(Piston, StressOfAGasIsThatOfHardSpheres) {
  // An elastic gas at fixed volume: sigma_yy = n T Z, Carnahan and Starling (1969), T per
  // component.
  const Hooke elastic{.stiffness = 2e5, .damping = 0.0};
  constexpr std::size_t grains = 250;
  constexpr double fraction = 0.1;
  const double period = std::cbrt(grains / unit_density / fraction);
  SimulationSetup setup = free_space(default_step(elastic));
  setup.drive = BoxDrive{};
  setup.dynamics.field = Affine{};
  Simulation box(smooth(elastic), setup, gas(period, grains, 1.0));
  run_until(box, 2.0);  // some collisions per grain: the velocities have become Maxwellian
  constexpr int blocks = 20;
  double mean = 0.0, squares = 0.0, kinetic = 0.0;
  for (int b = 0; b < blocks; ++b) {
    double sum = 0.0;
    long count = 0;
    for (const double end = box.time() + 2.0; box.time() < end; ++count) {
      box.step();
      sum += box.stress_yy();
    }
    mean += sum / static_cast<double>(count) / blocks;
    squares += std::pow(sum / static_cast<double>(count), 2) / blocks;
    kinetic += box.kinetic_energy() / blocks;
  }
  const double temperature = 2.0 * kinetic / (3.0 * (grains - 1));
  const double phi = fraction;
  const double factor = (1.0 + phi + phi * phi - phi * phi * phi) / std::pow(1.0 - phi, 3);
  const double expected = grains / std::pow(period, 3) * temperature * factor;
  const double error = std::sqrt((squares - mean * mean) / (blocks - 1));
  // Softness: spheres overlap by about v sqrt(m/2k), which makes them look smaller by as much.
  const double softness = 3.0 * std::sqrt(temperature * 0.5 / elastic.stiffness);
  std::cout << "gas: sigma_yy / (n T Z) = " << mean / expected << " +- " << error / expected
            << ", softness " << softness << '\n';
  EXPECT_NEAR(mean, expected, 3.0 * error + softness * expected);
}

/// The ring turned and joined n times.
InitialState copies(const InitialState& wedge, int n) {
  InitialState all = wedge;
  all.grains.clear();
  for (int k = 0; k < n; ++k) {
    for (InitialGrain grain : wedge.grains) {
      const double angle = k * wedge.box.wedge;
      grain.position = turned(grain.position, angle);
      grain.velocity = turned(grain.velocity, angle);
      grain.rotation = turned(grain.rotation, angle);
      all.grains.push_back(grain);
    }
  }
  all.box.wedge = n * wedge.box.wedge;
  return all;
}

/// The grains some steps later. In a packing some pairs touch to the last bit, and a dashpot acts
/// from the first touch on: rounding would decide about a force.
template <class Law>
InitialState moved_on(Simulation<Law> simulation, InitialState state) {
  for (int k = 0; k < 40; ++k) simulation.step();
  const Particles& particles = simulation.particles();
  for (std::size_t i = 0; i < particles.real; ++i) {
    state.grains[particles.id[i]].position = particles.state[i].position;
    state.grains[particles.id[i]].velocity = particles.state[i].velocity;
  }
  return state;
}

/// Largest difference of the grains of a wedge and those of copy k in a larger one.
double difference(const Motions& wedge, const Motions& whole, int k) {
  const std::size_t count = wedge.position.size();
  double largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    // Grains may have passed a face: compare by what does not turn, and by radial components.
    const auto compare = [&](const Vec3& p, const Vec3& v, const Vec3& q, const Vec3& w) {
      const Vec3 at{std::hypot(p.x, p.y), dot(p, v) - p.z * v.z, p.x * v.y - p.y * v.x};
      const Vec3 other{std::hypot(q.x, q.y), dot(q, w) - q.z * w.z, q.x * w.y - q.y * w.x};
      return std::max({length(at - other), std::abs(p.z - q.z), std::abs(v.z - w.z)});
    };
    const std::size_t j = static_cast<std::size_t>(k) * count + i;
    largest = std::max(
        {largest,
         compare(wedge.position[i], wedge.velocity[i], whole.position[j], whole.velocity[j]),
         compare(wedge.position[i], wedge.spin[i], whole.position[j], whole.spin[j])});
  }
  return largest;
}

TEST(Wedge, MovesAsTheRingItIsCutFrom) {
  const ContactLaw law{soft,
                       LiquidBridge{.surface_tension = 3.0, .contact_angle = 0.2, .volume = 2e-4},
                       sliding(0.5, soft.stiffness, 5.0)};
  SplitBottom cell;
  cell.inner_radius = 6.0;
  cell.split_radius = 8.0;
  cell.outer_radius = 11.0;
  cell.wedge = std::numbers::pi / 6.0;
  cell.rotation_rate = 0.3;
  cell.grains = 130;
  const Scene scene = with(small_scene(cell), law, 50.0);
  validate(scene);
  InitialState start = initial_state(scene);
  for (std::size_t k = 0; k < start.grains.size(); ++k) {
    InitialGrain& grain = start.grains[k];
    if (grain.body != Body::none) continue;
    // A swirl that takes grains across the faces, with contacts under way.
    grain.velocity = scatter(k) + Vec3{-grain.position.y, grain.position.x, 0.0};
  }
  const SimulationSetup setup = flow_setup(scene, start);
  start = moved_on(Simulation(law, setup, start), start);
  const auto after = [&](const InitialState& initial) {
    Simulation ring(law, setup, initial);
    for (int k = 0; k < 900; ++k) ring.step();
    EXPECT_GT(ring.rebuilds(), 3);
    return motions(ring);
  };
  const Motions thirty = after(start);
  const Motions ninety = after(copies(start, 3));
  InitialState full = copies(start, 12);
  full.box.wedge = 0.0;
  const Motions whole = after(full);
  std::size_t crossed = 0;
  for (std::size_t i = 0; i < thirty.position.size(); ++i) {
    const Vec3& p = whole.position[i];
    crossed += p.y < 0.0 || std::atan2(p.y, p.x) > start.box.wedge;
  }
  EXPECT_GE(crossed, 5u);
  // Copies in the whole ring differ by rounding only: how far it has grown.
  Motions first = whole;
  const std::size_t count = thirty.position.size();
  for (auto* v : {&first.position, &first.velocity, &first.spin}) v->resize(count);
  double growth = 0.0;
  for (int k = 1; k < 12; ++k) growth = std::max(growth, difference(first, whole, k));
  std::cout << "ring: " << crossed << " of " << count << " grains crossed; copies differ by "
            << growth << ", wedge of 30 degrees by " << difference(thirty, whole, 0)
            << ", of 90 by " << difference(thirty, ninety, 1) << '\n';
  EXPECT_LT(growth, 1e-6);  // so that the comparison means something
  EXPECT_LE(difference(thirty, whole, 0), 10.0 * growth);
  EXPECT_LE(difference(thirty, ninety, 1), 10.0 * growth);
}

/// The filling of a ring cell at rest, and its set-up, in which everything is made to turn.
struct Turning {
  Motions rest;
  SimulationSetup setup;
  InitialState start;
};
Turning turning(const ContactLaw<Hooke, Cohesionless, Sliding>& law, double rate) {
  const Scene scene = with(small_ring(), law, 50.0);
  InitialState packing = initial_state(scene);
  SimulationSetup setup = *settling_setup(scene, packing);
  Simulation settling(law, setup, packing);
  run_until(settling, 30.0);
  EXPECT_LT(settling.kinetic_energy(), 1e-6);
  Turning made{motions(settling), setup, packing};
  for (std::size_t i = 0; i < packing.grains.size(); ++i) {
    InitialGrain& grain = made.start.grains[i];
    if (grain.body == Body::base) grain.body = Body::mover;
    if (grain.body != Body::none) continue;
    grain.position = made.rest.position[i];
    grain.velocity = {-rate * grain.position.y, rate * grain.position.x, 0.0};
    grain.rotation = {0.0, 0.0, rate};
  }
  made.setup.drive = RotationDrive{rate};
  for (Wall& wall : made.setup.walls) std::get<Cylinder>(wall.shape).rotation_rate = rate;
  return made;
}

TEST(Wedge, FillingTurnsWithItsWallsLikeARigidBody) {
  const auto law = rough(soft, 0.5);
  constexpr double rate = 0.05;
  const Turning made = turning(law, rate);
  Simulation ring(law, made.setup, made.start);
  run_until(ring, 1.0 / rate);
  const Motions after = motions(ring);
  const std::size_t count = after.position.size();
  double farthest = 0.0, fastest = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& p = after.position[i];
    fastest = std::max(fastest, length(after.velocity[i] - Vec3{-rate * p.y, rate * p.x, 0.0}));
    double off = INFINITY;  // back by the angle, in the section where the grain was
    for (int k = -1; k <= 1; ++k) {
      const Vec3 back = turned(p, k * made.start.box.wedge - rate * ring.time());
      off = std::min(off, length(back - made.rest.position[i]));
    }
    farthest = std::max(farthest, off);
    mean += off / static_cast<double>(count);
  }
  std::cout << "rigid rotation by 1 rad: grains off by " << mean << " d on average, at most "
            << farthest << " d; speed against the rigid body at most " << fastest << '\n';
  // The start has lost its springs, and springs do not turn about the normal of their contact: each
  // contact yields by about its spring, mu F_n / k_t under three grains, and the way to the wall
  // leads over five.
  const double spring = 0.5 * 3.0 / law.friction.stiffness;
  EXPECT_LT(mean, 5.0 * spring);
  EXPECT_LT(fastest, 0.01 * rate * 8.0);
}

}  // namespace
}  // namespace grainlaw::dem
