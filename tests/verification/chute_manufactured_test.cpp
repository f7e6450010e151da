// Time-dependent flow of the full law: a manufactured solution, and the free surface rebuilt from
// the continuity equation on a fixed grid in z.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "continuum/dual.h"
#include "continuum/shear_layer.h"
#include "tests/continuum/example_laws.h"
#include "tests/verification/verified.h"

namespace grainlaw::continuum {
namespace {

using Number = Dual<1>;  // derivative by the mass above

const GrainProperties soft{.stiffness = 38197.0};
constexpr double mass = 20.0, theta = 24 * degree, frequency = 0.3;

double amplitude(double t) {
  return 0.1 * (1.0 + 0.5 * std::sin(frequency * t));
}
double amplitude_rate(double t) {
  return 0.05 * frequency * std::cos(frequency * t);
}

/// u = A(t) (M1^1.5 - M^1.5) solves du/dt = sin(theta) - dtau/dM + source.
double source(double mass_above, double t) {
  const MuPhi law = frictional_spheres();
  const Number M = Number::variable(mass_above, 0);
  const Number p = std::cos(theta) * M;
  const auto at = confinement(soft, p);
  const Number q = static_volume_fraction(law, at) / sqrt(p) * (1.5 * amplitude(t)) * sqrt(M);
  const Number I = q / (1.0 + q / law.volume_fraction.I_phi);
  const Number tau = p * friction(law, I, at);
  const double du_dt = amplitude_rate(t) * (std::pow(mass, 1.5) - std::pow(mass_above, 1.5));
  return du_dt - std::sin(theta) + tau.slope[0];
}

/// The layer with that source in its momentum balance.
struct Manufactured : OdeSystem {
  explicit Manufactured(const ShearLayer& l) : layer(l) {}
  void rate(double t, std::span<const double> q, std::span<double> dqdt) const override {
    layer.rate(t, q, dqdt);
    const MassGrid& grid = layer.discrete().grid();
    for (std::size_t k = 0; k < q.size(); ++k) {
      const double below = k + 1 < q.size() ? source(grid.centre[k + 1], t) : 0.0;
      dqdt[k] += layer.discrete().curve(k).mobility * (source(grid.centre[k], t) - below) /
                 grid.distance[k];
    }
  }
  void jacobian(double t, std::span<const double> q, BandView matrix) const override {
    layer.jacobian(t, q, matrix);
  }
  double event(double, std::span<const double>) const override { return 1.0; }
  std::string component_name(std::size_t i) const override { return layer.component_name(i); }
  const ShearLayer& layer;
};

struct Followed {
  std::vector<double> velocity;  ///< of the cells at the end
  long steps = 0;
};

/// From time 0 to that of half a swing.
Followed follow(int cells, double tolerance) {
  const Layer layer = make_layer(table_of(frictional_spheres()), chute(24, mass, soft));
  const ShearLayer system(DiscreteLayer(layer, MassGrid(layer.mass, cells, 1.5)), 0.0);
  Motion start;
  for (const double M : system.discrete().grid().centre)
    start.velocity.push_back(amplitude(0.0) * (std::pow(mass, 1.5) - std::pow(M, 1.5)));
  const Manufactured manufactured(system);
  const std::vector<double> q = system.state(start);
  OdeSolver solver(manufactured,
                   q,
                   {.relative_tolerance = tolerance,
                    .absolute_tolerance = 1e-3 * tolerance,
                    .end_time = 10.0,
                    .stop_at_event = false});
  while (solver.step() != OdeSolver::Step::end) {
  }
  return {system.motion(solver.state()).velocity, solver.statistics().steps};
}

TEST(V14ManufacturedSolution, IsSecondOrderInSpaceForTheFullLaw) {
  double previous = 0.0;
  for (const int cells : {25, 50, 100, 200, 400}) {
    const std::vector<double> u = follow(cells, 1e-10).velocity;
    const MassGrid grid(mass, cells, 1.5);
    double error = 0.0;
    for (std::size_t k = 0; k < u.size(); ++k)
      error = std::max(
          error,
          std::abs(u[k] - amplitude(10.0) * (std::pow(mass, 1.5) - std::pow(grid.centre[k], 1.5))));
    if (previous > 0.0) {
      const double order = std::log2(previous / error);
      verify(
          "V14", fmt::format("order in space, {} to {} cells", cells / 2, cells), 2.0, order, 0.1);
    }
    previous = error;
  }
}

/// Slope of the least-squares line through points.
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  double mean_x = 0.0, mean_y = 0.0, covariance = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / static_cast<double>(x.size());
    mean_y += y[i] / static_cast<double>(x.size());
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    covariance += (x[i] - mean_x) * (y[i] - mean_y);
    variance += (x[i] - mean_x) * (x[i] - mean_x);
  }
  return covariance / variance;
}

/// CVODE keeps the error of each step at the tolerance, so after n steps the solution is off by n
/// tolerances: slope 1 against their product. As a method of order p takes tolerance^(-1 / (p + 1))
/// steps, the slope against the tolerance alone is p / (p + 1), 5/6 at the highest order of BDF;
/// that would be 1 for an error kept per unit of time. Reference on the same grid, so no error of
/// space; single runs scatter by a factor of 3 (the error changes sign), 29 over seven decades by
/// 0.03 in the slope.
TEST(V14ManufacturedSolution, HasATimeErrorOfTheToleranceTimesTheSteps) {
  for (const int cells : {25, 50, 100}) {
    const std::vector<double> exact = follow(cells, 1e-13).velocity;
    std::vector<double> tolerance, accumulated, error;
    for (double exponent = 3.0; exponent <= 10.0; exponent += 0.25) {
      const double t = std::pow(10.0, -exponent);
      const Followed run = follow(cells, t);
      double largest = 0.0;
      for (std::size_t k = 0; k < exact.size(); ++k)
        largest = std::max(largest, std::abs(run.velocity[k] - exact[k]) / exact[0]);
      tolerance.push_back(std::log(t));
      accumulated.push_back(std::log(t * static_cast<double>(run.steps)));
      error.push_back(std::log(largest));
      EXPECT_LT(largest, t * static_cast<double>(run.steps));
    }
    const std::string on = fmt::format(", {} cells", cells);
    verify("V14",
           "slope of error against tolerance times steps" + on,
           1.0,
           slope(accumulated, error),
           0.1);
    verify("V14", "slope of error against tolerance" + on, 5.0 / 6.0, slope(tolerance, error), 0.1);
  }
}

/// Height of the surface of a start at 30 degrees (it dilates) from the continuity equation on a
/// grid fixed in z: dphi/dt = -dF/dz gives the flux F(z) below z, and the surface rises with the
/// velocity w = F / phi just below it.
double rebuilt_height(const TransientChute& run) {
  const int bins = 4000;
  const double first = run.snapshots.front().profile.height;
  const auto phi_at = [](const Profile& profile, double z) {
    std::size_t i = 1;
    while (i + 1 < profile.rows.size() && profile.rows[i].z < z) ++i;
    const ProfileRow& a = profile.rows[i - 1];
    const ProfileRow& b = profile.rows[i];
    return a.volume_fraction + (z - a.z) / (b.z - a.z) * (b.volume_fraction - a.volume_fraction);
  };
  const double top = 0.995 * first;
  const double dz = top / bins;
  double height = first;
  for (std::size_t n = 1; n < run.snapshots.size(); ++n) {
    const Profile& before = run.snapshots[n - 1].profile;
    const Profile& after = run.snapshots[n].profile;
    double lost = 0.0;
    for (int i = 0; i < bins; ++i) {
      const double z = (i + 0.5) * dz;
      lost += (phi_at(before, z) - phi_at(after, z)) * dz;
    }
    // what passed `top` fills the height above it at the volume fraction it has there
    const double phi_before = phi_at(before, top), phi_after = phi_at(after, top);
    const double above = (height - top) * phi_before;  // mass above `top`: phi is uniform there
    height = top + (above + lost) / phi_after;
  }
  return height;
}

TEST(V12FreeSurface, RisesAsTheContinuityEquationOnAFixedGridSays) {
  std::vector<double> times;
  for (int i = 0; i <= 20; ++i) times.push_back(50.0 * i);
  const auto run = start_from_rest(
      table_of(frictional_spheres()), chute(30, 52.2), {.cells = 400, .output_times = times});
  const double first = run.snapshots.front().profile.height;
  const double last = run.snapshots.back().profile.height;
  EXPECT_GT(last, 1.02 * first);  // it dilates
  // phi varies by some percent over the 0.5 % of the depth taken as uniform, and is interpolated
  // between 400 rows
  verify("V12", "rise rebuilt / rise", 1.0, (rebuilt_height(run) - first) / (last - first), 0.01);
}

}  // namespace
}  // namespace grainlaw::continuum
