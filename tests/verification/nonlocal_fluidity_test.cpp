// Nonlocal granular fluidity against closed forms, measured orders and the local law. Glass beads:
// mu_s, mu_2, I0 and A of Henann & Kamrin 2013.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "continuum/shear_band.h"
#include "continuum/shear_band_cells.h"
#include "tests/continuum/example_laws.h"
#include "tests/verification/verified.h"

namespace grainlaw::continuum {
namespace {

constexpr double A = 0.48;

MuPhi glass_beads() {
  return {.friction = saturating_friction(0.3819, 0.6435, 0.279),
          .volume_fraction = {.phi0 = 0.6, .I_phi = INFINITY}};
}

/// Values at the nodes x = h, 2h, ... between ends at x = 0 and `length`.
BandGrid nodes(double length, std::size_t intervals) {
  const double h = length / static_cast<double>(intervals);
  const std::size_t n = intervals - 1;
  return {.area = std::vector<double>(n + 1, 1.0),
          .distance = std::vector<double>(n + 1, h),
          .volume = std::vector<double>(n, h)};
}

/// p -> infinity leaves no loss; g = 1 at both ends of 20 d at mu = 0.30.
double error_of_creep(std::size_t intervals) {
  const double length = 20.0, xi = cooperativity_length(A, glass_beads().friction, 0.30);
  const BandGrid grid = nodes(length, intervals);
  const std::vector<FluidityTerms> terms(grid.cells(), {.gain = -A * A / (xi * xi), .loss = 0.0});
  const Fluidity found = solve_fluidity(grid, terms, A, 1.0, 1.0);
  double error = 0.0;
  for (std::size_t i = 0; i < grid.cells(); ++i) {
    const double x = grid.volume[0] * static_cast<double>(i + 1);
    const double exact = std::cosh((x - 0.5 * length) / xi) / std::cosh(0.5 * length / xi);
    error = std::max(error, std::abs(found.g[i] - exact));
  }
  return error;
}

TEST(V9CreepBetweenWalls, IsTheHyperbolicCosineAtSecondOrder) {
  const double xi = cooperativity_length(A, glass_beads().friction, 0.30);
  verify("V9", "cooperativity length at mu = 0.30", 1.9220, xi, 5e-5);
  const double expected[] = {6.6e-4, 1.7e-4, 4.2e-5, 1.0e-5};  // to the digits given
  for (std::size_t k = 0; k < 4; ++k)
    verify_relative("V9",
                    fmt::format("largest error of g, {} intervals", 50 << k),
                    expected[k],
                    error_of_creep(50 << k),
                    0.05);
  verify(
      "V9", "order, 200 to 400", 2.0, std::log2(error_of_creep(200) / error_of_creep(400)), 0.01);
}

/// Does a layer of this depth at uniform mu flow on a rough base, g = 0, under a free surface?
bool flows(double depth, double mu) {
  const std::size_t n = 400;
  const double h = depth / static_cast<double>(n);
  BandGrid grid{.area = std::vector<double>(n + 1, 1.0),
                .distance = std::vector<double>(n + 1, h),
                .volume = std::vector<double>(n, h)};
  grid.distance.front() = grid.distance.back() = 0.5 * h;
  const FlowCurve curve = flow_curve(glass_beads(), {}, 10.0);
  const std::vector<FluidityTerms> terms(n, *fluidity_terms(curve, 10.0 * mu, 10.0));
  return solve_fluidity(grid, terms, A, 0.0).g.back() > 0.0;
}

TEST(V10StopDepth, IsAQuarterWaveOfTheFirstGrowingMode) {
  const double expected[] = {6.7201, 3.3436, 2.1359, 1.2734};
  const double tilts[] = {21.5, 23.0, 25.0, 28.0};
  for (std::size_t k = 0; k < 4; ++k) {
    const double mu = std::tan(tilts[k] * degree);
    verify("V10",
           fmt::format("stop depth at {:g} degrees, flow and rest 1e-4 to either side", tilts[k]),
           expected[k],
           stop_depth(A, glass_beads().friction, mu),
           5e-5);
    EXPECT_TRUE(flows(expected[k] * (1.0 + 1e-4), mu)) << tilts[k];
    EXPECT_FALSE(flows(expected[k] * (1.0 - 1e-4), mu)) << tilts[k];
  }
  EXPECT_TRUE(std::isinf(stop_depth(A, glass_beads().friction, 0.38)));
}

ShearBandCase loaded_shear(double amplitude) {
  return {
      .flow =
          PlaneShear{
              .drive = {.stress = 4.5}, .extent = {.height = 60.0}, .load = 10.0, .gravity = 1.0},
      .nonlocal_amplitude = amplitude};
}

TEST(V11PlaneShearUnderGravity, HasTheWallVelocityOfAnIndependentSolution) {
  const auto local = shear_band(table_of(glass_beads()), loaded_shear(0.0));
  verify_relative("V11", "u_wall, local law", 0.40079, local.driving_velocity, 1e-4);
  verify("V11", "edge of the band, local law", 2.97, local.yielded_width, 0.005);
  EXPECT_TRUE(local.local_band_collapse);
  const auto nonlocal = shear_band(table_of(glass_beads()), loaded_shear(A));
  verify_relative("V11", "u_wall, A = 0.48", 0.36624, nonlocal.driving_velocity, 1e-4);
  EXPECT_FALSE(nonlocal.local_band_collapse);
}

/// Far from the band loss is nothing and g falls as exp(-int dy/xi) / xi^(-1/2) (WKB).
TEST(V11PlaneShearUnderGravity, CreepsOverTheCooperativityLengthFarFromTheBand) {
  const auto band = shear_band(table_of(glass_beads()), loaded_shear(A), {.cells = 3200});
  const auto fluidity = [](const ProfileRow& row) {
    return row.shear_rate * row.pressure / row.shear_stress;
  };
  double steepest = INFINITY, flattest = 0.0;
  const auto& rows = band.profile.rows;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].z < 25.0 || rows[i].z > 45.0) continue;
    const double length =
        (rows[i].z - rows[i - 1].z) / std::log(fluidity(rows[i]) / fluidity(rows[i - 1]));
    steepest = std::min(steepest, length);
    flattest = std::max(flattest, length);
  }
  EXPECT_GT(flattest, 1.31);
  EXPECT_LT(steepest, 1.31 * 1.05);
}

TEST(V11PlaneShearUnderGravity, ConvergesAtSecondOrder) {
  const auto velocity = [](int cells) {
    return shear_band(
               table_of(glass_beads()), loaded_shear(A), {.cells = cells, .most_cells = cells})
        .driving_velocity;
  };
  const double coarse = velocity(200), middle = velocity(400), fine = velocity(800);
  const double order = std::log2((coarse - middle) / (middle - fine));
  verify("V11", "order in cells, 200 to 800", 2.0, order, 0.1);
}

TEST(V13WithoutNonlocality, FluidityIsThatOfTheLocalLaw) {
  const MuPhi law = frictional_spheres();
  for (const double mu : {0.2, 0.36, 0.45, 0.6})
    for (const GrainProperties& grains :
         {GrainProperties{}, GrainProperties{.stiffness = 1e4, .adhesion = 3.0}}) {
      const double p = 7.0;
      const FlowCurve curve = flow_curve(law, grains, p);
      const std::vector<FluidityTerms> terms(3, *fluidity_terms(curve, mu * p, p));
      const auto g = solve_fluidity({{}, {}, {1.0, 1.0, 1.0}}, terms, 0.0).g;
      const double local = curve.shear_rate(*curve.scaled_rate(mu * p));
      EXPECT_NEAR(g[1] * mu, local, 1e-12 * local) << mu;
    }
}

/// A uniform band has no gradient for A to act on: any A gives the local answer.
TEST(V13WithoutNonlocality, PlaneShearWithoutGravityDoesNotFeelA) {
  ShearBandCase uniform{
      .flow = PlaneShear{.drive = {.stress = 4.5}, .extent = {.height = 60.0}, .load = 10.0}};
  const double local = shear_band(table_of(frictional_spheres()), uniform).driving_velocity;
  uniform.nonlocal_amplitude = A;
  const double nonlocal = shear_band(table_of(frictional_spheres()), uniform).driving_velocity;
  verify("V13",
         "difference of u_wall, uniform band of any A",
         0.0,
         std::abs(nonlocal / local - 1.0),
         1e-12);
}

/// Near its edge the local g is linear in the distance x, gain g ~ x g against A^2 lap g: the edge
/// is smeared over A^(2/3), which moves the velocity by A^(4/3); the wall, dg/dn = 0, only by A^2.
TEST(V13WithoutNonlocality, BandTendsToTheLocalOneWithTheFourThirdsPowerOfA) {
  const double local = shear_band(table_of(glass_beads()), loaded_shear(0.0)).driving_velocity;
  const auto difference = [&](double small) {
    const auto band =
        shear_band(table_of(glass_beads()), loaded_shear(small), {.discretisation = 1e-6});
    return band.driving_velocity / local - 1.0;
  };
  const double power = std::log10(difference(1e-2) / difference(1e-3));
  verify("V13", "power of A by which a band tends to the local one", 4.0 / 3.0, power, 0.01);
}

/// h = 0.02 d at the driving wall by default.
TEST(AnnularBand, ConvergesAtSecondOrder) {
  const auto velocity = [](int cells) {
    return shear_band(table_of(glass_beads()),
                      {.flow = AnnularShear{.drive = {.stress = 4.5},
                                            .inner_radius = 50.0,
                                            .outer_radius = 110.0,
                                            .pressure = 10.0},
                       .nonlocal_amplitude = A},
                      {.cells = cells, .most_cells = cells})
        .driving_velocity;
  };
  const double coarse = velocity(200), middle = velocity(400), fine = velocity(800);
  EXPECT_NEAR(std::log2((coarse - middle) / (middle - fine)), 2.0, 0.1);
  EXPECT_LT(std::abs(middle / fine - 1.0), 1e-4);
}

}  // namespace
}  // namespace grainlaw::continuum
