#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "apps/io/case_input.h"
#include "apps/io/input_file.h"

namespace grainlaw::io {
namespace {

using namespace continuum;

CaseFile parsed(const std::string& text) {
  return parse_case(text, "case.toml");
}

CaseFile shipped(const std::string& name) {
  return read_case(std::filesystem::path(GRAINLAW_DATA) / "cases" / (name + ".toml"));
}

std::string message_of(const std::string& text) {
  try {
    parsed(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(FlowInput, ReadsTheShippedCases) {
  const auto plane = std::get<PlaneShear>(shipped("plane_shear").band->flow);
  EXPECT_EQ(plane.load, 20.0);
  EXPECT_EQ(plane.gravity, 1.0);
  EXPECT_EQ(*shipped("plane_shear").band->nonlocal_amplitude, 0.48);
  const CaseFile box = shipped("body_force_box");
  EXPECT_EQ(std::get<BodyForceBox>(box.band->flow).amplitude, 2.0);
  EXPECT_EQ(*box.band->grains.stiffness, 2e4);
  EXPECT_FALSE(box.band->nonlocal_amplitude);
  EXPECT_EQ(shipped("simple_shear").simple_shear->bond_numbers.size(), 13u);
  EXPECT_TRUE(shipped("chute").is_chute());
}

/// SI is turned into m, d and sqrt(d/g): 0.1 m is 50 diameters of 2 mm.
TEST(FlowInput, ConvertsSiOnce) {
  const auto annulus = std::get<AnnularShear>(shipped("annular_shear").band->flow);
  EXPECT_NEAR(annulus.inner_radius, 50.0, 1e-12);
  EXPECT_NEAR(*annulus.drive.velocity, 0.01 / std::sqrt(9.81 * 2e-3), 1e-12);
  const CaseFile ring = shipped("split_bottom");
  EXPECT_NEAR(ring.split_bottom->split_radius, 0.085 / 2.2e-3, 1e-10);
  EXPECT_NEAR(ring.split_bottom->rotation_rate, 0.063 * std::sqrt(2.2e-3 / 9.81), 1e-12);
}

const std::string plane =
    "units = \"grain\"\n[geometry]\nkind = \"plane_shear\"\nheight = 20\nload = 5\n";

TEST(FlowInput, AWallIsDrivenByItsSpeedOrItsStress) {
  EXPECT_EQ(message_of(plane + "stress = 2.0\n"), "no error");
  EXPECT_NE(message_of(plane).find("velocity"), std::string::npos);
  EXPECT_NE(message_of(plane + "stress = 2.0\nvelocity = 1.0\n").find("stress"), std::string::npos);
}

TEST(FlowInput, AKeyOfAnotherFlowIsUnknown) {
  const std::string message = message_of(plane + "stress = 2.0\nouter_radius = 8.0\n");
  EXPECT_NE(message.find("outer_radius"), std::string::npos) << message;
}

TEST(FlowInput, OnlyAChuteHasAStart) {
  const std::string message = message_of("answer = \"start\"\n" + plane + "stress = 2.0\n");
  EXPECT_NE(message.find("[chute]"), std::string::npos) << message;
}

TEST(FlowInput, AFileHasOneFlow) {
  const std::string message =
      message_of(plane + "stress = 2.0\n[chute]\ninclination = 24\ndepth = 20\n");
  EXPECT_NE(message.find("chute"), std::string::npos) << message;
}

TEST(FlowInput, NonlocalityBelongsToBands) {
  const std::string ring =
      "units = \"grain\"\n[geometry]\nkind = \"split_bottom\"\nsplit_radius = 40\ndepth = 10\n"
      "rotation_rate = 0.01\n";
  EXPECT_EQ(message_of(ring), "no error");
  EXPECT_NE(message_of(ring + "[nonlocal]\namplitude = 0.48\n").find("nonlocal"),
            std::string::npos);
}

}  // namespace
}  // namespace grainlaw::io
