// Steady chute against closed forms and against digits computed independently to 1e-10.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "continuum/bagnold_profile.h"
#include "tests/continuum/example_laws.h"
#include "tests/verification/verified.h"

namespace grainlaw::continuum {
namespace {

TEST(V1BagnoldFlow, FollowsTheThreeHalvesPowerOfDepth) {
  const double phi = 0.58, mass = 29.0, cosine = std::cos(24 * degree);
  const auto profile = steady_chute(table_of(incompressible_spheres()), chute(24, mass)).profile;
  const double I = 0.7184 * (std::tan(24 * degree) - 0.3530) / (0.7148 - std::tan(24 * degree));
  const auto exact = [&](double mass_above) {
    const double depth = mass_above / phi;
    return 2.0 / 3.0 * I * std::sqrt(phi * cosine) *
           (std::pow(mass / phi, 1.5) - std::pow(depth, 1.5));
  };
  Largest error;
  for (const auto& row : profile.rows)
    error.add((row.velocity - exact(row.mass_above)) / exact(0.0));
  verify("V1", "error of the steady profile", 0.0, error.value(), 1e-13);
  verify_relative("V1", "height at M = 29, phi = 0.58", mass / phi, profile.height, 1e-13);
}

struct BagnoldDigits {
  double a, b, tau_c, surface_velocity, velocity_at_40;
};

/// Depth 50, phi 0.58, 24 degrees; y = 40 below the surface is row 1 of 6.
TEST(V2GeneralisedBagnold, HasTheProfileOfBrewsterEquation9) {
  for (const auto& [a, b, tau_c, surface, at_40] :
       {BagnoldDigits{1.3, 0, 0, 100.406705641, 28.5615154939},
        BagnoldDigits{1.3, 0.8, 0, 86.4906814575, 25.6500209076},
        BagnoldDigits{1.3, 0.8, 6, 28.020844029, 15.9659003098},
        BagnoldDigits{1.3, 1e-12, 6, 34.5793398116, 18.7912166248},
        BagnoldDigits{1e-12, 0.8, 6, 88.9815483911, 57.6978298031}}) {
    const auto steady =
        steady_chute(table_of(bagnold_at_24_degrees(a, b, tau_c)), chute(24, 29), {.rows = 6});
    const std::string law = fmt::format(", a = {:g}, b = {:g}, tau_c = {:g}", a, b, tau_c);
    verify_relative("V2", "u_s" + law, surface, steady.profile.surface_velocity, 1e-10);
    verify_relative("V2", "u at depth 40" + law, at_40, steady.profile.rows[1].velocity, 1e-10);
    EXPECT_EQ(steady.answer.outcome, tau_c > 0.0 ? Outcome::plug : Outcome::steady);
    if (tau_c > 0.0) {
      const double plug = steady.profile.plug_mass / 0.58;
      verify_relative("V2", "plug depth" + law, 25.4337241611, plug, 1e-10);
    }
  }
}

TEST(V2GeneralisedBagnold, QuadratureAndClosedFormAgreeToRounding) {
  const double c = 0.58 * std::sin(24 * degree);
  for (const auto& [a, b, tau_c] : {std::array{1.3, 0.0, 0.0}, {1.3, 0.01, 2.0}, {1e-9, 0.8, 6.0}})
    for (const auto& row :
         steady_chute(table_of(bagnold_at_24_degrees(a, b, tau_c)), chute(24, 29)).profile.rows) {
      const double exact = bagnold_velocity(a, b, tau_c, c, 50.0, row.mass_above / 0.58);
      EXPECT_NEAR(row.velocity, exact, 2e-14 * bagnold_velocity(a, b, tau_c, c, 50.0, 0.0));
    }
}

/// Values of the printed form of eq. 9, exact where it has no cancellation.
TEST(V2GeneralisedBagnold, ClosedFormHasTheValuesOfThePrintedEquation) {
  const auto at_height = [](double a, double b, double z) {
    return bagnold_velocity(a, b, 0.0, 0.43, 90.0, 90.0 - z);
  };
  EXPECT_NEAR(at_height(26, 10, 10), 10.086737, 5e-7);
  EXPECT_NEAR(at_height(26, 10, 45), 39.459184, 5e-7);
  EXPECT_NEAR(at_height(26, 10, 90), 58.352155, 5e-7);
  EXPECT_NEAR(at_height(26, 0, 10), 11.854803, 5e-7);
  EXPECT_NEAR(at_height(26, 0, 45), 47.320870, 5e-7);
  EXPECT_NEAR(at_height(0, 20, 10), 18.275, 1e-12);
  EXPECT_NEAR(at_height(0, 20, 90), 87.075, 1e-12);
}

/// tau = c0 + p (mu0 + beta I) at constant density: with P = phi cos(theta) y and y the depth,
/// gd = [(tan(theta) - mu0) sqrt(P) - c0 / sqrt(P)] / beta below y_c = c0 / (phi cos (tan - mu0)).
TEST(V3CohesiveLinearLaw, HasTheElementaryProfileOverAPlug) {
  const double phi = 0.58, mass = 29.0, mu0 = 0.3530, beta = 0.6, theta = 24 * degree;
  MuPhi law = incompressible_spheres();
  law.friction = {.mu0 = mu0, .beta = beta};
  for (const double c0 : {0.0, 1e-6, 0.1, 0.8}) {
    law.cohesion_stress = CohesionStress{.factor = c0 / 2.0};
    const auto steady = steady_chute(table_of(law), chute(24, mass, {.adhesion = 2.0}));
    const double k = phi * std::cos(theta), drive = std::tan(theta) - mu0;
    const double edge = c0 / (k * drive);
    const auto integral = [&](double y) {
      return (2.0 / 3.0 * drive * std::sqrt(k) * y * std::sqrt(y) - 2.0 * c0 * std::sqrt(y / k)) /
             beta;
    };
    const double surface = integral(mass / phi) - integral(edge);
    Largest error;
    for (const auto& row : steady.profile.rows) {
      const double exact = integral(mass / phi) - integral(std::max(edge, row.mass_above / phi));
      error.add((row.velocity - exact) / surface);
    }
    verify("V3", fmt::format("error of the profile, c0 = {:g}", c0), 0.0, error.value(), 1e-12);
    EXPECT_NEAR(steady.profile.plug_mass, phi * edge, 1e-12 * mass);
    EXPECT_EQ(steady.answer.outcome, c0 > 0.0 ? Outcome::plug : Outcome::steady);
  }
}

/// tau = A p^e + p (mu0 + beta I), the cohesion factor Bo^b p*^g with A = factor f_a^b k_n^-g and
/// e = 1 - b + g: gd = [(tan(theta) - mu0) P^(1/2) - A P^(e-1/2)] / beta below P_c, A P_c^(e-1) =
/// tan - mu0. The factor is that of P_c = f_a: Bo = 1 at the edge.
TEST(V3CohesiveLinearLaw, HasTheElementaryProfileAlsoWithPowersOfBoAndSoftness) {
  const double phi = 0.58, mass = 29.0, mu0 = 0.3530, beta = 0.6, theta = 24 * degree;
  const double k_n = 2e4, f_a = 3.0, k = phi * std::cos(theta), drive = std::tan(theta) - mu0;
  MuPhi law = incompressible_spheres();
  law.friction = {.mu0 = mu0, .beta = beta};
  for (const auto& [b, g] : {std::pair{1.44, 0.67}, {0.9, 0.29}}) {
    const double e = 1.0 - b + g, A = drive * std::pow(f_a, 1.0 - e), edge = f_a / k;
    law.cohesion_stress = CohesionStress{
        .factor = drive * std::pow(k_n / f_a, g), .bond_exponent = b, .softness_exponent = g};
    const auto steady =
        steady_chute(table_of(law), chute(24, mass, {.stiffness = k_n, .adhesion = f_a}));
    const auto integral = [&](double y) {
      return (2.0 / 3.0 * drive * std::sqrt(k) * y * std::sqrt(y) -
              A * std::pow(k * y, e + 0.5) / (k * (e + 0.5))) /
             beta;
    };
    const double surface = integral(mass / phi) - integral(edge);
    Largest error;
    for (const auto& row : steady.profile.rows) {
      const double exact = integral(mass / phi) - integral(std::max(edge, row.mass_above / phi));
      error.add((row.velocity - exact) / surface);
    }
    const auto name = fmt::format("error of the profile, Bo^{:g} p*^{:g}", b, g);
    verify("V3", name, 0.0, error.value(), 1e-12);
    EXPECT_NEAR(steady.profile.plug_mass, phi * edge, 1e-12 * mass);
  }
}

/// The law of closure (A) that such a chute obeys: tau_c = c0 tan / (tan - mu0) and, with K =
/// (tan - mu0) / beta and P_c = c0 / (tan - mu0), tau - tau_c = tan / (2 K^2) (gd^2 + gd sqrt(gd^2
/// + 4 K^2 P_c)): cohesion alone looks like a linear term.
TEST(V3CohesiveLinearLaw, LooksLikeAGeneralisedBagnoldLawOfItsTilt) {
  const double mu0 = 0.3530, beta = 0.6, c0 = 0.4, tangent = std::tan(24 * degree);
  MuPhi law = incompressible_spheres();
  law.friction = {.mu0 = mu0, .beta = beta};
  law.cohesion_stress = CohesionStress{.factor = c0};
  const auto profile = steady_chute(table_of(law), chute(24, 29, {.adhesion = 1.0})).profile;
  const double K = (tangent - mu0) / beta, P_c = c0 / (tangent - mu0);
  for (const auto& row : profile.rows) {
    if (row.shear_rate == 0.0) continue;
    const double gd = row.shear_rate;
    const double tau =
        c0 * tangent / (tangent - mu0) +
        tangent / (2.0 * K * K) * (gd * gd + gd * std::sqrt(gd * gd + 4 * K * K * P_c));
    EXPECT_NEAR(row.shear_stress, tau, 1e-12 * tau);
  }
}

/// mu = mu0 + A I^n at constant density, without cohesion: Bagnold's profile with the I of the
/// tilt.
TEST(PowerLaw, FlowsAsBagnoldWithItsOwnInertialNumber) {
  MuPhi law = incompressible_spheres();
  law.friction = {.mu0 = 0.3530, .beta = 0.4, .exponent = 0.7};
  const double I = std::pow((std::tan(24 * degree) - 0.3530) / 0.4, 1.0 / 0.7);
  const auto profile = steady_chute(table_of(law), chute(24, 29)).profile;
  const double scale = 2.0 / 3.0 * I * std::sqrt(std::cos(24 * degree)) / 0.58;
  for (const auto& row : profile.rows)
    EXPECT_NEAR(row.velocity,
                scale * (std::pow(29.0, 1.5) - std::pow(row.mass_above, 1.5)),
                1e-13 * scale * std::pow(29.0, 1.5));
}

/// Side walls at constant density: tau / p = tan(theta) - mu_w K y / W, so mu(I) = mu0 + beta I
/// flows down to y_f = W (tan(theta) - mu0) / (mu_w K) and rests below.
TEST(V8SideWalls, LetTheClosedFormDepthFlowAndHoldTheRest) {
  const double phi = 0.58, mu0 = 0.3530, beta = 0.6, theta = 24 * degree, K = 0.85;
  MuPhi law = incompressible_spheres();
  law.friction = {.mu0 = mu0, .beta = beta};
  for (const double width : {60.0, 1000.0}) {  // the first leaves a part at rest
    auto inclined = chute(24, 29);
    inclined.walls = SideWalls{.width = width, .friction = 0.3, .pressure_ratio = K};
    const auto steady = steady_chute(table_of(law), inclined);
    ASSERT_EQ(steady.answer.outcome, Outcome::steady) << steady.answer.text;
    const double m = 0.3 * K / width, drive = std::tan(theta) - mu0, k = phi * std::cos(theta);
    const double depth = std::min(drive / m, 50.0);
    const auto integral = [&](double y) {
      return std::sqrt(k) / beta *
             (2.0 / 3.0 * drive * std::pow(y, 1.5) - 0.4 * m * std::pow(y, 2.5));
    };
    const double surface = integral(depth);
    Largest error;
    for (const auto& row : steady.profile.rows) {
      const double y = row.mass_above / phi;
      error.add((row.velocity - surface + integral(std::min(y, depth))) / surface);
      EXPECT_EQ(row.shear_rate > 0.0, y > 0.0 && y <= depth * (1.0 + 1e-12));
      EXPECT_NEAR(row.shear_stress, row.pressure * (std::tan(theta) - m * y), 1e-10 * 12.0);
    }
    verify("V8", fmt::format("error of the profile, W = {:g}", width), 0.0, error.value(), 1e-10);
    EXPECT_NEAR(steady.profile.height, 50.0, 1e-10 * 50.0);
    EXPECT_EQ(steady.answer.text.find("held by the walls") != std::string::npos, width == 60.0);
  }
}

TEST(V8SideWalls, WithDilationAndInTimeAgreeWithTheMarchFromTheSurface) {
  const auto table = table_of(frictional_spheres());
  for (const GrainProperties& grains : {GrainProperties{}, GrainProperties{.adhesion = 1.0}}) {
    auto inclined = chute(26, 29.75, grains);
    inclined.walls = SideWalls{.width = 60.0, .friction = 0.3, .pressure_ratio = 0.85};
    const auto steady = steady_chute(table, inclined);
    const auto run = start_from_rest(table, inclined);
    EXPECT_EQ(run.answer.outcome, steady.answer.outcome) << run.answer.text;
    // grid: 1e-5, and an edge to the part at rest within a cell of 1/200
    EXPECT_NEAR(run.final_profile.surface_velocity,
                steady.profile.surface_velocity,
                2e-4 * steady.profile.surface_velocity);
    // grains that rest at the walls creep by the sticking speed
    EXPECT_NEAR(run.final_profile.rows[3].velocity, 0.0, 1e-5);
  }
}

TEST(V8SideWalls, FarApartChangeNothing) {
  const auto table = table_of(frictional_spheres());
  const GrainProperties cohesive{.stiffness = 381971.8634, .adhesion = 5.0};
  const auto open = steady_chute(table, chute(24, 52.2, cohesive)).profile;
  auto inclined = chute(24, 52.2, cohesive);
  inclined.walls = SideWalls{.width = 1e14, .friction = 0.3};
  const auto walled = steady_chute(table, inclined).profile;
  // fourth order in 1000 steps, kink at Bo = 5 inside one
  EXPECT_NEAR(walled.surface_velocity, open.surface_velocity, 1e-9 * open.surface_velocity);
  EXPECT_NEAR(walled.height, open.height, 1e-7 * open.height);
  EXPECT_NEAR(walled.flux, open.flux, 1e-9 * open.flux);
  EXPECT_NEAR(walled.plug_mass, open.plug_mass, 1e-10);
}

TEST(SlipLength, AddsItsShareOfTheBaseShearRateToTheWholeProfile) {
  for (const MuPhi& law : {frictional_spheres(), incompressible_spheres()}) {
    const auto still = steady_chute(table_of(law), chute(24, 29)).profile;
    auto inclined = chute(24, 29);
    inclined.slip_length = 2.5;
    const auto slipping = steady_chute(table_of(law), inclined).profile;
    const double slip = 2.5 * still.rows.front().shear_rate;
    for (std::size_t i = 0; i < still.rows.size(); ++i)
      EXPECT_NEAR(slipping.rows[i].velocity, still.rows[i].velocity + slip, 1e-13 * 50.0);
    EXPECT_NEAR(slipping.flux, still.flux + 29.0 * slip, 1e-12 * slipping.flux);
    const auto run = start_from_rest(table_of(law), inclined);
    EXPECT_EQ(run.answer.outcome, Outcome::steady) << run.answer.text;
    EXPECT_NEAR(run.final_profile.surface_velocity,
                slipping.surface_velocity,
                1e-5 * slipping.surface_velocity);                            // grid
    EXPECT_NEAR(run.final_profile.rows.front().velocity, slip, 1e-7 * slip);  // residual
  }
}

TEST(SlipLength, ActsOnACohesiveLayerToo) {
  auto inclined = chute(24, 29);
  inclined.slip_length = 2.5;
  const auto table = table_of(bagnold_at_24_degrees(1.3, 0.8, 6.0));
  const auto run = start_from_rest(table, inclined);
  EXPECT_EQ(run.answer.outcome, Outcome::plug) << run.answer.text;
  EXPECT_NEAR(run.final_profile.surface_velocity,
              *run.quadrature_surface_velocity,
              1e-4 * *run.quadrature_surface_velocity);
}

TEST(V13Limits, OfVanishingParametersAreTheSimplerLaws) {
  const auto velocity = [](const auto& law, const GrainProperties& grains) {
    return steady_chute(table_of(law), chute(24, 29, grains)).profile.surface_velocity;
  };
  const MuPhi full = frictional_spheres();
  MuPhi rigid = full;
  rigid.softness_friction.reset();
  rigid.softness_volume_fraction.reset();
  MuPhi cohesionless = full;
  cohesionless.cohesion_friction.reset();
  cohesionless.cohesion_volume_fraction.reset();
  const double plain = velocity(full, {});
  const auto same = [](const char* limit, double found, double simpler) {
    verify("V13", limit, 0.0, std::abs(found / simpler - 1.0), 1e-12);
  };
  same("difference of u_s, k_n -> infinity", velocity(rigid, {.stiffness = 1e4}), plain);
  same("difference of u_s, f_a -> 0", velocity(full, {.adhesion = 1e-15}), plain);
  EXPECT_NEAR(velocity(cohesionless, {.adhesion = 1e-15}), plain, 1e-12 * plain);
  MuPhi additive = cohesionless, power = cohesionless;
  additive.cohesion_stress = CohesionStress{.factor = 0.4};
  power.cohesion_stress =
      CohesionStress{.factor = 0.4, .bond_exponent = 1.0 + 1e-15, .softness_exponent = 1e-16};
  const GrainProperties sticky{.stiffness = 381971.8634, .adhesion = 0.5};
  same("difference of u_s, Bo^b p*^g with b -> 1 and g -> 0",
       velocity(power, sticky),
       velocity(additive, sticky));
  const double bagnold = velocity(bagnold_at_24_degrees(1.3, 0, 0), {});
  same(
      "difference of u_s, tau_c -> 0", velocity(bagnold_at_24_degrees(1.3, 0, 1e-14), {}), bagnold);
  same("difference of u_s, b -> 0", velocity(bagnold_at_24_degrees(1.3, 1e-14, 0), {}), bagnold);
  const double linear = velocity(bagnold_at_24_degrees(0, 0.8, 0), {});
  same("difference of u_s, a -> 0", velocity(bagnold_at_24_degrees(1e-16, 0.8, 0), {}), linear);
}

struct LawDigits {
  GrainProperties grains;
  double surface_velocity, height, base_inertial_number;
};

/// Frictional spheres, M0 = 52.2, 24 degrees. The height of the cohesive layer needs the quadrature
/// to be split where the cohesion terms have their kink, Bo = 5 at M = f_a / (5 cos(theta));
/// without that it comes out 5e-9 off.
TEST(V5FullLaw, HasTheDigitsOfAnIndependentQuadrature) {
  for (const auto& [grains, surface, height, I] :
       {LawDigits{{}, 104.0202926240, 91.9285336043, .2457868620},
        LawDigits{{.stiffness = 381971.8634}, 113.8802833418, 92.2622260073, .2756777989},
        LawDigits{{.stiffness = 3819.718634}, 264.1169668997, 95.6142718026, .7872329053},
        LawDigits{{.stiffness = 381971.8634, .adhesion = 5.0},
                  95.1035087470,
                  94.5588780344,
                  .2630411702}}) {
    const auto profile =
        steady_chute(table_of(frictional_spheres()), chute(24, 52.2, grains)).profile;
    const std::string of = fmt::format(
        ", k_n = {}, f_a = {:g}",
        grains.stiffness ? fmt::format("{}", *grains.stiffness) : std::string("infinite"),
        grains.adhesion.value_or(0.0));
    verify_relative("V5", "u_s" + of, surface, profile.surface_velocity, 1e-9);
    verify_relative("V5", "H" + of, height, profile.height, 1e-9);
    verify_relative("V5", "I at the base" + of, I, profile.rows.front().inertial_number, 1e-9);
    const double plug = grains.adhesion ? .1005999720 : 0.0;
    verify_relative("V5", "plug share" + of, plug, profile.plug_mass / 52.2, 1e-9);
  }
}

TEST(V6FullLaw, HoldsForSlipperyGrains) {
  const auto profile =
      steady_chute(table_of(slippery_spheres()), chute(12, 52.2, {.stiffness = 381971.8634}))
          .profile;
  verify_relative("V6", "u_s at 12 degrees", 11.8888814374, profile.surface_velocity, 1e-9);
  verify_relative("V6", "H", 81.0213376336, profile.height, 1e-9);
  verify_relative("V6", "I at the base", .0315528653, profile.rows[0].inertial_number, 2e-9);
}

void expect_converged(const RheologyTable& table, const ChuteCase& inclined, double tolerance) {
  const auto few = steady_chute(table, inclined).profile;
  const auto many = steady_chute(table, inclined, {.panels = 640}).profile;
  EXPECT_NEAR(few.surface_velocity, many.surface_velocity, tolerance * many.surface_velocity);
  EXPECT_NEAR(few.height, many.height, tolerance * many.height);
  EXPECT_NEAR(few.flux, many.flux, tolerance * many.flux);
}

TEST(SteadyQuadrature, DoesNotChangeWithMorePanels) {
  const auto table = table_of(frictional_spheres());
  for (const auto& inclined : {chute(24, 52.2, {.stiffness = 381971.8634}),
                               chute(24, 52.2, {.stiffness = 381971.8634, .adhesion = 5.0}),
                               chute(19.3, 52.2, {.stiffness = 3819.718634}),  // yields inside
                               chute(33, 52.2)})
    expect_converged(table, inclined, 1e-13);
}

TEST(SteadyQuadrature, DoesNotChangeWithMorePanelsForAnyFamilyOfLaws) {
  std::vector<MuPhi> laws(5, frictional_spheres());
  laws[4].cohesion_friction.reset();
  laws[4].cohesion_stress =
      CohesionStress{.factor = 1.5, .bond_exponent = 1.44, .softness_exponent = 0.67};
  laws[1].cohesion_friction.reset();
  laws[1].cohesion_stress = CohesionStress{.factor = 0.3};
  laws[2].softness_friction->form = SoftnessForm::linear;
  laws[3].friction = {.mu0 = 0.3530, .beta = 0.4, .exponent = 0.7};
  for (const MuPhi& law : laws)
    for (const double adhesion : {1e-3, 0.1, 5.0})
      expect_converged(table_of(law),
                       chute(24, 52.2, {.stiffness = 381971.8634, .adhesion = adhesion}),
                       law.friction.exponent ? 1e-10 : 1e-12);
}

}  // namespace
}  // namespace grainlaw::continuum
