// Questions that take a million steps: conservation, cooling, a servo in the mean.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/dem/momentum.h"
#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

TEST(Momentum, IsKeptForAMillionStepsInAPeriodicBox) {
  const double gained = momentum_gained(periodic_box(), 1'000'000);
  std::cout << "periodic box: " << gained << '\n';
  EXPECT_LT(gained, 1e-12);
}

TEST(Momentum, OfPeculiarVelocitiesIsKeptForAMillionStepsInAShearedBox) {
  const double gained = momentum_gained(sheared_box(), 1'000'000);
  std::cout << "sheared box: " << gained << '\n';
  EXPECT_LT(gained, 1e-12);
}

/// Mean velocity along y less the strain of the box, over the mean peculiar speed.
template <class Law>
double drift_along_y(const Simulation<Law>& box, double shear_rate) {
  const auto& field = std::get<Affine>(box.setup().dynamics.field);
  double momentum = peculiar_momentum(box, shear_rate).first.y;
  for (std::size_t i = 0; i < box.particles().mobile; ++i) {
    const GrainState& grain = box.particles().state[i];
    momentum -= field.strain_rate * (grain.position.y - field.middle) / grain.inverse_mass;
  }
  return momentum / peculiar_momentum(box, shear_rate).second;
}

// A packing that drifts along y pushes the piston by its momentum: the contacts carry less than the
// pressure asked. With the strain about the middle of the box, which moves with the piston, it
// gained 0.02 of its peculiar speed per 10 strains, for ever.
TEST(Momentum, OfPeculiarVelocitiesIsKeptForAMillionStepsUnderAPiston) {
  const auto law = rough(soft, 0.5);
  Simulation box = flow(with(small_shear(20.0), law, 50.0), law);
  double largest = 0.0;
  for (int c = 0; c < 100; ++c) {
    for (long k = 0; k < 10'000; ++k) box.step();
    largest = std::max(largest, std::abs(drift_along_y(box, 1.0)));
  }
  std::cout << "sheared box under a piston: " << largest << '\n';
  EXPECT_LT(largest, 1e-12);
}

/// Mean square velocity per component over time, of a gas that cools.
struct Cooling {
  std::vector<double> time;
  std::vector<double> temperature;
};

constexpr std::size_t cooling_grains = 300;
constexpr double cooling_fraction = 0.15;
constexpr double cooling_restitution = 0.85;

Cooling cooling_gas(std::size_t seed) {
  Hooke law{.stiffness = 1e5};
  law.damping = damping_for(cooling_restitution, law.stiffness, 0.5);
  const double period = std::cbrt(cooling_grains / unit_density / cooling_fraction);
  Simulation box(smooth(law),
                 free_space(law.contact_time(0.5) / 40.0),
                 gas(period, cooling_grains, 1.0, seed));
  run_until(box, 3.0);  // the velocities have become those of a gas
  Cooling cooling;
  const auto temperature = [&] {
    return 2.0 * box.kinetic_energy() / (3.0 * (cooling_grains - 1));
  };
  const double first = temperature();
  const double start = box.time();
  while (cooling.temperature.empty() || cooling.temperature.back() > first / 30.0) {
    cooling.time.push_back(box.time() - start);
    cooling.temperature.push_back(temperature());
    run_until(box, box.time() + 0.2 / std::sqrt(cooling.temperature.back()));
  }
  return cooling;
}

/// Slope and its standard error of the straight line through y(x).
std::pair<double, double> line(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    sx += x[k], sy += y[k], sxx += x[k] * x[k], sxy += x[k] * y[k];
  }
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  double left = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    left += std::pow(y[k] - sy / n - slope * (x[k] - sx / n), 2);
  }
  return {slope, std::sqrt(left / (n - 2.0) / (sxx - sx * sx / n))};
}

/// Mean and its standard error.
std::pair<double, double> mean(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0.0, squares = 0.0;
  for (const double v : values) sum += v / n, squares += v * v / n;
  return {sum, std::sqrt((squares - sum * sum) / (n - 1.0))};
}

// Haff (J. Fluid Mech. 134 (1983) 401): T = T0 / (1 + t/t0)^2, so 1/sqrt(T) grows as a straight
// line of slope 1/(t0 sqrt(T0)). Enskog with Maxwellian velocities: dT/dt = -(1 - e^2)/3 w T, with
// the collision rate of a grain w = 24 phi g0 sqrt(T/pi) / d, g0 of Carnahan and Starling (1969).
TEST(HomogeneousCooling, FollowsHaffAtTheRateOfEnskog) {
  const double phi = cooling_fraction;
  const double g0 = (1.0 - 0.5 * phi) / std::pow(1.0 - phi, 3);
  const double e = cooling_restitution;
  const double enskog = (1.0 - e * e) / 6.0 * 24.0 * phi * g0 / std::sqrt(std::numbers::pi);
  std::vector<double> rates, exponents;
  for (std::size_t seed = 0; seed < 6; ++seed) {
    const Cooling cooling = cooling_gas(seed);
    std::vector<double> inverse_speed, log_time, log_temperature;
    for (const double t : cooling.temperature) inverse_speed.push_back(1.0 / std::sqrt(t));
    rates.push_back(line(cooling.time, inverse_speed).first / enskog);
    const double t0 = 1.0 / (enskog * std::sqrt(cooling.temperature.front()));
    for (std::size_t k = 0; k < cooling.time.size(); ++k) {
      log_time.push_back(std::log(1.0 + cooling.time[k] / t0));
      log_temperature.push_back(std::log(cooling.temperature[k]));
    }
    exponents.push_back(-line(log_time, log_temperature).first);
  }
  const auto [rate, rate_error] = mean(rates);
  const auto [exponent, exponent_error] = mean(exponents);
  std::cout << "cooling: rate / Enskog = " << rate << " +- " << rate_error
            << ", exponent = " << exponent << " +- " << exponent_error << '\n';
  // What the theory leaves out may let grains cool more slowly; not shown here, only supposed:
  // correlations of velocities (grains
  // that collided move alike, and flows of whole regions cool last), 1/N, and the 1 % of the time
  // that contacts last. 3 % are allowed for it; with e = 0.95 it is 1 to 2 %.
  EXPECT_NEAR(rate, 1.0, 3.0 * rate_error + 0.03);
  EXPECT_NEAR(exponent, 2.0, 3.0 * exponent_error + 0.03);
}

TEST(Piston, MeanStressOfAShearedBoxIsThePressureAsked) {
  constexpr double pressure = 20.0;
  const auto law = rough(soft, 0.5);
  Simulation box = flow(with(small_shear(pressure, 500), law, 50.0), law);
  run_until(box, 5.0);
  double sum = 0.0;
  const long begin = box.steps();
  while (box.time() < 45.0) {
    box.step();
    sum += box.stress_yy();
  }
  const double mean_stress = sum / static_cast<double>(box.steps() - begin);
  std::cout << "sheared box: sigma_yy / pressure = " << mean_stress / pressure << '\n';
  // Momentum of the piston: the mean is off by damping / gain / pressure times the relative change
  // of the height over the window, here 0.15 per strain: 2 % of height over a strain of 40.
  EXPECT_NEAR(mean_stress, pressure, 0.005 * pressure);
}

}  // namespace
}  // namespace grainlaw::dem
