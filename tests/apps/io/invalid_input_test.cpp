// Every file of data/invalid is refused with the message its first line expects.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "apps/io/campaign_input.h"
#include "apps/io/case_input.h"
#include "apps/io/import.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/io/safe_write.h"
#include "apps/io/start_csv.h"
#include "apps/io/text_table.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw::io {
namespace {

const std::filesystem::path data = GRAINLAW_DATA;

/// Inputs; what else is there belongs to one of them.
std::vector<std::filesystem::path> invalid_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(data / "invalid")) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  return files;
}

/// The first word of the name of a file says what it is.
void read_anything(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  if (name.starts_with("scene")) read_scene(path);
  if (name.starts_with("campaign")) read_campaign(path);
  if (name.starts_with("case")) read_case(path);
  if (name.ends_with(".chunk")) {
    read_lammps_chunk(path);
  } else if (name.ends_with(".stat")) {
    read_mercury_cg(path);
  } else if (name.starts_with("import")) {
    read_run(path);
  }
  if (name.starts_with("table")) read_table(path);
  if (name.starts_with("start")) read_start(path, grain_units());
}

std::string message_of(const std::filesystem::path& path) {
  try {
    read_anything(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

std::string expectation(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  const std::string mark = "# expect: ";
  if (text.empty()) return "missing key 'units' at the top level";
  return text.substr(mark.size(), text.find('\n') - mark.size());
}

TEST(InvalidInput, EveryFileIsRefusedWithTheMessageItExpects) {
  for (const std::filesystem::path& path : invalid_files()) {
    const std::string message = message_of(path);
    EXPECT_NE(message.find(expectation(path)), std::string::npos) << path << ":\n" << message;
  }
  EXPECT_GE(invalid_files().size(), 100u);
}

TEST(InvalidInput, EveryMessageNamesFileLineAndColumn) {
  for (const std::filesystem::path& path : invalid_files()) {
    const std::string message = message_of(path);
    EXPECT_TRUE(message.starts_with(data.string() + "/invalid/")) << message;
    const std::size_t colon = message.find(": error: ") == std::string::npos
                                  ? message.size()
                                  : message.find(':', data.string().size()) + 1;
    int line = 0;
    int column = 0;
    EXPECT_EQ(std::sscanf(message.c_str() + colon, "%d:%d: error: ", &line, &column), 2) << message;
    EXPECT_GE(line, 1);
    EXPECT_GE(column, 1);
  }
}

/// Files with one wrong value each.
TEST(InvalidInput, AListWithAWrongValueIsOneProblem) {
  const TemporaryDirectory directory;
  const std::string chute = "scene = \"" + (data / "scenes/chute.toml").string() + "\"\n";
  std::string sweep = read_file(data / "cases/sweep.toml");
  sweep.replace(sweep.find("18.0"), 4, "95.0");
  const std::vector<std::pair<std::string, std::string>> files{
      {"campaign.toml", chute + "[tilts]\ncalibrate = [24, 95]\npredict = [25]\n"},
      {"campaign.toml", chute + "seeds = [1, 0.5]\n[tilts]\ncalibrate = [24]\npredict = [25]\n"},
      {"case.toml", sweep},
  };
  for (const auto& [name, text] : files) {
    const std::string message = message_of(directory.write(name, text));
    const std::size_t first = message.find(": error: ");
    ASSERT_NE(first, std::string::npos) << message;
    EXPECT_EQ(message.find(": error: ", first + 1), std::string::npos) << message;
  }
}

TEST(InvalidInput, MessagesHoldNoBytesThatATerminalWouldObey) {
  for (const std::filesystem::path& path : invalid_files()) {
    for (const char c : message_of(path)) {
      EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 || c == '\n') << path;
    }
  }
}

TEST(InvalidInput, AMissingTableNamesThePathAndTheSystemError) {
  try {
    read_table("no/such/table.toml");
    FAIL();
  } catch (const ReadError& error) {
    EXPECT_STREQ(error.what(), "cannot read no/such/table.toml: No such file or directory");
  }
}

TEST(InvalidInput, ADirectoryIsNoInputFile) {
  EXPECT_THROW(read_scene(data), ReadError);
}

/// A valid file with a few bytes replaced, removed or doubled.
std::string mutated(std::string text, std::mt19937_64& random) {
  const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const std::size_t changes = 1 + pick(4);
  for (std::size_t k = 0; k < changes && !text.empty(); ++k) {
    const std::size_t at = pick(text.size());
    const std::string snippets = "[]{}=.,\"'\n#-+e0_\\\xff\x01";
    if (pick(3) == 0) text.erase(at, 1 + pick(20));
    if (text.empty() || at >= text.size()) continue;
    if (pick(2) == 0) text[at] = snippets[pick(snippets.size())];
    if (pick(3) == 0) text.insert(at, text.substr(pick(text.size()), 1 + pick(20)));
  }
  return text;
}

TEST(InvalidInput, MutilatedFilesAreReadOrRefusedButNeverCrash) {
  const TemporaryDirectory directory;
  std::mt19937_64 random(7);
  const std::vector<std::pair<std::string, std::string>> originals{
      {"scene.toml", read_file(data / "scenes/chute.toml")},
      {"scene.toml", read_file(data / "scenes/simple_shear_cohesive.toml")},
      {"scene.toml", read_file(data / "scenes/plane_shear.toml")},
      {"scene.toml", read_file(data / "scenes/split_bottom.toml")},
      {"start.csv", "# grains\nx,y,z,diameter,frozen\n1,1,0.5,1,0\n2.5,-1e-3,0.5,1.2,1\n"},
      {"import.chunk", read_file(data / "invalid/import_cut_short.chunk") + " 3 2.5 10 1 3\n"},
      {"import.stat", read_file(data / "imports/mercury_cg.stat").substr(0, 4000)},
      {"case.toml", read_file(data / "cases/glass_beads_si.toml")},
      {"table.toml", read_file(data / "tables/shi2020_mu_p_0.50.toml")}};
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const auto& [name, text] = originals[static_cast<std::size_t>(trial) % originals.size()];
    const std::filesystem::path path = directory.write(name, mutated(text, random));
    try {
      read_anything(path);
    } catch (const InputError&) {
      ++refused;
    } catch (const dem::StepRefused&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace grainlaw::io
