#include "dem/contact_forces.h"

#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "tests/dem/pair_support.h"

/// The forces of a simulation along its run against the simple truth: every pair tried, one at a
/// time, what it remembers kept by the numbers of its grains.
namespace grainlaw::dem {
namespace {

using namespace test;

template <class Law>
class EveryPair {
 public:
  explicit EveryPair(const Law& law) : law_(law) {}

  /// Forces at the present step of the simulation; to be called once for each.
  void advance(const SimulationBase& simulation) {
    const Particles& particles = simulation.particles();
    force_.assign(particles.real, {});
    torque_.assign(particles.real, {});
    place_.resize(particles.real);
    for (std::uint32_t i = 0; i < particles.real; ++i) place_[particles.id[i]] = i;
    for (std::uint32_t a = 0; a < particles.mobile; ++a) {
      for (std::uint32_t b = a + 1; b < particles.real; ++b) add_pair(simulation, a, b);
      for (std::uint32_t w = 0; w < simulation.setup().walls.size(); ++w) {
        add_wall(simulation, a, w);
      }
    }
  }

  /// Largest difference of a force or torque.
  double difference(const Particles& particles) const {
    double largest = 0.0;
    for (std::uint32_t i = 0; i < particles.real; ++i) {
      const std::uint32_t id = particles.id[i];
      largest = std::max(largest, length(particles.load[i].force - force_[id]));
      largest = std::max(largest, length(particles.load[i].torque - torque_[id]));
    }
    return largest;
  }
  std::size_t acting() const { return memory_.size(); }

 private:
  struct Memory {
    TangentialSpring<double> spring;
    bool bridged = false;
  };

  /// From b to the nearest image of a, and the velocity of that image.
  static std::pair<Vec3, Vec3> seen(const Box& box, Vec3 branch, Vec3 velocity) {
    const auto periods = [](double x, double period) {
      return period > 0.0 ? std::round(x / period) : 0.0;
    };
    const double rows = periods(branch.y, box.period.y);
    branch.y -= rows * box.period.y;
    branch.x -= rows * box.offset;
    velocity -= rows * box.top_velocity;
    branch.x -= periods(branch.x, box.period.x) * box.period.x;
    branch.z -= periods(branch.z, box.period.z) * box.period.z;
    return {branch, velocity};
  }

  void add_pair(const SimulationBase& simulation, std::uint32_t a, std::uint32_t b) {
    const Particles& particles = simulation.particles();
    const GrainState& first = particles.state[place_[a]];
    const GrainState& second = particles.state[place_[b]];
    const auto [branch, velocity] =
        seen(simulation.box(), first.position - second.position, first.velocity - second.velocity);
    const double sum = first.radius + second.radius;
    if (length(branch) >= sum + law_.range()) {
      memory_.erase({a, b});
      return;
    }
    Vec3 spin;
    if constexpr (Law::rotates) {
      spin = particles.spin[place_[a]].velocity + particles.spin[place_[b]].velocity;
    }
    const Contact contact = contact_of(branch, velocity, first, second.inverse_mass, second.radius);
    const auto [force, torque] = act(simulation, contact, velocity, spin, 1.0, memory_[{a, b}]);
    force_[a] += force, force_[b] -= force;
    torque_[a] += torque, torque_[b] += torque;
  }

  void add_wall(const SimulationBase& simulation, std::uint32_t a, std::uint32_t w) {
    const Particles& particles = simulation.particles();
    const GrainState& grain = particles.state[place_[a]];
    const Wall& wall = simulation.setup().walls[w];
    const Vec3 foot = wall.foot(grain.position);
    const Vec3 branch = grain.position - foot;
    if (length(branch) >= grain.radius + law_.range()) {
      memory_.erase({a, first_wall_id + w});
      return;
    }
    Vec3 spin;
    if constexpr (Law::rotates) spin = particles.spin[place_[a]].velocity;
    const Vec3 velocity = grain.velocity - wall.velocity(foot);
    const auto [force, torque] = act(simulation,
                                     contact_of(branch, velocity, grain, 0.0, 0.0),
                                     velocity,
                                     spin,
                                     wall.frictional ? 1.0 : 0.0,
                                     memory_[{a, first_wall_id + w}]);
    force_[a] += force;
    torque_[a] += torque;
  }

  static Contact contact_of(const Vec3& branch,
                            const Vec3& velocity,
                            const GrainState& first,
                            double inverse_mass,
                            double radius) {
    Contact c;
    c.distance = length(branch);
    c.normal = 1.0 / c.distance * branch;
    c.radius_sum = first.radius + radius;
    c.overlap = c.radius_sum - c.distance;
    c.normal_velocity = dot(velocity, c.normal);
    c.reduced_mass = 1.0 / (first.inverse_mass + inverse_mass);
    c.harmonic_radius = harmonic_radius(first.radius, radius);
    return c;
  }

  /// Force on the first grain, and torque / radius on both.
  std::pair<Vec3, Vec3> act(const SimulationBase& simulation,
                            const Contact& c,
                            const Vec3& velocity,
                            const Vec3& spin,
                            double grip,
                            Memory& memory) const {
    memory.bridged = memory.bridged || c.overlap >= 0.0;
    const double arm = c.distance / c.radius_sum;
    const Vec3 sliding = velocity - c.normal_velocity * c.normal;
    const TangentialMotion<double> motion{sliding - arm * cross(spin, c.normal),
                                          1.0 / c.distance * sliding};
    const auto force = contact_force(law_,
                                     c,
                                     motion,
                                     grip,
                                     memory.bridged,
                                     simulation.setup().dynamics.time_step,
                                     memory.spring);
    return {force.normal * c.normal + force.tangential, -arm * cross(c.normal, force.tangential)};
  }

  Law law_;
  std::vector<Vec3> force_, torque_;  // by number
  std::vector<std::uint32_t> place_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Memory> memory_;
};

/// Grains near the points of a cubic lattice, hardly apart, with random velocities and spins.
InitialState lattice(const Box& box, int nx, int ny, int nz, double size_ratio, double speed) {
  Random random(21);
  const double largest = 2.0 * size_ratio / (1.0 + size_ratio);
  InitialState initial;
  initial.box = box;
  for (int k = 0; k < nx * ny * nz; ++k) {
    const Vec3 at{k % nx + 0.5, k / nx % ny + 0.5, k / nx / ny + 0.5};
    initial.grains.push_back({.position = 1.02 * largest * at + random.vector(0.01 * largest),
                              .velocity = random.vector(speed),
                              .rotation = random.vector(2.0 * speed),
                              .diameter = largest * random.between(1.0 / size_ratio, 1.0)});
  }
  return initial;
}

/// Runs and compares; returns the simulation at its end.
template <class Law>
std::size_t expect_forces_of_every_pair(const Law& law,
                                        const SimulationSetup& setup,
                                        const InitialState& initial,
                                        int steps) {
  SCOPED_TRACE(name(law));
  Simulation<Law> simulation(law, setup, initial);
  EveryPair<Law> truth(law);
  std::size_t acted = 0;
  for (int n = 0; n <= steps; ++n) {
    if (n > 0) simulation.step();
    truth.advance(simulation);
    // Rounding of positions of some 10 d times the stiffness, for a dozen contacts.
    const double difference = truth.difference(simulation.particles());
    EXPECT_LT(difference, 12 * hooke.stiffness * 2e-15 * 10.0) << "step " << n;
    EXPECT_EQ(truth.acting(), simulation.acting_pairs()) << "step " << n;
    if (testing::Test::HasFailure()) return 0;  // the first difference is enough
    acted += truth.acting();
  }
  EXPECT_GT(acted, 0u);
  return static_cast<std::size_t>(simulation.rebuilds());
}

constexpr double time_step = 1e-4;

SimulationSetup often_listed(double skin = 0.02) {
  SimulationSetup setup = free_flight(time_step);
  setup.skin = skin;
  return setup;
}

Box cube(double side) {
  return {.period = {side, side, side}};
}

TEST(ContactForces, AreThoseOfEveryPairUnderEveryLaw) {
  for_each_law([](const auto& law) {
    EXPECT_GT(expect_forces_of_every_pair(
                  law, often_listed(), lattice(cube(4 * 1.02), 4, 4, 4, 1.0, 3.0), 300),
              5u);
  });
}

constexpr ContactLaw rough{hooke, Cohesionless{}, sliding};
constexpr ContactLaw wet{hertz, liquid, stick_slip};

TEST(ContactForces, AreThoseOfEveryPairInAShearedBox) {
  SimulationSetup setup = often_listed();
  setup.drive = BoxDrive{.shear_rate = 2.0};
  InitialState initial = lattice(cube(4 * 1.02), 4, 4, 4, 1.0, 1.0);
  for (InitialGrain& grain : initial.grains) grain.velocity.x += 2.0 * grain.position.y;
  expect_forces_of_every_pair(rough, setup, initial, 3000);
  expect_forces_of_every_pair(wet, setup, initial, 1000);
}

TEST(ContactForces, AreThoseOfEveryPairWhenTheShearStartsSuddenly) {
  // Grains at rest, images that move: what closes the gap is the motion of the images alone. The
  // rows above and below the face lie staggered, nearer than a diameter.
  SimulationSetup setup = often_listed(0.25);
  setup.drive = BoxDrive{.shear_rate = 2.0};
  InitialState initial = lattice(cube(4 * 1.02), 4, 4, 4, 1.0, 0.0);
  initial.box.period.y -= 0.1;
  initial.box.offset = 0.51;
  expect_forces_of_every_pair(rough, setup, initial, 2000);
}

TEST(ContactForces, AreThoseOfEveryPairInABoxThatShrinks) {
  SimulationSetup setup = often_listed(0.25);
  setup.drive = BoxDrive{.height_rate = -1.0};
  expect_forces_of_every_pair(rough, setup, lattice(cube(4 * 1.02), 4, 4, 4, 1.0, 0.0), 2000);
}

TEST(ContactForces, AreThoseOfEveryPairUnderAFallingWall) {
  // Resting grains on a frozen layer; a plate of glued grains falls on them from 0.6 d above.
  InitialState initial = lattice({.period = {4.08, 4.08, 0.0}}, 4, 4, 3, 1.0, 0.0);
  for (std::size_t k = 0; k < initial.grains.size(); ++k) {
    initial.grains[k].rotation = {};
    if (k < 16) initial.grains[k].body = Body::base;
    if (k < 32) continue;
    initial.grains[k].body = Body::mover;
    initial.grains[k].position.z += 0.6;
  }
  SimulationSetup setup = often_listed(0.25);
  setup.drive = WallDrive{.load = 160.0, .mass = 16.0};
  expect_forces_of_every_pair(rough, setup, initial, 6000);
}

TEST(ContactForces, AreThoseOfEveryPairBetweenWalls) {
  SimulationSetup setup = often_listed();
  setup.dynamics.field = Uniform{{3.0, 0.0, -10.0}};
  setup.walls = {
      {.shape = Plane{.point = {}, .normal = {0.0, 0.0, 1.0}}},
      {.shape = Plane{.point = {0.0, 0.0, 4.2}, .normal = {0.0, 0.0, -1.0}}, .frictional = false},
      {.shape = Cylinder{.radius = 3.7, .rotation_rate = 0.3}}};
  InitialState initial = lattice({}, 4, 4, 4, 1.0, 2.0);
  for (InitialGrain& grain : initial.grains) grain.position -= Vec3{2.04, 2.04, 0.0};
  expect_forces_of_every_pair(rough, setup, initial, 3000);
  expect_forces_of_every_pair(wet, setup, initial, 1000);
}

TEST(ContactForces, AreThoseOfEveryPairOfVeryUnequalGrains) {
  const double side = 4 * 1.02 * 20.0 / 11.0;
  SimulationSetup setup = often_listed();
  setup.dynamics.time_step = 2e-5;
  expect_forces_of_every_pair(rough, setup, lattice(cube(side), 4, 4, 4, 10.0, 10.0), 1500);
  expect_forces_of_every_pair(wet, setup, lattice(cube(side), 4, 4, 4, 10.0, 10.0), 1500);
}

// 2.2 reaches are the least period: with the skin two images of a grain may be listed at once.
TEST(ContactForces, AreThoseOfEveryPairInTheSmallestBox) {
  LiquidBridge far = liquid;
  far.volume = 0.06;
  ASSERT_NEAR(far.range(), 0.46, 0.01);
  const double side = 2.2 * (1.0 + far.range());
  const ContactLaw law{hooke, far, sliding};
  const InitialState initial = lattice(cube(side), 3, 3, 2, 1.0, 5.0);
  expect_forces_of_every_pair(law, often_listed(0.25), initial, 6000);
}

/// What does not change when everything turns about z.
std::array<double, 6> turnless(const SimulationBase& pair) {
  const Vec3 branch = position_of(pair, 0) - position_of(pair, 1);
  return {std::hypot(position_of(pair, 0).x, position_of(pair, 0).y),
          length(velocity_of(pair, 0)),
          length(velocity_of(pair, 1)),
          length(spin_of(pair, 0)),
          spin_of(pair, 1).z,
          branch.z};
}

TEST(ContactForces, DoNotNoticeTheFacesOfAWedge) {
  // A pair held together by adhesion, turning and rubbing, passes from one section to the next and
  // back into it on the other side; the same pair in the open does not.
  const ContactLaw law{hooke, adhesion, sliding};
  for (const double direction : {1.0, -1.0}) {
    InitialState initial;
    initial.grains = {{.position = turned({8.0, 0.0, 1.0}, direction > 0.0 ? 0.45 : 0.1),
                       .rotation = {0.5, 1.0, 3.0}},
                      {.position = turned({8.0, 0.0, 1.0}, direction > 0.0 ? 0.45 : 0.1) +
                                   0.9995 * Vec3{0.48, 0.6, 0.64},
                       .velocity = {-0.2, 0.1, 0.3},
                       .rotation = {-0.5, 2.0, 0.0},
                       .diameter = 1.0}};
    for (InitialGrain& grain : initial.grains) {
      grain.velocity += direction * Vec3{-2.0, 4.0, 0.0};
    }
    Simulation open(law, often_listed(), initial);
    initial.box.wedge = std::numbers::pi / 6.0;
    Simulation wedge(law, often_listed(), initial);
    for (int n = 0; n < 4000; ++n) {
      open.step(), wedge.step();
      ASSERT_EQ(open.acting_pairs(), wedge.acting_pairs()) << "step " << n;
    }
    EXPECT_GT(open.acting_pairs(), 0u);
    EXPECT_GT(open.ledger().slip + open.ledger().tangential_dashpot, 1e-3);
    const double angle = std::atan2(position_of(open, 0).y, position_of(open, 0).x);
    EXPECT_GT(std::abs(std::floor(angle / initial.box.wedge)), 0.0);
    // Rounding of positions times stiffness and time, as for the other invariances.
    const auto expected = turnless(open), found = turnless(wedge);
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-8) << k;
  }
}

TEST(ContactForces, AreThoseOfEveryPairWhenGrainsAreCutIntoStrips) {
  const InitialState initial = lattice(cube(16 * 1.02), 16, 16, 16, 1.0, 20.0);
  Simulation sample(rough, often_listed(), initial);
  ASSERT_GT(sample.strips().size(), 1u);
  for (const int threads : {1, 3}) {
    SimulationSetup setup = often_listed(0.01);
    setup.threads = threads;
    expect_forces_of_every_pair(rough, setup, initial, 8);
  }
}

}  // namespace
}  // namespace grainlaw::dem
