// Which runs a campaign asks for, and that the text of each says so.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "apps/io/campaign_scenes.h"
#include "apps/io/safe_write.h"
#include "dem/steady_state.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw::io {
namespace {

const std::filesystem::path data = GRAINLAW_DATA;

std::vector<PlannedRun> runs_of(const TemporaryDirectory& directory, const std::string& campaign) {
  return planned_runs(read_campaign(directory.write("campaign.toml", campaign)));
}

std::string box(const std::string& name) {
  return "[[shear_boxes]]\nscene = \"" + (data / "scenes" / (name + ".toml")).string() + "\"\n";
}

std::vector<std::string> names(const std::vector<PlannedRun>& runs) {
  std::vector<std::string> all;
  for (const PlannedRun& run : runs) all.push_back(run.file.scene.name);
  return all;
}

using Names = std::vector<std::string>;

/// Numbers of texts have ten digits.
constexpr double rounding = 1e-9;

void expect_state(const dem::Scene& scene, const BoxState& state) {
  const BoxState found = box_state(scene);
  EXPECT_NEAR(found.inertial_number, state.inertial_number, rounding * state.inertial_number);
  EXPECT_NEAR(found.softness, state.softness, rounding * state.softness);
  EXPECT_NEAR(found.bond_number, state.bond_number, rounding * state.bond_number);
}

TEST(CampaignScenes, SeriesAreTheirScenesInTheirOrderAndFitNoLaw) {
  const auto campaign = read_campaign(data / "campaigns/deep_stiffness/campaign.toml");
  const auto runs = planned_runs(campaign);
  EXPECT_EQ(names(runs), (Names{"kn2e3_theta23", "kn2e4_theta23", "kn2e5_theta23"}));
  EXPECT_FALSE(runs[0].fitted);
  EXPECT_EQ(parse_scene(runs[2].file.text, "x.toml").scene.name, "kn2e5_theta23");
}

TEST(CampaignScenes, EveryCombinationOfTheThreeNumbersIsARun) {
  const TemporaryDirectory directory;
  const auto runs = runs_of(directory,
                            box("simple_shear_cohesive") +
                                "inertial_number = [0.1, 0.3]\nsoftness = [0.001, 0.02]\n"
                                "bond_number = [0, 2.5]\n");
  ASSERT_EQ(runs.size(), 8u);
  std::size_t k = 0;
  for (const double p : {0.001, 0.02}) {
    for (const double inertial : {0.1, 0.3}) {
      for (const double bond : {0.0, 2.5}) {
        const PlannedRun& run = runs[k++];
        EXPECT_EQ(run.file.scene.name, run_name(BoxState{inertial, p, bond}));
        EXPECT_TRUE(run.fitted);
        expect_state(run.file.scene, {inertial, p, bond});
        EXPECT_EQ(std::holds_alternative<dem::Cohesionless>(run.file.scene.cohesion), bond == 0.0);
      }
    }
  }
  EXPECT_EQ(runs[5].file.scene.name, "I0.1_p0.02_Bo2.5");
}

TEST(CampaignScenes, TheTextOfARunReadAgainIsItsScene) {
  const TemporaryDirectory directory;
  for (const PlannedRun& run : runs_of(directory,
                                       "seeds = [1, 7]\n" + box("simple_shear_cohesive") +
                                           "inertial_number = [0.05]\nbond_number = [0, 1]\n")) {
    const dem::Scene again = parse_scene(run.file.text, "run.toml").scene;
    EXPECT_EQ(again.name, run.file.scene.name);
    EXPECT_EQ(again.seed, run.file.scene.seed);
    EXPECT_EQ(dem::summarise(again).used, dem::summarise(run.file.scene).used);
  }
}

TEST(CampaignScenes, WithoutListsPressureAndAttractionAreThoseOfTheScene) {
  const TemporaryDirectory directory;
  const auto own = runs_of(directory, box("simple_shear_cohesive") + "inertial_number = [0.1]\n");
  ASSERT_EQ(own.size(), 1u);
  expect_state(own[0].file.scene, {0.1, 0.01, 1.0});
  // The same force at a tenth of the pressure.
  const auto softer = runs_of(
      directory, box("simple_shear_cohesive") + "inertial_number = [0.1]\nsoftness = [0.001]\n");
  expect_state(softer[0].file.scene, {0.1, 0.001, 10.0});
}

TEST(CampaignScenes, StrainSetsTheTimesOfEveryRunByItsRate) {
  const TemporaryDirectory directory;
  for (const PlannedRun& run :
       runs_of(directory, box("simple_shear") + "inertial_number = [0.01, 0.4]\nstrain = 6.0\n")) {
    const dem::Measurement& m = run.file.scene.measurement;
    const double rate = std::get<dem::SimpleShear>(run.file.scene.geometry).shear_rate;
    EXPECT_NEAR(m.averaging_time * rate, 6.0, 6.0 * rounding);
    EXPECT_NEAR(m.time_limit * rate, 12.0, 12.0 * rounding);
    EXPECT_NEAR(m.sample_interval * rate, 0.005, 0.005 * rounding);
    EXPECT_NEAR(m.frame_interval * rate, 0.1, 0.1 * rounding);
  }
}

/// Frames of whole steps that are a little too short or too long, of a flow that does not drift.
std::vector<dem::ProfileFrame> steady_frames(const dem::Measurement& m, double length, int seed) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  std::normal_distribution<double> noise;
  std::vector<dem::ProfileFrame> frames;
  for (double begin = 0.0; begin < m.time_limit; begin += length * m.frame_interval) {
    frames.push_back({.begin = begin,
                      .end = begin + length * m.frame_interval,
                      .samples = 20,
                      .centre_of_mass = noise(random),
                      .kinetic_energy = noise(random),
                      .bins = {{}},
                      .sliding = {}});
  }
  return frames;
}

TEST(CampaignScenes, TimeLimitLeavesRoomForTheWantedStrain) {
  const TemporaryDirectory directory;
  for (const char* strain : {"0.4", "1.0", "3.0", "12.0"}) {
    const std::string keys = "inertial_number = [0.1]\nstrain = " + std::string(strain) + "\n";
    const dem::Scene scene = runs_of(directory, box("simple_shear") + keys)[0].file.scene;
    const dem::Measurement& m = scene.measurement;
    const dem::SteadyCriteria criteria{
        .averaging_time = m.averaging_time,
        .start_up = 1.0 / std::get<dem::SimpleShear>(scene.geometry).shear_rate,
        .mean_flow = false};
    for (int seed = 0; seed < 20; ++seed) {
      for (const double length : {0.99, 1.0, 1.01}) {
        const auto state = dem::assess(steady_frames(m, length, seed), criteria).state;
        EXPECT_NE(state, dem::FlowState::too_short) << "strain " << strain << ", seed " << seed;
      }
    }
  }
}

TEST(CampaignScenes, EveryLawOfCohesionTakesItsBondNumber) {
  const TemporaryDirectory directory;
  const std::string scene = read_file(data / "scenes/simple_shear_cohesive.toml");
  const std::size_t begin = scene.find("[contact.cohesion]");
  const std::size_t end = scene.find("[contact.friction]");
  for (const char* law : {"law = \"gaussian_well\"\nstrength = 1e-4\n",
                          "law = \"liquid_bridge\"\nsurface_tension = 1e-3\nvolume = 1e-4\n"}) {
    directory.write("box.toml",
                    scene.substr(0, begin) + "[contact.cohesion]\n" + law + scene.substr(end));
    const auto runs = runs_of(
        directory,
        "[[shear_boxes]]\nscene = \"box.toml\"\ninertial_number = [0.1]\nbond_number = [0.5]\n");
    expect_state(runs[0].file.scene, {0.1, 0.01, 0.5});
  }
}

TEST(CampaignScenes, SeedsMakeARunEachOfTheSameCondition) {
  const TemporaryDirectory directory;
  const auto runs =
      runs_of(directory, "seeds = [3, 11]\n" + box("simple_shear") + "inertial_number = [0.1]\n");
  EXPECT_EQ(names(runs), (Names{"I0.1_p0.01_Bo0_s3", "I0.1_p0.01_Bo0_s11"}));
  EXPECT_EQ(runs[0].condition, runs[1].condition);
  EXPECT_EQ(runs[0].file.scene.seed, 3u);
  EXPECT_EQ(runs[1].file.scene.seed, 11u);
}

TEST(CampaignScenes, BoxesThatWouldShareANameAreToldApartByTheirScenes) {
  const TemporaryDirectory directory;
  const auto runs =
      runs_of(directory,
              box("simple_shear") + "inertial_number = [0.1]\n" + box("simple_shear_cohesive") +
                  "inertial_number = [0.1]\nbond_number = [0]\n");
  EXPECT_EQ(names(runs),
            (Names{"simple_shear_I0.1_p0.01_Bo0", "simple_shear_cohesive_I0.1_p0.01_Bo0"}));
}

TEST(CampaignScenes, ChutesBesideBoxesAreOnlyPredicted) {
  const TemporaryDirectory directory;
  const auto runs =
      runs_of(directory,
              "scene = \"" + (data / "scenes/chute.toml").string() + "\"\n" + box("simple_shear") +
                  "inertial_number = [0.1]\n[tilts]\npredict = [23.0]\n");
  EXPECT_EQ(names(runs), (Names{"I0.1_p0.01_Bo0", "theta23"}));
  EXPECT_TRUE(runs[0].fitted);
  EXPECT_FALSE(runs[1].fitted);
}

TEST(CampaignScenes, TiltsToCalibrateMayHaveASceneOfTheirOwn) {
  const TemporaryDirectory directory;
  const auto runs =
      runs_of(directory,
              "scene = \"" + (data / "campaigns/deep_chute/scene.toml").string() + "\"\n" +
                  "calibrate_scene = \"" + (data / "scenes/chute.toml").string() + "\"\n" +
                  "[tilts]\ncalibrate = [22, 25]\npredict = [24]\n");
  const auto grains = [](const std::string& scene) {
    return dem::grains(read_scene(data / scene).scene);
  };
  EXPECT_EQ(names(runs), (Names{"theta22", "theta25", "theta24"}));
  EXPECT_EQ(dem::grains(runs[0].file.scene), grains("scenes/chute.toml"));
  EXPECT_EQ(dem::grains(runs[2].file.scene), grains("campaigns/deep_chute/scene.toml"));
  EXPECT_TRUE(runs[1].fitted);
  EXPECT_FALSE(runs[2].fitted);
}

TEST(CampaignScenes, StartFilesAreNamedFromTheRootWithTheirContent) {
  const TemporaryDirectory directory;
  const std::string keys =
      "scene = \"chute.toml\"\n[tilts]\ncalibrate = [23, 25]\npredict = [24]\n";
  directory.write("chute.toml",
                  read_file(data / "scenes/chute.toml") + "\n[start]\nprofile = \"p.csv\"\n");
  const auto path = directory.write("p.csv", "z [d],velocity [sqrt(g d)]\n0,0\n2,1\n");
  const auto first = runs_of(directory, keys);
  EXPECT_NE(first[0].file.text.find("profile = \"" + path.string() + "\"  # checksum "),
            std::string::npos)
      << first[0].file.text;
  EXPECT_EQ(first[0].file.scene.start_profile.size(), 2u);
  directory.write("p.csv", "z [d],velocity [sqrt(g d)]\n0,0\n2,3\n");
  EXPECT_NE(runs_of(directory, keys)[0].file.text, first[0].file.text);
}

TEST(CampaignScenes, ASceneWhoseTextCannotSayItsRunsIsRefused) {
  const TemporaryDirectory directory;
  directory.write("chute.toml",
                  "units = \"grain\"\n"
                  "geometry = { kind = \"chute\", inclination = 23.0, grains = 300 }\n"
                  "contact.normal = { law = \"hooke\", stiffness = 2e5, restitution = 0.88 }\n");
  try {
    runs_of(directory, "scene = \"chute.toml\"\n[tilts]\ncalibrate = [23, 25]\npredict = [24]\n");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("with a header of its own"), std::string::npos)
        << error.what();
  }
}

TEST(CampaignScenes, TheShippedCampaignsOfShearSpanTheirPlane) {
  for (const char* name : {"shear_mu_p_0.50", "shear_mu_p_0.01"}) {
    const auto runs = planned_runs(read_campaign(data / "campaigns" / name / "campaign.toml"));
    EXPECT_EQ(runs.size(), 37u);
    std::set<double> bonds;
    for (const PlannedRun& run : runs) bonds.insert(box_state(run.file.scene).bond_number);
    EXPECT_GE(bonds.size(), 7u);
  }
}

}  // namespace
}  // namespace grainlaw::io
