// docs/verification.md is made of what the tests V1 to V16 measure, all of which are linked into
// this program; run as a whole it checks that the document is current. GRAINLAW_UPDATE_DOCS=1 in
// the environment writes the file instead.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/verification/verified.h"

namespace grainlaw {
namespace {

constexpr const char* path = GRAINLAW_DOCS "/verification.md";

constexpr const char* introduction =
    R"(# Verification of the continuum solvers

Made by `tests/verification`, which fails when a line below no longer holds or no longer is what the
solvers give: the difference of expected and measured has to stay below the tolerance, and so has
what is measured from what stands here. Units d = rho_p = g = 1; "error" is relative to the largest
velocity unless something else is named, "order" is log2 of the ratio of two errors as the cells
double. Expected values are closed forms, or digits of an independent implementation.

| case | source |
|---|---|
| V1 | Bagnold flow at constant phi, u ~ H^1.5 - y^1.5 |
| V2 | generalised Bagnold law, Brewster et al. 2008, eq. 9 |
| V3 | linear mu(I) with a constant cohesion, elementary integral |
| V4 | start of a linear fluid, Fourier series |
| V5, V6 | law of Shi et al. 2020 for mu_p = 0.5 and 0.01, independent quadrature |
| V7 | arrest in finite time of a flow with a yield stress, implicit Euler of the rigid material |
| V8 | side walls at constant density, tau / p = tan(theta) - mu_w K y / W |
| V9, V10, V11 | nonlocal fluidity: creep between walls, stop depth, plane shear under gravity |
| V12 | height of a dilating start from the continuity equation on a grid in z |
| V13 | limits of vanishing parameters |
| V14 | manufactured solution of the full law in time |
| V15 | well-posedness: hand-derived condition, eigenvalues of the linearised equations |
| V16 | ring cell: Couette flow between tall cylinders, path of least torque of the slow local flow |

The error in time of V14 grows as tolerance times number of steps, because CVODE holds the error of
each step, not of each unit of time, at the tolerance. Against the tolerance alone its slope is that
of a method of order p, p / (p + 1): 5/6 for the order 5 that BDF ends with.

| id | what | expected | measured | tolerance |
|---|---|---|---|---|
)";

std::string line(const Verified& v) {
  const std::string measured =
      v.expected == 0.0 ? fmt::format("{:.2g}", v.measured) : fmt::format("{:.11g}", v.measured);
  return fmt::format(
      "| {} | {} | {:.11g} | {} | {:.2g} |\n", v.id, v.what, v.expected, measured, v.tolerance);
}

/// V2 before V10, and within a case the order of the tests.
std::vector<Verified> in_order() {
  std::vector<Verified> all = verified();
  std::ranges::stable_sort(all, {}, [](const Verified& v) { return std::stoi(v.id.substr(1)); });
  return all;
}

std::string document() {
  std::string text = introduction;
  for (const Verified& v : in_order()) text += line(v);
  return text;
}

/// A line of the file with its measured value replaced by the one of now, if that is close.
std::string with_measured_of(const Verified& now, const std::string& line) {
  std::istringstream cells(line);
  std::string cell;
  for (int i = 0; i < 5; ++i) std::getline(cells, cell, '|');  // "", id, what, expected, measured
  char* end = nullptr;
  Verified old = now;
  old.measured = std::strtod(cell.c_str(), &end);
  return std::abs(old.measured - now.measured) <= now.tolerance ? grainlaw::line(now) : line;
}

/// The file, brought up to date where it differs by less than the tolerances.
std::string current(const std::string& file) {
  if (!file.starts_with(introduction)) return file;
  std::string text = introduction;
  std::istringstream lines(file.substr(text.size()));
  std::string line;
  const std::vector<Verified> all = in_order();
  for (std::size_t i = 0; std::getline(lines, line); ++i)
    text += i < all.size() ? with_measured_of(all[i], line + "\n") : line + "\n";
  return text;
}

class Document : public testing::Environment {
 public:
  void TearDown() override {
    if (std::getenv("GRAINLAW_UPDATE_DOCS") != nullptr) std::ofstream(path) << document();
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    EXPECT_EQ(current(text.str()), document()) << "docs/verification.md is out of date";
  }
};

const testing::Environment* const registered = testing::AddGlobalTestEnvironment(new Document);

}  // namespace
}  // namespace grainlaw
