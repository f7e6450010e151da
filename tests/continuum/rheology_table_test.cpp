#include "continuum/rheology_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

std::string refusal(const RheologyTable& table) {
  try {
    validate(table);
  } catch (const TableError& error) {
    return error.what();
  }
  return "accepted";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

RheologyTable with_covariance(std::vector<std::string> names, std::vector<double> matrix) {
  auto table = table_of(frictional_spheres());
  table.covariance = Covariance{std::move(names), std::move(matrix)};
  return table;
}

TEST(RheologyTable, AcceptsThePublishedLaws) {
  EXPECT_EQ(refusal(table_of(frictional_spheres())), "accepted");
  EXPECT_EQ(refusal(table_of(slippery_spheres())), "accepted");
  EXPECT_EQ(refusal(table_of(incompressible_spheres())), "accepted");
}

TEST(RheologyTable, RefusesAMaterialWithoutStress) {
  EXPECT_TRUE(contains(refusal(table_of(bagnold_at_24_degrees(0, 0, 0))), "a = 0 and b = 0"));
  EXPECT_TRUE(contains(refusal(table_of(bagnold_at_24_degrees(0, 0, 6))), "a = 0 and b = 0"));
  MuPhi law = incompressible_spheres();
  law.friction = {};
  EXPECT_TRUE(contains(refusal(table_of(law)), "fluid without stress"));
}

TEST(RheologyTable, AcceptsEachTermOfBagnoldAlone) {
  EXPECT_EQ(refusal(table_of(bagnold_at_24_degrees(1.3, 0, 0))), "accepted");
  EXPECT_EQ(refusal(table_of(bagnold_at_24_degrees(0, 0.8, 0))), "accepted");
}

TEST(RheologyTable, RefusesCoefficientsThatLeavePhysicsByName) {
  EXPECT_TRUE(contains(refusal(table_of(bagnold_at_24_degrees(-1, 1, 0))), "a = -1"));
  MuPhi law = frictional_spheres();
  law.friction.beta = -0.1;  // friction falls with I: the balance is ill-posed
  EXPECT_TRUE(contains(refusal(table_of(law)), "beta = -0.1"));
  law = frictional_spheres();
  law.volume_fraction.phi0 = 1.2;
  EXPECT_TRUE(contains(refusal(table_of(law)), "phi0 = 1.2"));
  law = frictional_spheres();
  law.cohesion_volume_fraction->p1 = -2.0;
  EXPECT_TRUE(contains(refusal(table_of(law)), "volume fraction vanish"));
}

TEST(RheologyTable, RefusesCoefficientsNoGrainsHave) {
  const auto with = [](const char* coefficient, double value) {
    auto table = table_of(frictional_spheres());
    std::get<MuPhi>(table.law).friction.exponent = 1.0;
    set_coefficient(table, coefficient, value);
    return refusal(table);
  };
  EXPECT_TRUE(contains(with("beta", 1e300), "beta = 1e+300 must be at most 1e+06"));
  EXPECT_TRUE(contains(with("exponent", 1e-3), "exponent = 0.001 must be finite and at least"));
  EXPECT_TRUE(contains(with("phi0", 1e-300), "phi0 = 1e-300 must be at least 0.05"));
  EXPECT_EQ(with("beta", 1e3), "accepted");
  EXPECT_EQ(with("exponent", 0.1), "accepted");
  EXPECT_EQ(with("phi0", 0.3), "accepted");
}

TEST(RheologyTable, RefusesTwoLawsForTheSameCohesion) {
  MuPhi law = frictional_spheres();
  law.cohesion_stress = CohesionStress{.factor = 0.4};
  EXPECT_TRUE(contains(refusal(table_of(law)), "give one"));
  law.cohesion_friction.reset();
  EXPECT_EQ(refusal(table_of(law)), "accepted");
  law.friction.exponent = 0.0;
  EXPECT_TRUE(contains(refusal(table_of(law)), "exponent = 0"));
}

TEST(RheologyTable, RefusesCohesiveFrictionThatRisesWithDepth) {
  MuPhi law = incompressible_spheres();
  law.cohesion_stress =
      CohesionStress{.factor = 0.4, .bond_exponent = 0.9, .softness_exponent = 0.9};
  EXPECT_EQ(refusal(table_of(law)), "accepted");
  law.cohesion_stress->softness_exponent = 0.91;
  EXPECT_TRUE(contains(refusal(table_of(law)), "cohesion_softness_exponent = 0.91 is above 0.9"));
  law.cohesion_stress->bond_exponent = 1.4;
  EXPECT_EQ(refusal(table_of(law)), "accepted");
  law.cohesion_stress->softness_exponent = 1.1;
  EXPECT_TRUE(contains(refusal(table_of(law)), "is above 1, the smaller"));
  law.cohesion_stress->bond_exponent = 0.0;
  EXPECT_TRUE(contains(refusal(table_of(law)), "cohesion_bond_exponent = 0"));
}

TEST(RheologyTable, RefusesAMalformedCovariance) {
  EXPECT_EQ(refusal(with_covariance({"mu0", "beta"}, {1e-4, 1e-5, 1e-5, 1e-3})), "accepted");
  EXPECT_TRUE(contains(refusal(with_covariance({"mu0"}, {1e-4, 0})), "needs 1 numbers"));
  EXPECT_TRUE(contains(refusal(with_covariance({"mu9"}, {1e-4})), "'mu9'"));
  EXPECT_TRUE(contains(refusal(with_covariance({"mu0", "mu0"}, {1, 0, 0, 1})), "twice"));
  EXPECT_TRUE(contains(refusal(with_covariance({"mu0", "beta"}, {1, 0.1, 0.2, 1})), "symmetric"));
  EXPECT_TRUE(contains(refusal(with_covariance({"mu0", "beta"}, {1, 2, 2, 1})), "eigenvalue"));
  EXPECT_TRUE(contains(refusal(with_covariance({"mu0"}, {-1})), "variances -1"));
  EXPECT_TRUE(contains(refusal(with_covariance({"mu0"}, {NAN})), "nan"));
}

TEST(RheologyTable, AcceptsACovarianceWithFullyCorrelatedCoefficients) {
  // rank one: (1, 2, 3) outer (1, 2, 3)
  EXPECT_EQ(refusal(with_covariance({"mu0", "beta", "kappa"}, {1, 2, 3, 2, 4, 6, 3, 6, 9})),
            "accepted");
  // the same with one pair turned round has eigenvalues of both signs
  EXPECT_TRUE(
      contains(refusal(with_covariance({"mu0", "beta", "kappa"}, {1, 2, 3, 2, 4, -6, 3, -6, 9})),
               "eigenvalue"));
}

TEST(RheologyTable, NamesOnlyTheCoefficientsThatArePresent) {
  auto table = table_of(incompressible_spheres());
  table.base = EffectiveBase{.no_slip_height = 1.1, .mass_below = 0.5, .recipe = {}};
  EXPECT_EQ(coefficient_names(table),
            (std::vector<std::string>{
                "mu0", "beta", "kappa", "phi0", "I_phi", "no_slip_height", "mass_below"}));
  EXPECT_EQ(coefficient_names(table_of(bagnold_at_24_degrees(1, 2, 3))),
            (std::vector<std::string>{"a", "b", "tau_c", "volume_fraction"}));
  EXPECT_EQ(coefficient_names(table_of(frictional_spheres())).size(), 13u);
}

TEST(RheologyTable, EveryNamedCoefficientCanBeReadAndReplaced) {
  auto table = table_of(frictional_spheres());
  double value = 0.1;
  for (const auto& name : coefficient_names(table)) set_coefficient(table, name, value += 0.1);
  value = 0.1;
  for (const auto& name : coefficient_names(table))
    EXPECT_EQ(coefficient(table, name), value += 0.1);
  EXPECT_THROW(coefficient(table, "tau_c"), TableError);
}

}  // namespace
}  // namespace grainlaw::continuum
