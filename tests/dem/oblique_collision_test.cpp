#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/dem/pair_support.h"

/// Collisions with a tangential velocity against an integration of the equations of motion made
/// here, and against LAMMPS (data/reference/lammps/oblique.csv, section 1 of its README).
namespace grainlaw::dem {
namespace {

using namespace test;

/// Friction of the source's ratio of stiffnesses, without tangential damping.
Sliding friction_for(double stiffness) {
  return {.coefficient = 0.5, .stiffness = 2.0 / 7.0 * stiffness};
}

/// What is known of a plane collision: v1x, v1y, w1z, v2x, v2y, w2z.
using Outcome = std::array<double, 6>;

double largest_difference(const Outcome& a, const Outcome& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

/// Grain 1 hits grain 2, at rest at larger x, with the speed of approach 1.
struct Case {
  double first = 1.0;  ///< diameters
  double second = 1.0;
  double tangential = 0.0;
};

/// Where the contact point lies, for torque and surface velocity.
enum class Arm {
  shared,  ///< the distance divided as the radii: R_i r / (R_i + R_j)
  full     ///< R_i, as LAMMPS has it
};

/// Direct integration in the plane, fourth-order Runge-Kutta; the spring of Brewster et al. 2008,
/// eq. 3 as a number along the tangent (-n_y, n_x), which turns with it.
template <class Normal>
class PlaneCollision {
 public:
  PlaneCollision(const Normal& law, const Case& grains, Arm arm)
      : law_(law), friction_(friction_for(law.stiffness)), case_(grains), arm_(arm) {}

  Outcome run(double step) const {
    State s{0.0,
            0.0,
            1.0,
            case_.tangential,
            0.0,
            0.5 * (case_.first + case_.second),
            0.0,
            0.0,
            0.0,
            0.0,
            0.0};
    do {
      const State a = rate(s), b = rate(moved(s, 0.5 * step, a)), c = rate(moved(s, 0.5 * step, b)),
                  d = rate(moved(s, step, c));
      for (std::size_t k = 0; k < s.size(); ++k) {
        s[k] += step / 6.0 * (a[k] + 2.0 * (b[k] + c[k]) + d[k]);
      }
      cut(s);
    } while (geometry(s).contact.overlap > 0.0);
    return {s[2], s[3], s[4], s[7], s[8], s[9]};
  }

 private:
  using State = std::array<double, 11>;  // x1 y1 u1 v1 w1, x2 y2 u2 v2 w2, spring
  struct Geometry {
    Contact contact;
    Vec3 tangent;
    double arm1, arm2, sliding, spring_limit;
  };

  static State moved(State s, double h, const State& r) {
    for (std::size_t k = 0; k < s.size(); ++k) s[k] += h * r[k];
    return s;
  }

  Geometry geometry(const State& s) const {
    Geometry g;
    const Vec3 branch{s[0] - s[5], s[1] - s[6], 0.0};
    const Vec3 velocity{s[2] - s[7], s[3] - s[8], 0.0};
    Contact& c = g.contact;
    c.distance = length(branch);
    c.normal = 1.0 / c.distance * branch;
    c.radius_sum = 0.5 * (case_.first + case_.second);
    c.overlap = c.radius_sum - c.distance;
    c.normal_velocity = dot(velocity, c.normal);
    c.reduced_mass = reduced_mass(case_.first, case_.second);
    const double share = arm_ == Arm::shared ? c.distance / c.radius_sum : 1.0;
    g.arm1 = 0.5 * case_.first * share;
    g.arm2 = 0.5 * case_.second * share;
    g.tangent = {-c.normal.y, c.normal.x, 0.0};
    g.sliding = dot(velocity, g.tangent) - g.arm1 * s[4] - g.arm2 * s[9];
    // The prefactor stands before the spring, so that the longest spring is mu |F| / (f k_t).
    const double force = c.overlap > 0.0 ? std::abs(law_.force(c)) : 0.0;
    const double stiffness = friction_.stiffness * law_.prefactor(c);
    g.spring_limit = stiffness > 0.0 ? friction_.coefficient * force / stiffness : 0.0;
    return g;
  }

  void cut(State& s) const {
    const double limit = geometry(s).spring_limit;
    s[10] = std::clamp(s[10], -limit, limit);
  }

  State rate(const State& s) const {
    const Geometry g = geometry(s);
    const double normal = g.contact.overlap > 0.0 ? law_.force(g.contact) : 0.0;
    const double stiffness = friction_.stiffness * law_.prefactor(g.contact);
    const double tangential = -stiffness * std::clamp(s[10], -g.spring_limit, g.spring_limit);
    const Vec3 force = normal * g.contact.normal + tangential * g.tangent;
    const double m1 = mass_of(case_.first), m2 = mass_of(case_.second);
    const double i1 = 0.1 * m1 * case_.first * case_.first;
    const double i2 = 0.1 * m2 * case_.second * case_.second;
    return {s[2],
            s[3],
            force.x / m1,
            force.y / m1,
            -g.arm1 * tangential / i1,
            s[7],
            s[8],
            -force.x / m2,
            -force.y / m2,
            -g.arm2 * tangential / i2,
            g.sliding};
  }

  Normal law_;
  Sliding friction_;
  Case case_;
  Arm arm_;
};

double duration(const Hooke& law, const Case& c) {
  return law.collision_time(reduced_mass(c.first, c.second));
}
double duration(const Hertz& law, const Case& c) {
  return law.collision_time(reduced_mass(c.first, c.second), 0.5 * (c.first + c.second), 1.0);
}

template <class Normal>
Outcome integrated(const Normal& law, const Case& c, Arm arm) {
  return PlaneCollision(law, c, arm).run(duration(law, c) / 20'000.0);
}

/// Mean over the phase of the step at which the grains touch: the spring starts at the first force,
/// on average half a step late, and the engine counts on that.
template <class Normal>
Outcome simulated(const Normal& law, const Case& c, double steps_per_contact) {
  constexpr int phases = 40;
  const double step = duration(law, c) / steps_per_contact;
  const Vec3 velocity{1.0, c.tangential, 0.0};
  Outcome mean{};
  for (int k = 0; k < phases; ++k) {
    InitialState start = pair_on_x(c.first, c.second, 0.0, velocity);
    start.grains[0].position = -(k + 0.5) / phases * step * velocity;
    Simulation pair(
        ContactLaw{law, Cohesionless{}, friction_for(law.stiffness)}, free_flight(step), start);
    pass_contact(pair);
    const Vec3 v1 = velocity_of(pair, 0), v2 = velocity_of(pair, 1);
    const Outcome one{v1.x,
                      v1.y,
                      2.0 / c.first * spin_of(pair, 0).z,
                      v2.x,
                      v2.y,
                      2.0 / c.second * spin_of(pair, 1).z};
    for (std::size_t n = 0; n < mean.size(); ++n) mean[n] += one[n] / phases;
  }
  return mean;
}

const std::array<double, 8> tangential_speeds{0.02, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 8.0};
const std::array<Case, 2> sizes{Case{1.0, 1.0}, Case{2.0 / 3.0, 4.0 / 3.0}};

template <class Use>
void for_each_case(Use&& use) {
  for (Case c : sizes) {
    for (const double speed : tangential_speeds) {
      c.tangential = speed;
      SCOPED_TRACE(testing::Message()
                   << "diameters " << c.first << ' ' << c.second << ", tangential speed " << speed);
      use(c);
    }
  }
}

double largest(const Outcome& a) {
  return largest_difference(a, {});
}

/// Where the normal force changes sign, before the end of a contact, friction is cut to mu |F_n| of
/// the nearest step, at most mu k v dt from zero, and keeps that for the rest of the contact,
/// gamma / w^2 long. Hertz contacts end without attraction but for higher orders.
double crossing_error(const Hooke& law, const Case& c, double step) {
  const double mass = reduced_mass(c.first, c.second);
  const double impulse = 0.5 * law.stiffness * step * law.damping / (law.stiffness / mass);
  return impulse * 2.5 / (0.5 * c.first * mass_of(c.first));  // on the spin of the smaller grain
}
double crossing_error(const Hertz&, const Case&, double) {
  return 0.0;
}

/// What is left of second order, (w dt)^2, and of the crossing.
template <class Normal>
double error_at(const Normal& law, const Case& c, double steps_per_contact, const Outcome& exact) {
  const double phase = std::numbers::pi / steps_per_contact;
  return phase * phase * largest(exact) +
         crossing_error(law, c, duration(law, c) / steps_per_contact);
}

TEST(ObliqueCollision, IsThatOfTheEquationsOfMotion) {
  const auto check = [](const auto& law, const Case& c) {
    const Outcome exact = integrated(law, c, Arm::shared);
    for (const double n : {50.0, 1000.0}) {
      EXPECT_LT(largest_difference(simulated(law, c, n), exact), error_at(law, c, n, exact))
          << law.name << ", steps " << n;
    }
  };
  for_each_case([&](const Case& c) {
    check(hooke, c);
    check(hertz, c);
  });
}

/// oblique.csv.
struct LammpsRow {
  std::string law;
  Case grains;
  double steps = 0.0;
  Outcome outcome{};
};
std::vector<LammpsRow> lammps_rows() {
  std::ifstream file(GRAINLAW_REFERENCE_DATA "/lammps/oblique.csv");
  std::vector<LammpsRow> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    LammpsRow row;
    double step = 0.0;
    fields >> row.law >> row.grains.first >> row.grains.second >> row.grains.tangential >>
        row.steps >> step;
    for (double& value : row.outcome) fields >> value;
    rows.push_back(row);
  }
  return rows;
}

/// Ours less theirs is what the arm makes of the equations of motion. The error of first order of
/// LAMMPS is a quarter of its change from 200 to 1000 steps where it is regular; where it is not
/// (limits crossed between steps) the whole change bounds it.
template <class Normal>
void compare_with_lammps(const Normal& law, const LammpsRow& middle, const LammpsRow& fine) {
  const Outcome full = integrated(law, fine.grains, Arm::full);
  const Outcome shared = integrated(law, fine.grains, Arm::shared);
  const Outcome ours = simulated(law, fine.grains, 1000.0);
  const double theirs = largest_difference(fine.outcome, middle.outcome);
  EXPECT_LT(largest_difference(fine.outcome, full), theirs);
  const double tolerance = theirs + error_at(law, fine.grains, 1000.0, shared);
  for (std::size_t k = 0; k < ours.size(); ++k) {
    EXPECT_NEAR(ours[k] - fine.outcome[k], shared[k] - full[k], tolerance) << "value " << k;
  }
}

TEST(ObliqueCollision, IsThatOfLammpsButForItsArm) {
  const auto rows = lammps_rows();
  ASSERT_EQ(rows.size(), 72u);
  for (std::size_t k = 0; k < rows.size(); k += 3) {
    const LammpsRow& fine = rows[k + 2];
    ASSERT_EQ(fine.steps, 1000.0);
    SCOPED_TRACE(testing::Message() << fine.law << ", first diameter " << fine.grains.first
                                    << ", tangential speed " << fine.grains.tangential);
    if (fine.law == "hooke") {
      compare_with_lammps(hooke, rows[k + 1], fine);
    } else {
      compare_with_lammps(hertz, rows[k + 1], fine);
    }
  }
}

// The arms differ by half the overlap, v sqrt(m/k): a hundred times the stiffness leaves a tenth,
// to the next order in the overlap (0.3 % of d).
TEST(ObliqueCollision, TheArmMattersLessTheSmallerTheOverlap) {
  const Hooke stiffer{.stiffness = 100.0 * hooke.stiffness, .damping = 10.0 * hooke.damping};
  for (const double speed : {0.5, 3.0}) {
    const Case c{1.0, 1.0, speed};
    const auto difference = [&](const Hooke& law) {
      return largest_difference(integrated(law, c, Arm::full), integrated(law, c, Arm::shared));
    };
    const double ratio = difference(hooke) / difference(stiffer);
    std::cout << "arm, tangential speed " << speed << ": " << difference(hooke) << ", stiffer "
              << difference(stiffer) << '\n';
    EXPECT_NEAR(ratio, 10.0, 0.5);
  }
}

}  // namespace
}  // namespace grainlaw::dem
