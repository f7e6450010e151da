// Cases as engineers give them: two of tilt, size and flow; grains from a data sheet.
#include "apps/io/case_input.h"

#include <gtest/gtest.h>

#include <string>

namespace grainlaw::io {
namespace {

CaseFile si_case(const std::string& grains, const std::string& chute, const std::string& top = "") {
  return parse_case("units = \"si\"\n" + top + "\n[grains]\ndensity = 2500\n" + grains +
                        "\n[chute]\ngravity = 9.81\n" + chute,
                    "case.toml");
}

std::string problem(const std::string& grains,
                    const std::string& chute,
                    const std::string& top = "") {
  try {
    si_case(grains, chute, top);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

const std::string known = "inclination = 24\ndepth = 0.1\n";
const std::string beads = "diameter = 2e-3\n";

TEST(CaseInput, StiffnessFollowsFromTheModulusAsInBrewster) {
  // d = 0.1 mm, nu = 1/4: E d / (3 (1 - 1/16)) = 7.2e9 1e-4 / 2.8125 = 2.56e5 N/m
  const auto file =
      si_case("diameter = 1e-4\nyoungs_modulus = 7.2e9\npoisson_ratio = 0.25\n", known);
  EXPECT_NEAR(*file.chute.grains.stiffness * file.units.size(dimension::stiffness), 2.56e5, 1e-6);
}

TEST(CaseInput, AdhesionFollowsFromTheLiquidAsInShi) {
  // 2 pi r gamma cos(theta) of r = 1.1 mm, 0.3 N/m, 20 degrees
  const auto file =
      si_case("diameter = 2.2e-3\nsurface_tension = 0.3\ncontact_angle = 20\n", known);
  EXPECT_NEAR(*file.chute.grains.adhesion * file.units.size(dimension::force), 1.948407e-3, 5e-10);
}

TEST(CaseInput, MaterialAndSpringExcludeEachOther) {
  EXPECT_NE(problem(beads + "stiffness = 1e5\nyoungs_modulus = 7e10\npoisson_ratio = 0.2\n", known)
                .find("youngs_modulus"),
            std::string::npos);
  EXPECT_NE(problem(beads + "youngs_modulus = 7e10\n", known).find("poisson_ratio"),
            std::string::npos);
  EXPECT_NE(problem(beads + "adhesion = 1e-5\nsurface_tension = 0.07\ncontact_angle = 0\n", known)
                .find("surface_tension"),
            std::string::npos);
  EXPECT_NE(
      problem(beads + "surface_tension = 0.07\ncontact_angle = 90\n", known).find("contact_angle"),
      std::string::npos);
}

TEST(CaseInput, TwoOfTiltSizeAndFlowAreGiven) {
  const auto file = si_case(beads, "inclination = 24\nmass_flow = 50\n");
  // rho_p d sqrt(g d) is the internal mass_flow times pi / 6
  EXPECT_NEAR(*file.mass_flow * file.units.size(dimension::mass_flow), 50.0, 1e-12);
  EXPECT_FALSE(file.tilt_sought);
  EXPECT_TRUE(si_case(beads, "depth = 0.05\nmass_flow = 50\n").tilt_sought);
  for (const std::string given : {"inclination = 24\n",
                                  "depth = 0.05\n",
                                  "mass_flow = 50\n",
                                  "inclination = 24\ndepth = 0.05\nmass_flow = 50\n"})
    EXPECT_NE(problem(beads, given).find("exactly two"), std::string::npos) << given;
  EXPECT_NE(problem(beads, "inclination = 24\nmass_flow = 0\n").find("mass_flow"),
            std::string::npos);
}

TEST(CaseInput, LargestFlowTakesOneOfTiltAndSize) {
  const std::string largest = "answer = \"largest_flow\"";
  EXPECT_EQ(si_case(beads, "depth = 0.05\n", largest).question, Question::largest_flow);
  EXPECT_NE(problem(beads, known, largest).find("either the tilt"), std::string::npos);
  EXPECT_NE(problem(beads, "depth = 0.05\nmass_flow = 50\n", largest).find("leave it out"),
            std::string::npos);
}

}  // namespace
}  // namespace grainlaw::io
