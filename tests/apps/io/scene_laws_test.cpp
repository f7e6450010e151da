// Laws and geometries as scene files state them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "apps/io/scene_input.h"

namespace grainlaw::io {
namespace {

const std::filesystem::path data = GRAINLAW_DATA;

constexpr double bits = 4.0 * 2.220446049250313e-16;  // a handful of roundings

dem::Scene scene_of(const std::string& text) {
  return parse_scene(text, "scene.toml").scene;
}
std::string scene_text(const std::string& more = "") {
  return "units = \"grain\"\n[contact.normal]\nlaw = \"hooke\"\nstiffness = 2e5\n"
         "restitution = 0.88\n[geometry]\nkind = \"chute\"\ninclination = 23.0\ngrains = 300\n" +
         more;
}

const dem::Chute& chute_of(const dem::Scene& scene) {
  return std::get<dem::Chute>(scene.geometry);
}
const dem::Hooke& normal_of(const dem::Scene& scene) {
  return std::get<dem::Hooke>(scene.normal);
}

/// A scene without [geometry], and the simple shear that most tests of laws go with.
std::string head(const std::string& normal = "law = \"hooke\"\nrestitution = 0.88") {
  return "units = \"grain\"\n[contact.normal]\nstiffness = 2e4\n" + normal + "\n";
}
std::string sheared(const std::string& more = "grains = 200\n") {
  return "[geometry]\nkind = \"simple_shear\"\nshear_rate = 0.1\npressure = 10.0\n" + more;
}

TEST(SceneInput, EveryExampleIsAGoodSceneOfItsGeometry) {
  const std::vector<std::pair<std::string, std::string>> examples{
      {"chute", "chute"},
      {"chute_cohesive", "chute"},
      {"chute_arrest", "chute"},
      {"chute_hertz", "chute"},
      {"chute_tilt_step", "chute"},
      {"simple_shear", "simple_shear"},
      {"simple_shear_cohesive", "simple_shear"},
      {"plane_shear", "plane_shear"},
      {"body_force_box", "body_force_box"},
      {"split_bottom", "split_bottom"}};
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data / "scenes")) {
    files += entry.path().extension() == ".toml" ? 1 : 0;
  }
  EXPECT_EQ(files, examples.size());
  for (const auto& [name, kind] : examples) {
    const SceneFile file = read_scene(data / "scenes" / (name + ".toml"));
    EXPECT_EQ(file.scene.name, name);
    EXPECT_EQ(dem::kind(file.scene.geometry), kind);
  }
}

TEST(SceneInput, ShearExampleHasTheNumbersOfShiEtAl) {
  const SceneFile file = read_scene(data / "scenes/simple_shear_cohesive.toml");
  const dem::Scene& scene = file.scene;
  const auto& shear = std::get<dem::SimpleShear>(scene.geometry);
  const double inertial_number =
      shear.shear_rate / std::sqrt(*shear.pressure / scene.grains.density());
  EXPECT_NEAR(inertial_number, 0.02, 0.02 * bits);
  EXPECT_NEAR(*shear.pressure / normal_of(scene).stiffness, 0.01, 0.01 * bits);
  const auto& adhesion = std::get<dem::ReversibleAdhesion>(scene.cohesion);
  EXPECT_NEAR(adhesion.largest_force / *shear.pressure, 1.0, bits);
  EXPECT_EQ(adhesion.slope, normal_of(scene).stiffness);
  EXPECT_EQ(adhesion.reference, dem::CoulombReference::repulsive);
  EXPECT_EQ(scene.grains.size_ratio, 3.0);
  // Table 1: gamma_n = 0.002 kg/s, k_n = 100 kg/s^2, d = 2 mm give the restitution 0.858.
  EXPECT_NEAR(normal_of(scene).restitution(0.5), 0.858, 5e-4);
}

TEST(SceneInput, SplitBottomExampleIsTheCellOfShiEtAl) {
  const SceneFile file = read_scene(data / "scenes/split_bottom.toml");
  const auto& cell = std::get<dem::SplitBottom>(file.scene.geometry);
  EXPECT_NEAR(cell.outer_radius * file.units.length, 0.110, 0.110 * bits);
  EXPECT_NEAR(cell.rotation_rate / file.units.time, 0.628, 0.628 * bits);
  EXPECT_EQ(cell.gravity, 1.0);
  // One grain more or less, by rounding, of the depth of 40 mm.
  const double depth = dem::nominal_depth(file.scene.grains, cell);
  EXPECT_NEAR(depth * file.units.length, 0.040, 0.040 / cell.grains);
}

TEST(SceneInput, HertzTakesARateOrADashpotAndMayBeClipped) {
  const dem::Scene scene =
      scene_of(head("law = \"hertz\"\ndamping_rate = 10.0\nclip_attraction = true") + sheared());
  const auto& law = std::get<dem::Hertz>(scene.normal);
  EXPECT_EQ(law.stiffness, 2e4);
  EXPECT_EQ(law.damping, 10.0);
  EXPECT_TRUE(law.clip_attraction);
  EXPECT_FALSE(normal_of(scene_of(head() + sheared())).clip_attraction);
}

TEST(SceneInput, EveryCohesionLawIsReadWithItsOwnCoulombReference) {
  const auto cohesion = [](const std::string& keys) {
    return scene_of(head() + "[contact.cohesion]\n" + keys + sheared()).cohesion;
  };
  EXPECT_TRUE(std::holds_alternative<dem::Cohesionless>(scene_of(head() + sheared()).cohesion));
  const auto well =
      std::get<dem::GaussianWell>(cohesion("law = \"gaussian_well\"\nstrength = 0.6\n"));
  EXPECT_EQ(well.strength, 0.6);
  EXPECT_EQ(well.width, 0.01);
  EXPECT_EQ(well.reference, dem::CoulombReference::total);
  const auto adhesion = std::get<dem::ReversibleAdhesion>(
      cohesion("law = \"reversible_adhesion\"\nlargest_force = 10\nslope = 1e3\n"
               "coulomb_reference = \"total\"\n"));
  EXPECT_EQ(adhesion.largest_force, 10.0);
  EXPECT_EQ(adhesion.slope, 1e3);
  EXPECT_EQ(adhesion.reference, dem::CoulombReference::total);
  const auto bridge = std::get<dem::LiquidBridge>(
      cohesion("law = \"liquid_bridge\"\nsurface_tension = 2\ncontact_angle = 20\n"
               "volume = 1e-3\n"));
  EXPECT_EQ(bridge.surface_tension, 2.0);
  EXPECT_EQ(bridge.contact_angle, radians(20.0));
  EXPECT_EQ(bridge.volume, 1e-3);
  EXPECT_EQ(bridge.reference, dem::CoulombReference::repulsive);
}

TEST(SceneInput, ALiquidBridgeInSiHasTheForceAndRangeOfThePaper) {
  // Shi et al. (2020), table 1: 0.3 N/m, 20 degrees, 75 nl, d = 2.2 mm.
  const SceneFile file = parse_scene(
      "units = \"si\"\n[grains]\ndiameter = 2.2e-3\ndensity = 2000.0\n"
      "[contact.normal]\nlaw = \"hooke\"\nstiffness = 100.0\ndashpot = 0.002\n"
      "[contact.cohesion]\nlaw = \"liquid_bridge\"\nsurface_tension = 0.3\ncontact_angle = 20.0\n"
      "volume = 75e-12\n"
      "[geometry]\nkind = \"simple_shear\"\nshear_rate = 5.0\npressure = 500.0\ngrains = 200\n",
      "wet.toml");
  const auto& bridge = std::get<dem::LiquidBridge>(file.scene.cohesion);
  const double force = bridge.largest_attraction(0.5) * file.units.size(dimension::force);
  const double tension = 2.0 * std::numbers::pi * 1.1e-3 * 0.3 * std::cos(radians(20.0));
  EXPECT_NEAR(force, tension, tension * 2.0 * bits);
  const double range = (1.0 + 0.5 * radians(20.0)) * std::cbrt(75e-12);
  EXPECT_NEAR(bridge.range() * file.units.length, range, range * 2.0 * bits);
}

TEST(SceneInput, TangentialDashpotActsOnTheVelocityAndZeroResistanceIsAccepted) {
  const std::string friction =
      "[contact.friction]\ncoefficient = 0.5\nrolling_coefficient = 0.0\n"
      "torsion_coefficient = 0\n";
  const dem::Scene sliding =
      scene_of(head() + friction + "law = \"sliding\"\ndashpot = 5.0\n" + sheared());
  EXPECT_EQ(std::get<dem::Sliding>(sliding.friction).dashpot, 5.0);
  EXPECT_EQ(std::get<dem::Sliding>(sliding.friction).damping, 0.0);
  const dem::Scene sticking = scene_of(head() + friction +
                                       "law = \"stick_slip\"\nstatic_coefficient = 0.7\n"
                                       "damping_rate = 3.0\nstiffness = 1e4\n" +
                                       sheared());
  const auto& law = std::get<dem::StickSlip>(sticking.friction);
  EXPECT_EQ(law.static_coefficient, 0.7);
  EXPECT_EQ(law.coefficient, 0.5);
  EXPECT_EQ(law.stiffness, 1e4);
  EXPECT_EQ(law.damping, 3.0);
}

TEST(SceneInput, EveryBaseAndTheSidewallsOfAChuteAreRead) {
  const auto base = [](const std::string& keys) {
    return chute_of(scene_of(scene_text("[geometry.base]\n" + keys))).base;
  };
  EXPECT_EQ(std::get<dem::BumpyBase>(base("")).thickness, 1.5);
  EXPECT_EQ(std::get<dem::LatticeBase>(base("recipe = \"lattice\"\nspacing = 1.2\n")).spacing, 1.2);
  EXPECT_TRUE(std::get<dem::FlatBase>(base("recipe = \"flat\"\n")).frictional);
  EXPECT_FALSE(std::get<dem::FlatBase>(base("recipe = \"flat\"\nfrictional = false\n")).frictional);
  EXPECT_FALSE(chute_of(scene_of(scene_text())).sidewalls);
  const dem::Scene walled = scene_of(scene_text("[geometry.sidewalls]\n"));
  EXPECT_TRUE(chute_of(walled).sidewalls->frictional);
}

TEST(SceneInput, ASimpleShearHoldsItsPressureOrItsVolume) {
  const auto shear_of = [](const std::string& keys) {
    return std::get<dem::SimpleShear>(
        scene_of(head() + "[geometry]\nkind = \"simple_shear\"\nshear_rate = 0.1\n" + keys)
            .geometry);
  };
  const dem::SimpleShear cube = shear_of("pressure = 0.0\ngrains = 200\n");
  EXPECT_EQ(cube.pressure, 0.0);
  EXPECT_EQ(cube.size, dem::Vec3{});
  const dem::SimpleShear box =
      shear_of("volume = \"fixed\"\ngrains = 200\nlength = 7\nheight = 5\nwidth = 6\n");
  EXPECT_FALSE(box.pressure);
  EXPECT_EQ(box.size, (dem::Vec3{7.0, 5.0, 6.0}));
}

TEST(SceneInput, APlaneShearKeepsItsLoadOrItsGapAndMayFall) {
  const auto plane_of = [](const std::string& keys) {
    return std::get<dem::PlaneShear>(
        scene_of(head() + "[geometry]\nkind = \"plane_shear\"\nvelocity = 1\ngrains = 500\n" + keys)
            .geometry);
  };
  const dem::PlaneShear loaded = plane_of("load = 10.0\n");
  EXPECT_EQ(loaded.load, 10.0);
  EXPECT_EQ(loaded.gravity, 0.0);
  const dem::PlaneShear fixed =
      plane_of("gap = \"fixed\"\ngravity = 1.0\n[geometry.wall]\nrecipe = \"lattice\"\n");
  EXPECT_FALSE(fixed.load);
  EXPECT_EQ(fixed.gravity, 1.0);
  EXPECT_TRUE(std::holds_alternative<dem::LatticeBase>(fixed.wall));
}

TEST(SceneInput, DefaultTimesOfAShearedBoxAreToldInStrain) {
  const dem::Scene slow = scene_of(head() + sheared());
  // 200 T with T = 0.1/shear_rate: 20 of strain.
  EXPECT_NEAR(slow.measurement.averaging_time * 0.1, 20.0, 20.0 * bits);
  EXPECT_EQ(scene_of(scene_text()).measurement.averaging_time, 200.0);
}

TEST(SceneInput, ADepthOfMixedGrainsTakesFewerOfThem) {
  const std::string chute =
      "[geometry]\nkind = \"chute\"\ninclination = 23\nlength = 10\nwidth = 10\ndepth = 12\n";
  const double equal = chute_of(scene_of(head() + chute)).grains;
  const double mixed = chute_of(scene_of(head() + "[grains]\nsize_ratio = 3.0\n" + chute)).grains;
  EXPECT_NEAR(mixed, equal / 1.25, 1.0);  // <D^3> = 5/4 d^3; whole grains
}

}  // namespace
}  // namespace grainlaw::io
