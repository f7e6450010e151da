// docs/input.md is made of the same key definitions the parsers use; this test keeps it so.
// GRAINLAW_UPDATE_DOCS=1 in the environment writes the file instead of comparing it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "apps/io/campaign_input.h"
#include "apps/io/case_input.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/io/scene_input.h"

namespace grainlaw::io {
namespace {

constexpr const char* introduction =
    R"(# Input

Input files are TOML. A key that is not listed here, a wrong type or a value outside its range is an
error with file, line, column and the nearest known key; nothing is ignored. A missing section is a
missing mechanism: without `[contact.friction]` grains are frictionless and carry neither spin nor
history.

**Units.** Every file names one set:

| `units` | mass | length | time | must be given |
|---|---|---|---|---|
| `"grain"` | grain mass m | diameter d | sqrt(d/g) | nothing: m, d and g are 1 |
| `"stiffness"` | rho_p d^3 | diameter d | sqrt(rho_p d^3/k_n) | `gravity` |
| `"si"` | kg | m | s | `diameter`, `density`, `gravity` |

Angles are in degrees. Numbers are converted once, when read.

)";

std::string reference() {
  return std::string(introduction) + "## Scene (`grainlaw dem`)\n\n" + scene_keys() +
         "\n## Campaign (`grainlaw calibrate`)\n\n" + campaign_keys() +
         "\n## Case (`grainlaw predict`)\n\n" + case_keys() +
         "\n## Rheology table (`--table`)\n\n" + table_keys();
}

TEST(InputReference, IsMadeOfTheKeysTheParsersKnow) {
  const std::string path = GRAINLAW_DOCS "/input.md";
  if (std::getenv("GRAINLAW_UPDATE_DOCS") != nullptr) std::ofstream(path) << reference();
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), reference()) << "docs/input.md is out of date";
}

}  // namespace
}  // namespace grainlaw::io
