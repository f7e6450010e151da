#include "apps/io/profile_csv.h"

#include <gtest/gtest.h>

namespace grainlaw::io {
namespace {

continuum::Profile two_rows() {
  continuum::Profile profile;
  profile.rows = {{.z = 0.0, .velocity = 0.0, .volume_fraction = 0.58},
                  {.z = 10.0, .velocity = 2.0, .volume_fraction = 0.58}};
  profile.height = 10.0;
  profile.surface_velocity = 2.0;
  return profile;
}

continuum::Answer answer(const std::string& text) {
  continuum::Answer answer;
  answer.outcome = continuum::Outcome::steady;
  answer.text = text;
  return answer;
}

const continuum::Answer steady = answer("steady flow");

TEST(ProfileCsv, HeaderNamesTheUnitOfEveryColumn) {
  const std::string text = profile_csv(two_rows(), steady, grain_units());
  EXPECT_NE(text.find("\nz [d],mass_above [m/d^2],velocity [sqrt(g d)],shear_rate [sqrt(g/d)],"
                      "shear_stress [m g/d^2],pressure [m g/d^2],volume_fraction [1],"),
            std::string::npos)
      << text;
  EXPECT_TRUE(text.starts_with("# STEADY: steady flow\n# units grain: m = mass of a grain"));
}

TEST(ProfileCsv, NumbersAreInTheUnitsOfTheFile) {
  // d = 0.01 m and g = 100 m/s2: t = 0.01 s, so the velocity unit is 1 m/s.
  const std::string text = profile_csv(two_rows(), steady, si_units(0.01, 2500.0, 100.0));
  EXPECT_NE(text.find("\n0.1,0,2,0,0,0,0.58,"), std::string::npos) << text;
}

TEST(ProfileCsv, ErrorsNobodyStatedAreAbsentNotZero) {
  continuum::Profile profile = two_rows();
  EXPECT_EQ(profile_csv(profile, steady, grain_units()).find("error"), std::string::npos);
  EXPECT_EQ(profile_json(profile, steady, grain_units()).find("error"), std::string::npos);
  profile.rows[1].velocity_error = 0.1;
  const std::string text = profile_csv(profile, steady, grain_units());
  EXPECT_NE(text.find("velocity_error [sqrt(g d)]\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("volume_fraction_error"), std::string::npos) << text;
}

TEST(ProfileJson, HoldsOutcomeUnitsAndColumns) {
  const std::string text = profile_json(two_rows(), steady, grain_units());
  EXPECT_NE(text.find("\"outcome\": \"STEADY\""), std::string::npos) << text;
  EXPECT_NE(text.find("\"velocity\": \"sqrt(g d)\""), std::string::npos);
}

TEST(ProfileJson, TextThatIsNoUtf8IsReplacedNotThrown) {
  EXPECT_NO_THROW(profile_json(two_rows(), answer("\xff"), grain_units()));
}

}  // namespace
}  // namespace grainlaw::io
