// Our files in the programs other people read them with: h5py and ParaView.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/shell.h"

namespace {

namespace fs = std::filesystem;

using Output = grainlaw::testing::CommandOutput;
const auto run = grainlaw::testing::run_command;

/// A run with a trajectory, written once.
class Readers : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    fs::create_directories(folder);
    std::ofstream(folder / "scene.toml")
        << "name = \"small\"\nunits = \"grain\"\n[contact.normal]\nlaw = \"hooke\"\n"
           "stiffness = 2e4\nrestitution = 0.88\n[contact.friction]\nlaw = \"sliding\"\n"
           "coefficient = 0.5\n[geometry]\nkind = \"chute\"\ninclination = 24\nlength = 5\n"
           "width = 4\ndepth = 5\n[measurement]\naveraging_time = 40\ntime_limit = 60\n";
    made = run(std::string(GRAINLAW_BIN) + "/grainlaw dem " + (folder / "scene.toml").string() +
               " -o " + (folder / "run.h5").string() + " --trajectory 5 --export xyz --quiet");
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  static std::string python(const std::string& script, const std::string& interpreter) {
    std::ofstream(folder / "script.py") << script;
    const Output output = run("cd " + folder.string() + " && " + interpreter + " script.py");
    EXPECT_EQ(output.code, 0) << output.text;
    return output.text;
  }

  static inline const fs::path folder =
      fs::temp_directory_path() / ("grainlaw-readers-" + std::to_string(getpid()));
  static inline Output made;
};

TEST_F(Readers, LocalDataAreReadInThreeLinesOfH5py) {
  if (run("/usr/bin/python3 -c 'import h5py'").code != 0) GTEST_SKIP() << "no python3-h5py here";
  ASSERT_TRUE(fs::exists(folder / "run.h5")) << made.text;
  const std::string said = python(
      "import h5py\n"
      "file = h5py.File('run.h5')\n"
      "z, v, error = (file['rows'][name][:] for name in ('z', 'velocity', 'velocity_error'))\n"
      "assert len(z) == len(v) == len(error) > 2\n"
      "assert file['rows/velocity'].attrs['unit'].decode() == 'sqrt(g d)'\n"
      "assert file.attrs['version'] and 'hooke' in file['scene'][0].decode()\n"
      "assert file['run'].attrs['wall_seconds'] > 0 and file['run'].attrs['cores'] > 0\n"
      "grains = h5py.File('run.grains/00000003.h5')\n"
      "assert grains['position'].shape == (len(grains['radius']), 3)\n"
      "assert 15 <= grains.attrs['time'] < 15.5\n"
      "print('read')\n",
      "/usr/bin/python3");
  EXPECT_EQ(said, "read\n");
}

TEST_F(Readers, ParaViewOpensTheTrajectoryWithItsTimes) {
  if (run("command -v pvpython").code != 0) GTEST_SKIP() << "no pvpython (package paraview) here";
  ASSERT_TRUE(fs::exists(folder / "run.xdmf")) << made.text;
  const std::string said = python(
      "from paraview.simple import *\n"
      "reader = XDMFReader(FileNames=['run.xdmf'])\n"
      "reader.UpdatePipelineInformation()\n"
      "times = list(reader.TimestepValues)\n"
      "assert len(times) > 8 and all(0 <= t - 5 * k < 0.5 for k, t in enumerate(times)), times\n"
      "reader.UpdatePipeline(times[3])\n"
      "data = reader.GetDataInformation()\n"
      "assert data.GetNumberOfPoints() > 100\n"
      "names = [a.GetName() for a in reader.PointData.values()]\n"
      "assert {'radius', 'velocity', 'spin', 'body'} <= set(names), names\n"
      "assert reader.PointData['radius'].GetRange() == (0.5, 0.5)\n"
      "print('opened')\n",
      "pvpython");
  EXPECT_NE(said.find("opened"), std::string::npos) << said;
}

}  // namespace
