#include "apps/io/rheology_table_toml.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <memory>
#include <random>

#include "apps/io/safe_write.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw::io {
namespace {

using namespace continuum;

const std::filesystem::path tables = std::string(GRAINLAW_DATA) + "/tables";

void expect_same_bits(double a, double b) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b)) << a << " " << b;
}

RheologyTable bagnold_table() {
  RheologyTable table;
  table.law = GeneralisedBagnold{26.1, 0.1 + 0.2, 1e-17, 0.58, radians(24.2)};
  table.contact_friction = 0.5;
  table.base = EffectiveBase{1.1, 0.55, "bumpy, thickness \"1.5\" d\n\ttab"};
  table.covariance = Covariance{{"a", "b"}, {1e-3, -0.2e-3, -0.2e-3, 4.123456789012345e-4}};
  table.range.inertial_number = Range{0.01, 0.3};
  table.provenance = {.source = "grainlaw 0.1",
                      .geometry = "chute",
                      .data = {"theta23", "theta24.2"},
                      .digests = {"0123456789abcdef", "fedcba9876543210"},
                      .checked_against = {}};
  return table;
}

RheologyTable mu_phi_table(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.05, 0.95);
  MuPhi law;
  law.friction = {unit(random), unit(random), unit(random)};
  law.volume_fraction = {unit(random), unit(random) * 10.0};
  if (random() % 2 == 0) law.softness_friction = SoftnessFriction{unit(random)};
  if (random() % 2 == 0)
    law.cohesion_friction = CohesionFriction{unit(random), unit(random)};
  else if (random() % 2 == 0)
    law.cohesion_stress = CohesionStress{.factor = unit(random)};
  if (law.cohesion_stress && random() % 2 == 0) law.cohesion_stress->bond_exponent = 1.4;
  if (law.cohesion_stress && random() % 2 == 0)
    law.cohesion_stress->softness_exponent = unit(random);
  if (law.softness_friction && random() % 2 == 0)
    law.softness_friction->form = SoftnessForm::linear;
  if (random() % 2 == 0) law.friction.exponent = unit(random);
  if (random() % 2 == 0) law.softness_volume_fraction = SoftnessVolumeFraction{unit(random)};
  RheologyTable table;
  table.law = law;
  table.contact_friction = unit(random);
  const double v = std::exp(-30.0 * unit(random));
  table.covariance = Covariance{{"mu0", "phi0"}, {v, 0.3 * v, 0.3 * v, v}};
  return table;
}

void expect_same_coefficients(const RheologyTable& a, const RheologyTable& b) {
  ASSERT_EQ(coefficient_names(a), coefficient_names(b));
  for (const std::string& name : coefficient_names(a)) {
    expect_same_bits(coefficient(a, name), coefficient(b, name));
  }
  ASSERT_EQ(a.covariance->names, b.covariance->names);
  for (std::size_t k = 0; k < a.covariance->matrix.size(); ++k) {
    expect_same_bits(a.covariance->matrix[k], b.covariance->matrix[k]);
  }
}

TEST(RheologyTableToml, WritingAndReadingKeepsEveryBitAndEveryByte) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const RheologyTable table = mu_phi_table(random);
    const std::string text = to_toml(table);
    const RheologyTable again = parse_table(text, "table.toml");
    expect_same_coefficients(table, again);
    EXPECT_EQ(to_toml(again), text);
  }
}

TEST(RheologyTableToml, ABagnoldTableKeepsEveryBitWordAndUnit) {
  const RheologyTable table = bagnold_table();
  const TemporaryDirectory directory;
  write_table(table, directory / "table.toml");
  const RheologyTable again = read_table(directory / "table.toml");
  expect_same_coefficients(table, again);
  EXPECT_EQ(again.base->recipe, table.base->recipe);
  EXPECT_EQ(again.provenance.data, table.provenance.data);
  EXPECT_EQ(again.provenance.geometry, "chute");
  EXPECT_EQ(again.provenance.digests, table.provenance.digests);
  EXPECT_EQ(again.definitions.stress, table.definitions.stress);
  EXPECT_EQ(again.range.inertial_number->upper, 0.3);
  EXPECT_FALSE(again.range.softness);
  EXPECT_EQ(to_toml(again), read_file(directory / "table.toml"));
}

TEST(RheologyTableToml, TiltsComeBackExactlyInDegreesOrElseInRadians) {
  std::mt19937_64 random(5);
  for (int k = 0; k < 500; ++k) {
    RheologyTable table = bagnold_table();
    auto& law = std::get<GeneralisedBagnold>(table.law);
    law.inclination =
        k < 300 ? radians(k / 10.0) : std::uniform_real_distribution<double>(0.0, 1.5)(random);
    const std::string text = to_toml(table);
    const RheologyTable again = parse_table(text, "t");
    expect_same_bits(std::get<GeneralisedBagnold>(again.law).inclination, law.inclination);
    if (k < 300) {
      EXPECT_EQ(text.find("inclination_radians"), std::string::npos) << k;
    }
  }
}

TEST(RheologyTableToml, ConstantVolumeFractionIsWrittenAsInfiniteIphi) {
  std::mt19937_64 random(1);
  RheologyTable table = mu_phi_table(random);
  std::get<MuPhi>(table.law).volume_fraction.I_phi = INFINITY;
  const RheologyTable again = parse_table(to_toml(table), "t");
  EXPECT_EQ(std::get<MuPhi>(again.law).volume_fraction.I_phi, INFINITY);
}

/// A table whose mu(I) goes through three pairs.
RheologyTable tabulated_table(std::vector<double> I, std::vector<double> mu) {
  std::mt19937_64 random(1);
  RheologyTable table = mu_phi_table(random);
  table.covariance.reset();
  auto& law = std::get<MuPhi>(table.law);
  law.friction = {};
  law.friction.tabulated = std::make_shared<const MonotoneCurve>(std::move(I), std::move(mu));
  return table;
}

TEST(RheologyTableToml, TabulatedFrictionKeepsItsPairsAndTheirRange) {
  const RheologyTable table = tabulated_table({0.0, 0.1 + 0.2, 0.7}, {0.3, 0.4, 1.0 / 1.5});
  const RheologyTable again = parse_table(to_toml(table), "t");
  const auto& curve = *std::get<MuPhi>(again.law).friction.tabulated;
  EXPECT_EQ(curve.x(), std::get<MuPhi>(table.law).friction.tabulated->x());
  EXPECT_EQ(curve.y(), std::get<MuPhi>(table.law).friction.tabulated->y());
  EXPECT_EQ(again.range.inertial_number->upper, 0.7);
  EXPECT_EQ(to_toml(parse_table(to_toml(again), "t")), to_toml(again));
  EXPECT_EQ(coefficient_names(again).front(), coefficient_names(table).front());
  EXPECT_NE(coefficient_names(again).front(), "mu0");
}

TEST(RheologyTableToml, DipOfTabulatedFrictionIsRefusedAtItsLine) {
  std::string text = to_toml(tabulated_table({0.0, 0.1, 0.2}, {0.3, 0.4, 0.5}));
  const std::string rising = "friction = [0.3, 0.4, 0.5]";
  text.replace(text.find(rising), rising.size(), "friction = [0.4, 0.3, 0.5]");
  try {
    parse_table(text, "t.toml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("does not rise from I = 0 to 0.1"), std::string::npos)
        << error.what();
  }
}

TEST(RheologyTableToml, TermsTheLawDoesNotHaveHaveNoKey) {
  std::mt19937_64 random(1);
  RheologyTable table = mu_phi_table(random);
  auto& law = std::get<MuPhi>(table.law);
  law.friction.kappa = 0.0;
  law.volume_fraction.I_phi = INFINITY;
  law.cohesion_volume_fraction = CohesionVolumeFraction{.p1 = -0.1, .p2 = 0.02};
  table.covariance.reset();
  const std::string text = to_toml(table);
  for (const char* key : {"kappa", "I_phi", "p3", "p4"}) {
    EXPECT_EQ(text.find(std::string("\n") + key + " ="), std::string::npos) << key << "\n" << text;
  }
  const RheologyTable again = parse_table(text, "t");
  const auto& same = std::get<MuPhi>(again.law);
  EXPECT_EQ(same.friction.kappa, 0.0);
  EXPECT_EQ(same.cohesion_volume_fraction->p2, 0.02);
  EXPECT_EQ(same.cohesion_volume_fraction->p4, 0.0);
  EXPECT_EQ(to_toml(again), text);
}

TEST(RheologyTableToml, TermThatIsZeroWithAnErrorKeepsItsKey) {
  std::mt19937_64 random(1);
  RheologyTable table = mu_phi_table(random);
  std::get<MuPhi>(table.law).friction.kappa = 0.0;
  table.covariance = Covariance{.names = {"kappa"}, .matrix = {0.01}};
  const std::string text = to_toml(table);
  EXPECT_NE(text.find("\nkappa = 0.0"), std::string::npos) << text;
  EXPECT_EQ(to_toml(parse_table(text, "t")), text);
}

TEST(RheologyTableToml, LimitAndScaleOfFrictionGiveTheSameLaw) {
  const RheologyTable table = read_table(tables / "shi2020_mu_p_0.50.toml");
  const InertialFriction& mu = std::get<MuPhi>(table.law).friction;
  // Shi et al. (2020), table 7: mu0 0.3530, mu_inf 0.7148, I_mu 0.7184; roundings of two divisions.
  EXPECT_NEAR(mu.mu0 + mu.beta / mu.kappa, 0.7148, 4e-16);
  EXPECT_NEAR(1.0 / mu.kappa, 0.7184, 4e-16);
}

/// mu(I, p*, Bo) and phi as printed in the paper, from the coefficients of a table.
double friction_of(const MuPhi& law, double I, double p, double Bo) {
  const double mu_I = law.friction.mu0 + law.friction.beta * I / (1.0 + law.friction.kappa * I);
  const double softness = 1.0 - std::sqrt((1.0 + Bo) * p / law.softness_friction->p_mu);
  return mu_I * softness *
         (1.0 + law.cohesion_friction->alpha * std::pow(Bo, law.cohesion_friction->beta));
}

TEST(RheologyTableToml, PublishedTablesGiveTheFrictionOfThePublishedLaw) {
  // Shi et al. (2020), eq. 1A at I = 0.02, p* = 0.01, four digits computed by hand.
  const auto law = [](const char* name) { return std::get<MuPhi>(read_table(tables / name).law); };
  const MuPhi smooth = law("shi2020_mu_p_0.00.toml");
  const MuPhi slippery = law("shi2020_mu_p_0.01.toml");
  const MuPhi rough = law("shi2020_mu_p_0.50.toml");
  const double half_digit = 0.5e-4;
  EXPECT_NEAR(friction_of(smooth, 0.02, 0.01, 0.0), 0.1582, half_digit);
  EXPECT_NEAR(friction_of(slippery, 0.02, 0.01, 1.0), 0.2326, half_digit);
  EXPECT_NEAR(friction_of(rough, 0.02, 0.01, 5.0), 0.8625, half_digit);
  EXPECT_NEAR(rough.volume_fraction.phi0 * (1.0 - 0.02 / rough.volume_fraction.I_phi) *
                  (1.0 + 0.01 / rough.softness_volume_fraction->p_phi),
              0.6134,
              half_digit);
}

TEST(RheologyTableToml, PublishedTablesStateNoErrors) {
  for (const auto& entry : std::filesystem::directory_iterator(tables)) {
    const RheologyTable table = read_table(entry.path());
    EXPECT_FALSE(table.covariance) << entry.path();
    EXPECT_FALSE(table.provenance.source.empty());
  }
}

TEST(RheologyTableToml, ATableInAnotherSetNeedsACaseInThatSet) {
  RheologyTable table = bagnold_table();
  table.units = "si";
  EXPECT_THROW(in_grain_units(table, grain_units()), InputError);
  const Units si = si_units(1e-3, 2500.0, 9.81);
  const RheologyTable converted = in_grain_units(table, si);
  EXPECT_EQ(converted.units, "grain");
  // a gd^2 is a stress: a internal = a [kg/m] / (m/d).
  EXPECT_DOUBLE_EQ(std::get<GeneralisedBagnold>(converted.law).a, 26.1 * si.length / si.mass);
}

TEST(RheologyTableToml, ATableThatLeavesPhysicsIsNotWritten) {
  const TemporaryDirectory directory;
  RheologyTable table = bagnold_table();
  std::get<GeneralisedBagnold>(table.law).volume_fraction = 1.5;
  EXPECT_THROW(write_table(table, directory / "t.toml"), TableError);
  EXPECT_FALSE(std::filesystem::exists(directory / "t.toml"));
}

/// The blocks between ```toml and ``` that are tables.
std::vector<std::string> table_blocks(const std::string& markdown) {
  const std::string fence = "```toml\n";
  std::vector<std::string> blocks;
  for (std::size_t at = markdown.find(fence); at != std::string::npos;
       at = markdown.find(fence, at + 1)) {
    const std::size_t begin = at + fence.size();
    std::string block = markdown.substr(begin, markdown.find("```", begin) - begin);
    if (block.find("[law]") != std::string::npos) blocks.push_back(std::move(block));
  }
  return blocks;
}

TEST(RheologyTableToml, TheExamplesOfTheDocumentationAreTables) {
  const auto blocks = table_blocks(read_file(GRAINLAW_DOCS "/formats.md"));
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<MuPhi>(parse_table(blocks[0], "formats.md").law));
  const RheologyTable bagnold = parse_table(blocks[1], "formats.md");
  EXPECT_EQ(std::get<GeneralisedBagnold>(bagnold.law).a, 41.0);
}

}  // namespace
}  // namespace grainlaw::io
