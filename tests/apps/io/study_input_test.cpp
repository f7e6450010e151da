#include "apps/io/study_input.h"

#include <gtest/gtest.h>

#include "apps/io/input_file.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw::io {
namespace {

std::string problem_of(const std::string& text) {
  const TemporaryDirectory folder;
  try {
    read_study(folder.write("study.toml", text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(StudyInput, PathsAreRelativeToTheStudyAndSettingsAscend) {
  const TemporaryDirectory folder;
  const StudyFile file = read_study(folder.write(
      "study.toml",
      "kind = \"time_step\"\nscene = \"box.toml\"\nsteps_per_contact = [40, 10, 20]\n"));
  const auto& study = std::get<TimeStepStudy>(file.kind);
  EXPECT_EQ(study.scene, folder / "box.toml");
  EXPECT_EQ(study.steps_per_contact, (std::vector<double>{10.0, 20.0, 40.0}));
  EXPECT_EQ(kind_name(file), "time_step");
  EXPECT_EQ(file.title, "study");
}

TEST(StudyInput, AKeyOfAnotherKindIsUnknown) {
  const std::string text = problem_of("kind = \"kernel\"\nrun = \"a.h5\"\ncells = [10, 20]\n");
  EXPECT_NE(text.find("study.toml:3:1: error: unknown key 'cells'"), std::string::npos) << text;
}

TEST(StudyInput, ASweepNeedsTwoDifferentSettings) {
  const std::string one = problem_of("kind = \"grains\"\nscene = \"box.toml\"\ngrains = [100]\n");
  EXPECT_NE(one.find("at least two different values"), std::string::npos) << one;
  const std::string twins = problem_of("kind = \"base\"\nscene = \"chute.toml\"\nsides = [5, 5]\n");
  EXPECT_NE(twins.find("at least two different values"), std::string::npos) << twins;
}

TEST(StudyInput, ARunAndASceneExcludeEachOther) {
  const std::string text =
      problem_of("kind = \"kernel\"\nrun = \"a.h5\"\nscene = \"chute.toml\"\n");
  EXPECT_NE(text.find("exclude each other"), std::string::npos) << text;
}

TEST(StudyInput, NumbersOfGrainsAreWhole) {
  const std::string text =
      problem_of("kind = \"grains\"\nscene = \"box.toml\"\ngrains = [100, 200.5]\n");
  EXPECT_NE(text.find("takes whole numbers"), std::string::npos) << text;
}

}  // namespace
}  // namespace grainlaw::io
