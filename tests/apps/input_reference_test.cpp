// docs/input.md is made of the same key definitions the parsers use; this test keeps it so.
// GRAINLAW_UPDATE_DOCS=1 in the environment writes the file instead of comparing it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "apps/io/campaign_input.h"
#include "apps/io/case_input.h"
#include "apps/io/import_input.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/io/scene_input.h"
#include "apps/io/study_input.h"

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
| `"stiffness"` | rho_p d^3 | diameter d | sqrt(rho_p d^3/k_n) | `gravity`, where grains fall |
| `"si"` | kg | m | s | `diameter`, `density`; `gravity`, where grains fall |

Angles are in degrees. Numbers are converted once, when read. Of grains of different sizes, d is the
number mean of the diameters and m the mass of a grain of that diameter. A flow without gravity has
no `gravity` key; results in m, d and sqrt(d/g) then take g = 1 in the units of the file, or
9.81 m/s^2 in SI.

**Start.** A scene runs from a packing that is made for it, or from the grains of a CSV file:

```
# any comment lines
x,y,z,vx,vy,vz,wx,wy,wz,diameter,frozen
0.5,0.5,-0.5,0,0,0,0,0,0,1,1
0.5,0.5,1.2,0.1,0,0,0,0,0,1,0
```

Columns in any order, in the units of the scene; only x, y and z are required. Grains are otherwise
at rest, of the mean diameter and free. Frozen ones (1) are the base of a chute, the walls of a plane
shear, or the bottom of a split cell.

A chute may start with a velocity profile instead of from rest, which saves the time it would take to get there:
`profile` names the CSV that `grainlaw predict -o PROFILE.csv` writes in the units of the scene. The packing
settles, then each grain gets the velocity of its height and half its vorticity. A campaign with a `start_table`
does this for all its runs.

)";

std::string reference() {
  return std::string(introduction) + "## Scene (`grainlaw dem`)\n\n" + scene_keys() +
         "\n## Campaign (`grainlaw calibrate`)\n\n" + campaign_keys() +
         "\n## Case (`grainlaw predict`)\n\n" + case_keys() +
         "\n## Import (`grainlaw compare`, `grainlaw calibrate --from`)\n\n" + import_keys() +
         "\n## Study (`grainlaw study`)\n\n" + study_keys() +
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
