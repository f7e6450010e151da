#include <gtest/gtest.h>

#include "dem/binary_collision.h"
#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

constexpr double half_mass = 0.5;

struct Impact {
  Vec3 velocity;  // of the first grain after the contact; the second has the opposite one
  Vec3 spin;      // R omega of both
  double time = 0.0;
};

/// Two grains hit along x with closing speed `normal` and tangential speed `tangential` (along y).
Impact collide(double normal, double tangential, double friction, double time_step) {
  InitialState initial;
  initial.position = {{}, {1.0 + 0.3 * normal * time_step, 0.0, 0.0}};
  initial.velocity = {{0.5 * normal, 0.5 * tangential, 0.0},
                      {-0.5 * normal, -0.5 * tangential, 0.0}};
  Simulation pair(rough(stiff, friction), free_space(time_step), initial);
  long contact_steps = 0;
  do {
    pair.step();
    contact_steps += pair.touching_pairs() > 0;
  } while (pair.touching_pairs() > 0 || pair.steps() < 2);
  const std::size_t first = pair.particles().id[0] == 0 ? 0 : 1;
  return {pair.velocity(first), pair.spin(first), static_cast<double>(contact_steps) * time_step};
}

TEST(Hooke, CollisionTimeAndRestitutionAreThoseOfTheDampedOscillator) {
  // Brewster et al. 2008, eqs. 7 and 8, evaluated independently to 7 digits.
  EXPECT_NEAR(stiff.collision_time(half_mass), 4.971179e-3, 1e-9);
  EXPECT_NEAR(stiff.restitution(half_mass), 0.883133, 1e-6);
  EXPECT_NEAR(damping_for(0.88, 2e5, half_mass), 51.4275, 1e-4);
}

TEST(Hooke, RestitutionFollowsFromDampingAndStiffness) {
  const double exact = stiff.restitution(half_mass);
  const double contact = stiff.collision_time(half_mass);
  const CollidingGrains grains;
  EXPECT_NEAR(mean_restitution(smooth(stiff), grains, contact / 500.0), exact, 1e-4);
  const double at_default = mean_restitution(smooth(stiff), grains, contact / 50.0);
  RecordProperty("restitution_at_default_step", std::to_string(at_default));
  std::cout << "restitution at 1/50: " << at_default << ", exact " << exact << '\n';
}

TEST(Hooke, RestitutionErrorFallsWithTheSquareOfTheStep) {
  const double exact = stiff.restitution(half_mass);
  const double contact = stiff.collision_time(half_mass);
  const double coarse = mean_restitution(smooth(stiff), {}, contact / 100.0) - exact;
  const double fine = mean_restitution(smooth(stiff), {}, contact / 200.0) - exact;
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.3);
}

TEST(Hooke, ContactLastsTheCollisionTimeToOneStep) {
  const double step = stiff.collision_time(half_mass) / 400.0;
  EXPECT_NEAR(collide(1.0, 0.0, 0.5, step).time, stiff.collision_time(half_mass), step);
}

TEST(Hooke, ForceAtZeroOverlapIsTheDashpotAloneAndFinite) {
  const Contact touching{.normal = {1, 0, 0},
                         .distance = 1.0,
                         .overlap = 0.0,
                         .normal_velocity = -2.0,
                         .reduced_mass = half_mass};
  EXPECT_DOUBLE_EQ(stiff.force(touching), 50.0 * half_mass * 2.0);
  EXPECT_DOUBLE_EQ(stiff.elastic_energy(touching), 0.0);
}

// A grazing hit slips all the time: the tangential impulse is mu times the normal one, in which
// the attraction at the end counts by its magnitude (the limit is mu |F_n|).
TEST(Sliding, GrazingImpactLosesFrictionTimesTheNormalImpulse) {
  // Slow, so that the normal turns by 3e-5 only and the lever arm shrinks by less.
  const double mu = 0.1, normal = 1e-3, tangential = 5e-3;
  const double step = stiff.collision_time(half_mass) / 2000.0;
  const Impact after = collide(normal, tangential, mu, step);
  // Closed form of int |F_n| dt: the force of the oscillator changes sign at the time t* with
  // tan(w t*) = -2 l w / (w^2 - l^2), l = gamma/2; the velocity change up to and from there on.
  const double l = 0.5 * stiff.damping;
  const double w = std::numbers::pi / stiff.collision_time(half_mass);
  const double turn = (std::numbers::pi - std::atan2(2.0 * l * w, w * w - l * l)) / w;
  const auto velocity = [&](double t) {
    return normal * std::exp(-l * t) * (std::cos(w * t) - l / w * std::sin(w * t));
  };
  const double end = velocity(stiff.collision_time(half_mass));
  const double impulse = (normal - velocity(turn)) + (end - velocity(turn));  // per reduced mass
  const double lost = tangential - 2.0 * after.velocity.y;
  // The start of the contact is known to a step only: 1/2000 of the impulse each at begin and end.
  EXPECT_NEAR(lost, mu * impulse, 2e-3 * mu * impulse);
  // Each grain is turned by the same impulse: R omega = 5/2 (impulse / m), opposite to the slip.
  EXPECT_NEAR(length(after.spin), 2.5 * 0.5 * lost, 1e-3 * lost);
}

// With a high coefficient and little damping the contact point sticks; the tangential spring of
// frequency sqrt(7 k_t / m) = sqrt(2 k_n / m) then makes half a period too: rebound -1 at the
// contact point, where a force changes the speed 7/2 times as much as the centres'.
TEST(Sliding, StickingImpactReversesTheSurfaceVelocity) {
  const Hooke undamped{.stiffness = 2e5, .damping = 0.0};
  const double tangential = 0.05;
  for (const double steps : {250.0, 500.0}) {
    const double step = undamped.collision_time(half_mass) / steps;
    InitialState initial;
    initial.position = {{}, {1.0, 0.0, 0.0}};
    initial.velocity = {{0.5, 0.5 * tangential, 0.0}, {-0.5, -0.5 * tangential, 0.0}};
    Simulation pair(rough(undamped, 10.0), free_space(step), initial);
    do pair.step();
    while (pair.touching_pairs() > 0);
    const std::size_t first = pair.particles().id[0] == 0 ? 0 : 1;
    const double after = 2.0 * pair.velocity(first).y;
    // Surface velocity -tangential, so the centres change by 2/7 of 2 tangential. The contact
    // shrinks the lever arm by at most half the overlap (1/632 d) and ends within a step.
    EXPECT_NEAR(after, tangential * (1.0 - 4.0 / 7.0), tangential * (2.0 / 632.0 + 7.0 / steps));
  }
}

TEST(Sliding, SpringStaysInTheContactPlaneWithItsLength) {
  const Sliding law = sliding(1e9, 2e5);
  Sliding::History history{.spring = {0.0, 1e-3, 0.0}};
  const double rate = 2.0, step = 1e-3;
  TangentialWork work;
  double angle = 0.0;
  for (int k = 0; k < 500; ++k) {  // the normal turns by one radian in the plane of the spring
    angle += rate * step;
    const Vec3 normal{std::cos(angle), std::sin(angle), 0.0};
    const Contact contact{.normal = normal,
                          .distance = 1.0,
                          .overlap = 1e-3,
                          .normal_velocity = 0.0,
                          .reduced_mass = half_mass};
    const TangentialMotion turning{.surface_velocity = {},
                                   .normal_rate = rate * Vec3{-normal.y, normal.x, 0.0}};
    law.force(contact, turning, 1.0, step, history, work);
    ASSERT_NEAR(dot(history.spring, normal), 0.0, 1e-15);
  }
  // The turn is exact to (rate step)^3 = 8e-9 a step.
  EXPECT_NEAR(length(history.spring), 1e-3, 1e-3 * 500 * 8e-9);
}

TEST(Sliding, ForceNeverExceedsTheCoulombLimitEvenInAttraction) {
  const Sliding law = sliding(0.5, 2e5);
  for (const double normal_force : {3.0, -2.0, 0.0}) {
    Sliding::History history{.spring = {0.0, 1e-2, 0.0}};
    TangentialWork work;
    const Contact contact{.normal = {1, 0, 0},
                          .distance = 1.0,
                          .overlap = 0.0,
                          .normal_velocity = 0.0,
                          .reduced_mass = half_mass};
    const Vec3 force = law.force(contact,
                                 {.surface_velocity = {0, 1, 0}, .normal_rate = {}},
                                 normal_force,
                                 1e-4,
                                 history,
                                 work);
    EXPECT_LE(length(force), 0.5 * std::abs(normal_force) * (1.0 + 1e-15));
    EXPECT_GE(work.slip, 0.0);
  }
}

TEST(Sliding, VanishingFrictionIsTheFrictionlessLaw) {
  const double step = stiff.collision_time(half_mass) / 50.0;
  auto start = gas(4.0, 40, 1.0, step);
  Simulation without(smooth(stiff), start.setup, start.initial);
  Simulation with(rough(stiff, 1e-300), start.setup, start.initial);
  for (int k = 0; k < 2000; ++k) {
    without.step();
    with.step();
  }
  for (std::size_t i = 0; i < 40; ++i) {
    ASSERT_EQ(without.particles().state[i].position, with.particles().state[i].position);
  }
}

TEST(ContactLaw, FrictionlessGrainsStoreNoHistoryAndNoRotation) {
  using Smooth = ContactLaw<Hooke, Cohesionless, Frictionless>;
  static_assert(!Smooth::keeps_history && !Smooth::rotates && sizeof(Smooth) == sizeof(Hooke));
  Simulation pair(smooth(stiff),
                  free_space(1e-4),
                  {.position = {{}, {1, 0, 0}}, .velocity = {}, .spin = {}, .frozen = {}});
  EXPECT_TRUE(pair.particles().spin.empty());
  EXPECT_TRUE(pair.particles().half_spin.empty());
}

TEST(FrozenGrain, IsAPartnerOfInfiniteMass) {
  InitialState initial;
  initial.position = {{0.0, 0.0, 1.0 + 1e-9}};
  initial.velocity = {{0.0, 0.0, -0.1}};
  initial.frozen = {{}};
  const double step = stiff.collision_time(1.0) / 5000.0;
  Simulation bounce(smooth(stiff), free_space(step), initial);
  do bounce.step();
  while (bounce.touching_pairs() > 0);
  // Reduced mass m. One start phase: half a step of the dashpot force at begin and end.
  EXPECT_NEAR(bounce.velocity(0).z, 0.1 * stiff.restitution(1.0), 0.1 * stiff.damping * step);
  EXPECT_EQ(bounce.particles().state[1].position, Vec3{});
}

}  // namespace
}  // namespace grainlaw::dem
