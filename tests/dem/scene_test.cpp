#include "dem/scene.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

std::string refusal(const std::function<void(Scene&)>& spoil) {
  Scene scene = small_chute(23.0);
  spoil(scene);
  try {
    validate(scene);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

TEST(Scene, GoodOneIsAccepted) {
  EXPECT_NO_THROW(validate(small_chute(23.0)));
}

TEST(Scene, EveryBadNumberIsRefusedByName) {
  const std::vector<std::pair<std::string, std::function<void(Scene&)>>> bad{
      {"inclination = -5 degrees: must lie in [0, 90); a negative tilt flows in -x",
       [](Scene& s) { s.geometry.inclination = radians(-5.0); }},
      {"inclination = 90", [](Scene& s) { s.geometry.inclination = radians(90.0); }},
      {"grains = 0", [](Scene& s) { s.geometry.grains = 0; }},
      {"length = 2.9", [](Scene& s) { s.geometry.length = 2.9; }},
      {"width = nan", [](Scene& s) { s.geometry.width = NAN; }},
      {"normal stiffness = -1", [](Scene& s) { s.normal = Hooke{.stiffness = -1.0}; }},
      {"normal damping = 300",
       [](Scene& s) {
         s.normal = Hooke{2e4, 300.0};
       }},
      {"friction coefficient = -0.5",
       [](Scene& s) {
         s.friction = Sliding{-0.5, 1e4, 0.0};
       }},
      {"friction coefficient = 0",
       [](Scene& s) {
         s.friction = Sliding{0.0, 1e4, 0.0};
       }},
      {"tangential stiffness = 0",
       [](Scene& s) {
         s.friction = Sliding{0.5, 0.0, 0.0};
       }},
      {"frame_interval = 0.05", [](Scene& s) { s.measurement.frame_interval = 0.05; }},
      {"averaging_time = 3", [](Scene& s) { s.measurement.averaging_time = 3.0; }},
      {"time_limit = 100", [](Scene& s) { s.measurement.time_limit = 100.0; }},
      {"bin_width = 0", [](Scene& s) { s.measurement.bin_width = 0.0; }},
      {"bin_width = 1.1: at most 1.053", [](Scene& s) { s.measurement.bin_width = 1.1; }},
      {"time step = 1e-10: 1e+13 steps", [](Scene& s) { s.time_step = 1e-10; }},
      {"grains = 1000001", [](Scene& s) { s.geometry.grains = 1'000'001; }},
      {"length x width = 10000 x 100: 55 flowing grains and 3910437 to cut the base from",
       [](Scene& s) {
         s.geometry.length = 1e4;
         s.geometry.width = 100.0;
       }},
      {"max_overlap = 1.5", [](Scene& s) { s.max_overlap = 1.5; }},
      {"grain mass = inf",
       [](Scene& s) { s.grains.mass = std::numeric_limits<double>::infinity(); }},
      {"base thickness = 0.5", [](Scene& s) { s.geometry.base.thickness = 0.5; }},
      {"time_step = nan", [](Scene& s) { s.time_step = NAN; }},
  };
  for (const auto& [message, spoil] : bad) {
    EXPECT_EQ(refusal(spoil).substr(0, message.size()), message);
  }
}

TEST(Scene, RefusalsNameSectionAndKeyOfTheSceneFile) {
  Scene scene = small_chute(23.0);
  scene.geometry.base.thickness = 0.5;
  try {
    validate(scene);
    FAIL() << "accepted";
  } catch (const SceneError& error) {
    EXPECT_EQ(error.section, "geometry.base");
    EXPECT_EQ(error.key, "thickness");
  }
}

TEST(Scene, BinsOfALayerThreeOfThemDeepAreAccepted) {
  Scene scene = small_chute(23.0);
  scene.measurement.bin_width = nominal_depth(scene) / 3.0;
  EXPECT_NO_THROW(validate(scene));
}

TEST(Scene, ContactTimesOfNormalAndTangentialSpringAreEqualAtTwoSevenths) {
  Scene scene = small_chute(23.0);
  const double both = shortest_contact_time(scene);
  EXPECT_NEAR(both, std::numbers::pi / std::sqrt(2.0 * soft.stiffness), 1e-15);
  scene.friction = Frictionless{};
  EXPECT_NEAR(shortest_contact_time(scene), both, 1e-15);
  scene.friction = Sliding{.coefficient = 0.5, .stiffness = soft.stiffness, .damping = 0.0};
  EXPECT_NEAR(shortest_contact_time(scene), both * std::sqrt(2.0 / 7.0), 1e-15);
  EXPECT_DOUBLE_EQ(time_step(scene), shortest_contact_time(scene) / 50.0);
}

TEST(Scene, UnstableStepIsRefusedWithBoundAndDefaultUnlessAllowed) {
  Scene scene = small_chute(23.0);
  scene.normal = stiff;
  scene.friction = Frictionless{};
  scene.time_step = 1e-3;
  try {
    validate(scene);
    FAIL() << "accepted";
  } catch (const StepRefused& error) {
    EXPECT_STREQ(error.what(),
                 "time_step = 0.001 exceeds 1/15 of the shortest contact time (0.00497 for "
                 "stiffness = 200000): at most 0.000331; the default would be 9.93e-05");
  }
  scene.allow_unstable_step = true;
  EXPECT_NO_THROW(validate(scene));
  scene.allow_unstable_step = false;
  scene.time_step = shortest_contact_time(scene) / 15.01;
  EXPECT_NO_THROW(validate(scene));
}

TEST(Scene, SummaryNamesWhatIsLeftOut) {
  Scene scene = small_chute(23.0);
  scene.friction = Frictionless{};
  const SceneSummary summary = summarise(scene);
  const auto has = [](const std::vector<std::string>& lines, std::string_view text) {
    return std::ranges::any_of(lines, [&](auto& l) { return l.find(text) != std::string::npos; });
  };
  EXPECT_TRUE(has(summary.left_out, "no cohesion: no force beyond contact"));
  EXPECT_TRUE(has(summary.left_out, "no rotation, no history"));
  EXPECT_FALSE(has(summary.used, "friction"));
  EXPECT_TRUE(has(summarise(small_chute(23.0)).used, "friction: coefficient 0.5"));
}

}  // namespace
}  // namespace grainlaw::dem
