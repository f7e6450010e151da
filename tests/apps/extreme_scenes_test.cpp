// Stiff, soft, cohesive and fast scenes: each is answered, or refused with the sentence it names.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "apps/io/scene_input.h"
#include "dem/run.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

/// After "# expect: " in the first line of the file.
std::string expectation(const fs::path& path) {
  const std::string mark = "# expect: ";
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line.starts_with(mark) ? line.substr(mark.size()) : "an expectation in the first line";
}

std::string outcome(const fs::path& path) {
  try {
    const dem::LocalData data = dem::run(io::read_scene(path).scene);
    EXPECT_LT(data.summary.largest_overlap, 0.5) << path;
    EXPECT_FALSE(data.rows.empty()) << path;
    return data.window.reason;
  } catch (const std::exception& error) {
    return error.what();
  }
}

TEST(ExtremeScenes, AreAnsweredOrRefusedWithTheSentenceTheyExpect) {
  int scenes = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(GRAINLAW_DATA) / "scenes/extreme")) {
    const std::string wanted = expectation(entry.path());
    const std::string found = outcome(entry.path());
    EXPECT_NE(found.find(wanted), std::string::npos) << entry.path() << ": " << found;
    ++scenes;
  }
  EXPECT_GE(scenes, 8);
}

}  // namespace
}  // namespace grainlaw
