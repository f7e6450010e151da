#include "apps/io/scene_input.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "apps/io/campaign_input.h"
#include "apps/io/campaign_scenes.h"
#include "apps/io/case_input.h"

namespace grainlaw::io {
namespace {

const std::filesystem::path data = GRAINLAW_DATA;

constexpr double bits = 4.0 * 2.220446049250313e-16;  // a handful of roundings

std::string scene_text(const std::string& damping = "restitution = 0.88",
                       const std::string& more = "") {
  return "units = \"grain\"\n[contact.normal]\nlaw = \"hooke\"\nstiffness = 2e5\n" + damping +
         "\n[geometry]\nkind = \"chute\"\ninclination = 23.0\ngrains = 300\n" + more;
}

dem::Scene scene_of(const std::string& text) {
  return parse_scene(text, "scene.toml").scene;
}

const dem::Chute& chute_of(const dem::Scene& scene) {
  return std::get<dem::Chute>(scene.geometry);
}

const dem::Hooke& normal_of(const dem::Scene& scene) {
  return std::get<dem::Hooke>(scene.normal);
}

TEST(SceneInput, ChuteExampleIsReadKeyByKey) {
  const SceneFile file = read_scene(data / "scenes/chute.toml");
  EXPECT_EQ(file.scene.name, "chute");
  EXPECT_EQ(file.units.name, "grain");
  EXPECT_EQ(normal_of(file.scene).stiffness, 2e4);
  EXPECT_EQ(std::get<dem::Sliding>(file.scene.friction).coefficient, 0.5);
  EXPECT_EQ(std::get<dem::Sliding>(file.scene.friction).stiffness, 2.0 / 7.0 * 2e4);
  EXPECT_EQ(chute_of(file.scene).inclination, 23.0 * std::numbers::pi / 180.0);
  EXPECT_EQ(chute_of(file.scene).grains, 836);  // 12 x 8 x 8 x 0.57 x 6/pi = 836.07
  EXPECT_EQ(file.scene.measurement.averaging_time, 200.0);
}

TEST(SceneInput, RestitutionGivesTheDampingRateOfBrewster) {
  // Brewster et al. (2008), eqs. 7 and 8 inverted: 51.4275 for 0.88 at k_n = 2e5.
  const dem::Hooke law = normal_of(scene_of(scene_text()));
  const double reduced_mass = 0.5;
  EXPECT_NEAR(dem::viscosity(law, reduced_mass) / reduced_mass, 51.4275, 5e-5);
}

TEST(SceneInput, RestitutionIsThatOfLightAndHeavyPairs) {
  const dem::Hooke law = normal_of(scene_of(scene_text()));
  for (const double reduced_mass : {1e-3, 0.5, 500.0}) {
    EXPECT_NEAR(law.restitution(reduced_mass), 0.88, 10.0 * bits);
  }
}

TEST(SceneInput, RestitutionOneIsWithoutDamping) {
  EXPECT_EQ(dem::viscosity(normal_of(scene_of(scene_text("restitution = 1.0"))), 0.5), 0.0);
}

TEST(SceneInput, DashpotActsOnTheVelocityAndRateOnTheReducedMass) {
  EXPECT_EQ(normal_of(scene_of(scene_text("damping_rate = 50.0"))).damping, 50.0);
  const dem::Hooke law = normal_of(scene_of(scene_text("dashpot = 25.0")));
  for (const double reduced_mass : {0.01, 0.5, 3.0}) {
    EXPECT_EQ(dem::viscosity(law, reduced_mass), 25.0);
  }
}

TEST(SceneInput, AMissingSectionIsAMissingMechanism) {
  EXPECT_TRUE(std::holds_alternative<dem::Frictionless>(scene_of(scene_text()).friction));
}

TEST(SceneInput, ContactsAreFollowedOnlyWhereTheSceneAsksForIt) {
  EXPECT_FALSE(scene_of(scene_text()).lifetimes.has_value());
  const std::string section = "[lifetimes]\n";
  const auto plain = scene_of(scene_text("restitution = 0.88", section)).lifetimes;
  ASSERT_TRUE(plain.has_value());
  EXPECT_EQ(plain->contact_distances, (std::vector<double>{1.0, 1.001, 1.01, 1.02}));
  EXPECT_FALSE(plain->slice_centre.has_value());
  const auto read = [&](const std::string& keys) {
    return scene_of(scene_text("restitution = 0.88", section + keys)).lifetimes;
  };
  EXPECT_EQ(read("contact_distances = [1.003]")->contact_distances, std::vector<double>{1.003});
  EXPECT_EQ(read("slice_centre = 2.5\nslice_half_width = 0.5")->slice_half_width, 0.5);
  EXPECT_THROW(read("contact_distances = [1.2]"), InputError);
  EXPECT_THROW(read("effective_distance = true"), InputError);  // there is no well
}

TEST(SceneInput, TheSameSceneInSiIsTheSameScene) {
  // 1 mm grains of 2500 kg/m3: m = 1.309e-6 kg, sqrt(d/g) = 1.0096e-2 s, m g/d = 1.2842e-2 N/m.
  const double d = 1e-3;
  const double m = 2500.0 * std::numbers::pi / 6.0 * d * d * d;
  const double time = std::sqrt(d / 9.81);
  char text[600];
  std::snprintf(text,
                sizeof text,
                "units = \"si\"\n[grains]\ndiameter = 1e-3\ndensity = 2500.0\n"
                "[contact.normal]\nlaw = \"hooke\"\nstiffness = %.17g\nrestitution = 0.88\n"
                "[geometry]\nkind = \"chute\"\ninclination = 23.0\ngrains = 300\n"
                "gravity = 9.81\nlength = 8e-3\nwidth = 8e-3\n[time]\nstep = %.17g\n",
                2e5 * m / (time * time),
                1e-4 * time);
  const SceneFile si = parse_scene(text, "si.toml");
  const dem::Scene grain = scene_of(scene_text("restitution = 0.88", "[time]\nstep = 1e-4\n"));
  EXPECT_NEAR(normal_of(si.scene).stiffness, 2e5, 2e5 * bits);
  EXPECT_NEAR(normal_of(si.scene).damping, normal_of(grain).damping, 52.0 * bits);
  EXPECT_NEAR(si.scene.time_step, 1e-4, 1e-4 * bits);
  EXPECT_NEAR(chute_of(si.scene).length, 8.0, 8.0 * bits);
  EXPECT_EQ(chute_of(si.scene).gravity, 1.0);
  EXPECT_EQ(si.scene.grains.mass, 1.0);
}

TEST(SceneInput, StiffnessUnitsHaveContactStiffnessOne) {
  const SceneFile file = parse_scene(
      "units = \"stiffness\"\n[contact.normal]\nlaw = \"hooke\"\nrestitution = 0.88\n"
      "[geometry]\nkind = \"chute\"\ninclination = 23.0\ngrains = 300\ngravity = 1e-5\n",
      "s.toml");
  // k_n d/(m g) with k_n = d = rho_p = 1, m = pi/6, g = 1e-5.
  const double stiffness = 6.0 / std::numbers::pi / 1e-5;
  EXPECT_NEAR(normal_of(file.scene).stiffness, stiffness, stiffness * bits);
}

TEST(SceneInput, AnUnstableStepIsRefusedAndNotAnInputError) {
  const std::string text = scene_text("restitution = 0.88", "[time]\nstep = 1e-2\n");
  try {
    parse_scene(text, "scene.toml");
    FAIL();
  } catch (const dem::StepRefused& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("scene.toml:11:1: error: ")) << error.what();
  }
  EXPECT_NO_THROW(parse_scene(text, "scene.toml", {.allow_unstable_step = true}));
}

TEST(SceneInput, MisspeltKeyNamesTheNearestOneAndPointsAtIt) {
  try {
    parse_scene(
        "units = \"grain\"\n[contact.normal]\nlaw = \"hooke\"\n  stifness = 2e5\n"
        "restitution = 0.88\n[geometry]\nkind = \"chute\"\ninclination = 23.0\ngrains = 9\n",
        "chute.toml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "chute.toml:4:3: error: unknown key 'stifness' in [contact.normal]; did you mean "
        "'stiffness'?\n"
        "    4 |   stifness = 2e5\n"
        "      |   ^^^^^^^^  known here: law, stiffness, damping_rate, dashpot, restitution, "
        "clip_attraction");
  }
}

TEST(SceneInput, AllProblemsAreReportedAtOnce) {
  try {
    scene_of("units = \"grain\"\n[geometry]\nkind = \"box\"\ninclination = 91.0\ngrians = 9\n");
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    for (const char* part : {"[contact.normal]", "unknown kind", "inclination = 91", "'grians'"}) {
      EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
    }
  }
}

TEST(SceneInput, KeyListNamesEveryKeyWithUnitRangeAndDefault) {
  const std::string keys = scene_keys();
  for (const char* line :
       {"| `stiffness` | number | mass/time^2 | 0 < x | required, unless",
        "| `restitution` | number |  | 0 < x <= 1 | exactly one of damping_rate, dashpot, "
        "restitution |",
        "| `inclination` | number | degrees | 0 <= x < 90 | required |",
        "| `length` | number | length | 3 d <= x | 8 d |",
        "| `thickness` | number | grain diameter | 1 <= x <= 10 | 1.5 |",
        "| `packing_fraction` | number |  | 0.4 <= x <= 0.6 | 0.585 |",
        "| `max_overlap` | number | grain radius | 0 < x < 1 | 0.3 |",
        "| `averaging_time` | number | time | 0 < x | 200 T |",
        "| `seed` | integer |  | 0 <= x | 1 |",
        "### `[contact.friction]`"}) {
    EXPECT_NE(keys.find(line), std::string::npos) << line << " in\n" << keys;
  }
  EXPECT_NE(campaign_keys().find("| `calibrate` | list of numbers | degrees |"), std::string::npos);
  EXPECT_NE(case_keys().find("| `depth` | number | length |"), std::string::npos);
}

TEST(SceneInput, AStartProfileHasTheUnitsOfTheScene) {
  const std::string start = "[start]\nprofile = \"invalid/profile_good.csv\"\n";
  const dem::Scene scene =
      parse_scene(scene_text("restitution = 0.88", start), data / "scene.toml").scene;
  ASSERT_EQ(scene.start_profile.size(), 2u);
  EXPECT_EQ(scene.start_profile[1].z, 2.0);
  EXPECT_EQ(scene.start_profile[1].velocity, 0.2);
  EXPECT_TRUE(scene.start.empty());
}

TEST(CampaignInput, QuickstartHasThreeTiltsToFitAndTwoToPredict) {
  const Campaign campaign = read_campaign(data / "campaigns/quickstart/campaign.toml");
  ASSERT_EQ(campaign.calibrate_tilts.size(), 3u);
  ASSERT_EQ(campaign.predict_tilts.size(), 2u);
  EXPECT_EQ(campaign.calibrate_tilts[1], radians(24.2));
  const SceneFile run = scene_at(campaign, campaign.predict_tilts[0]);
  EXPECT_EQ(run.scene.name, "theta24.8");
  EXPECT_EQ(chute_of(run.scene).inclination, radians(24.8));
  EXPECT_EQ(chute_of(run.scene).grains, 836);
}

void expect_same_run(const std::string& text, const dem::Scene& scene) {
  const dem::Scene again = scene_of(text);
  EXPECT_EQ(again.name, scene.name) << text;
  EXPECT_EQ(chute_of(again).inclination, chute_of(scene).inclination) << text;
  EXPECT_EQ(again.allow_unstable_step, scene.allow_unstable_step) << text;
  EXPECT_EQ(dem::summarise(again).used, dem::summarise(scene).used) << text;
}

TEST(CampaignInput, TheTextOfEveryRunReadAgainIsTheSceneOfTheRun) {
  const Campaign campaign = read_campaign(data / "campaigns/quickstart/campaign.toml");
  for (const auto& tilts : {campaign.calibrate_tilts, campaign.predict_tilts}) {
    for (const double tilt : tilts) {
      const SceneFile run = scene_at(campaign, tilt);
      EXPECT_EQ(chute_of(run.scene).inclination, tilt);
      expect_same_run(run.text, run.scene);
      EXPECT_NE(run.text.find("# degrees; the campaign overrides it"), std::string::npos);
    }
  }
}

TEST(CampaignInput, ANameTheSceneDoesNotStateIsAddedAndAQuotedOneReplaced) {
  Campaign campaign;
  for (const char* top : {"", "name = \"a # b\"  # old\n", "[grains]  # none\n"}) {
    campaign.scene =
        parse_scene(top == std::string("[grains]  # none\n") ? scene_text("restitution = 0.88", top)
                                                             : top + scene_text(),
                    "scene.toml");
    const SceneFile run = scene_at(campaign, radians(24.8));
    expect_same_run(run.text, run.scene);
  }
}

TEST(CampaignInput, WhereLinesCannotBeReplacedCommentsStateTheTilt) {
  Campaign campaign;
  campaign.scene = parse_scene(
      "units = \"grain\"\n"
      "geometry = { kind = \"chute\", inclination = 23.0, grains = 300 }\n"
      "contact.normal = { law = \"hooke\", stiffness = 2e5, restitution = 0.88 }\n",
      "scene.toml");
  const SceneFile run = scene_at(campaign, radians(24.8));
  EXPECT_TRUE(
      run.text.starts_with("# The run differs from the text below in:\n"
                           "#   name = \"theta24.8\"\n"
                           "#   [geometry] inclination = 24.8\n"))
      << run.text;
  EXPECT_NO_THROW(parse_scene(run.text, "scene.toml"));
}

TEST(SceneInput, AnAllowedStepIsInTheTextThatIsStored) {
  const std::string unstable = scene_text("restitution = 0.88", "[time]\nstep = 1e-2\n");
  for (const std::string& text :
       {unstable, unstable + "allow_unstable_step = false # no\n", "\xef\xbb\xbf" + unstable}) {
    const SceneFile file = parse_scene(text, "scene.toml", {.allow_unstable_step = true});
    expect_same_run(file.text, file.scene);
  }
  const SceneFile stable = parse_scene(scene_text(), "scene.toml", {.allow_unstable_step = true});
  expect_same_run(stable.text, stable.scene);
  EXPECT_EQ(parse_scene(scene_text(), "scene.toml").text, scene_text());
}

TEST(SceneInput, AContradictionPointsAtItsKeyAndTellsTheUnitsOfItsNumbers) {
  const std::string si =
      "units = \"si\"\n[grains]\ndiameter = 1e-3\ndensity = 2500.0\n"
      "[contact.normal]\nlaw = \"hooke\"\nstiffness = 200\nrestitution = 0.88\n"
      "[geometry]\nkind = \"chute\"\ninclination = 23.0\ngrains = 300\n"
      "gravity = 9.81\n[measurement]\n  bin_width = 2e-3\n";
  try {
    scene_of(si);
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with("scene.toml:15:3: error: bin_width = 2: at most 1.435")) << text;
    EXPECT_NE(text.find("in the set \"grain\""), std::string::npos) << text;
  }
}

TEST(SceneInput, APeriodOfThreeDiametersIsMeasuredInTheUnitsOfTheFile) {
  EXPECT_THROW(scene_of(scene_text("restitution = 0.88", "length = 2.9\n")), InputError);
  EXPECT_NO_THROW(scene_of(scene_text("restitution = 0.88", "length = 3.0\n")));
  const Bounds period = diameters_or_more(3.0);
  InputFile in = InputFile::from_text("a = 0.006\nb = 0.005\n", "f");
  EXPECT_EQ(in.top().read<double>({"a", "", {"length", 0.002}, period}), 3.0);
  in.top().read<double>({"b", "", {"length", 0.002}, period});
  try {
    in.finish();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("b = 0.005 is out of range: 3 d <= b [length]"),
              std::string::npos)
        << error.what();
  }
}

TEST(CaseInput, GrainCaseIsReadInInternalUnits) {
  const CaseFile file = read_case(data / "cases/chute.toml");
  EXPECT_EQ(file.question, Question::steady);
  EXPECT_EQ(file.chute.mass_per_area, 30.0);
  EXPECT_EQ(file.chute.gravity, 1.0);
  EXPECT_EQ(file.chute.grains.density, 6.0 / std::numbers::pi);
  EXPECT_EQ(file.chute.grains.stiffness, 2e4);
  EXPECT_FALSE(file.chute.grains.adhesion);
  EXPECT_FALSE(file.depth);
}

TEST(CaseInput, SiCaseKeepsItsDimensionlessNumbers) {
  const CaseFile file = read_case(data / "cases/glass_beads_si.toml");
  const double d = 2e-3;
  EXPECT_EQ(file.question, Question::start);
  // M0/(rho_p d), the depth of solid in diameters, is the same in both sets.
  const double solid = 72.5 / (2500.0 * d);
  EXPECT_NEAR(file.chute.mass_per_area / file.chute.grains.density, solid, solid * 2.0 * bits);
  // 1 s is sqrt(g/d) of the internal unit of time.
  ASSERT_EQ(file.transient.output_times.size(), 3u);
  EXPECT_NEAR(file.transient.output_times[1], std::sqrt(9.81 / d), 70.0 * bits);
  EXPECT_FALSE(file.chute.grains.stiffness);
}

TEST(CaseInput, ADepthIsKeptForWhoKnowsTheDensityOfTheFlow) {
  const CaseFile file =
      parse_case("units = \"grain\"\n[chute]\ninclination = 24\ndepth = 20\n", "c");
  EXPECT_EQ(file.depth, 20.0);
  EXPECT_EQ(file.chute.mass_per_area, 0.0);
  EXPECT_EQ(file.question, Question::flow);
}

}  // namespace
}  // namespace grainlaw::io
