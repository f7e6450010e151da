#include "apps/io/start_csv.h"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/io/scene_input.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw::io {
namespace {

constexpr double bits = 4.0 * 2.220446049250313e-16;  // a handful of roundings

/// A scene with a start in a directory of its own.
struct WithStart {
  TemporaryDirectory directory;
  SceneFile read(const std::string& csv, const std::string& units = "units = \"grain\"\n") {
    directory.write("grains.csv", csv);
    return read_scene(directory.write("scene.toml",
                                      units +
                                          "[contact.normal]\nlaw = \"hooke\"\nstiffness = 2e4\n"
                                          "restitution = 0.88\n"
                                          "[start]\ngrains = \"grains.csv\"\n" +
                                          geometry));
  }
  std::string geometry =
      "[geometry]\nkind = \"chute\"\ninclination = 23\nlength = 8\nwidth = 8\n"
      "[geometry.base]\nrecipe = \"flat\"\n[measurement]\nbin_width = 0.1\n";
};

/// Grains enough for three bins of 0.1 d: nominal depth 0.31 d.
std::string many_grains(const std::string& names, const std::string& rest) {
  std::string csv = names + "\n";
  for (int k = 0; k < 22; ++k)
    csv += std::to_string(k % 8) + ".5,0.5," + std::to_string(k) + rest + "\n";
  return csv;
}

TEST(StartCsv, GrainsAreReadInAnyOrderOfColumnsWithDefaults) {
  WithStart scene;
  const SceneFile plain = scene.read("# from elsewhere\r\n" + many_grains("x,y,z", "") + "\n");
  ASSERT_EQ(plain.scene.start.size(), 22u);
  EXPECT_EQ(dem::grains(plain.scene), 22);
  EXPECT_EQ(std::get<dem::Chute>(plain.scene.geometry).grains, 22);
  EXPECT_EQ(plain.scene.start[3].position, (dem::Vec3{3.5, 0.5, 3.0}));
  EXPECT_EQ(plain.scene.start[3].velocity, dem::Vec3{});
  EXPECT_EQ(plain.scene.start[3].diameter, 1.0);
  EXPECT_FALSE(plain.scene.start[3].frozen);
  const SceneFile full = scene.read(
      many_grains("x,y,z, frozen ,wz,wy,wx,vz,vy,vx,diameter", ", 0, 6,5,4,3,2, -1e0,1"));
  EXPECT_EQ(full.scene.start[0].velocity, (dem::Vec3{-1.0, 2.0, 3.0}));
  EXPECT_EQ(full.scene.start[0].rotation, (dem::Vec3{4.0, 5.0, 6.0}));
}

TEST(StartCsv, AByteOrderMarkOfASpreadsheetIsNoPartOfTheFirstName) {
  EXPECT_EQ(WithStart().read("\xef\xbb\xbf" + many_grains("x,y,z", "")).scene.start.size(), 22u);
}

TEST(StartCsv, NumbersAreInTheUnitsOfTheScene) {
  WithStart scene;
  scene.geometry =
      "[geometry]\nkind = \"simple_shear\"\nshear_rate = 5\nvolume = \"fixed\"\n"
      "length = 0.008\nheight = 0.01\nwidth = 0.02\n";
  const SceneFile file = scene.read("x,y,z,vx,wz,diameter\n0.002,0.004,0.006,0.1,50,0.002\n",
                                    "units = \"si\"\n[grains]\ndiameter = 2e-3\ndensity = 2000\n");
  const dem::StartGrain& grain = file.scene.start.front();
  EXPECT_NEAR(grain.position.z, 3.0, 3.0 * bits);
  EXPECT_NEAR(grain.diameter, 1.0, bits);
  // sqrt(g d) with the 9.81 m/s^2 that stand for g where nothing falls.
  const double speed = 0.1 / std::sqrt(9.81 * 2e-3);
  EXPECT_NEAR(grain.velocity.x, speed, speed * bits);
  const double spin = 50.0 * std::sqrt(2e-3 / 9.81);
  EXPECT_NEAR(grain.rotation.z, spin, spin * bits);
}

TEST(StartCsv, FrozenGrainsAreTheBaseAndDoNotCount) {
  WithStart scene;
  scene.geometry =
      "[geometry]\nkind = \"chute\"\ninclination = 23\n[measurement]\nbin_width = 0.1\n";
  std::string csv = many_grains("x,y,z,frozen", ",0") + "4,4,-0.5,1\n";
  EXPECT_EQ(dem::grains(scene.read(csv).scene), 22);
  EXPECT_EQ(dem::glued_grains(scene.read(csv).scene), 1.0);
}

TEST(StartCsv, ATextWithAStartSaysItsScene) {
  WithStart scene;
  SceneFile file = scene.read(many_grains("x,y,z", ""));
  const std::filesystem::path path = file.path;
  const SceneFile stepped =
      parse_scene(file.text + "[time]\nstep = 1e-3\n", path, {.allow_unstable_step = true});
  EXPECT_FALSE(stepped.text.starts_with("# The run differs")) << stepped.text;
  EXPECT_EQ(parse_scene(stepped.text, path).scene.start.size(), 22u);
}

}  // namespace
}  // namespace grainlaw::io
