// Steady simple shear against LAMMPS (data/reference/lammps/README.md, section 3): volume fraction
// and stress ratio at the inertial number measured there.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "dem/run.h"

namespace grainlaw::dem {
namespace {

using Row = std::map<std::string, double>;

std::vector<Row> read_csv(const std::string& name) {
  std::ifstream in(std::string(REFERENCE_DIR "/") + name);
  EXPECT_TRUE(in) << name;
  const auto cells = [](const std::string& line) {
    std::vector<std::string> found;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) found.push_back(cell);
    return found;
  };
  std::string line;
  std::getline(in, line);
  const auto names = cells(line);
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    const auto values = cells(line);
    Row& row = rows.emplace_back();
    for (std::size_t k = 0; k < values.size(); ++k) row[names[k]] = std::stod(values[k]);
  }
  return rows;
}

/// The box of a row: density, mean diameter and stiffness 1.
Scene box(const Row& row) {
  const double pressure = row.at("p_star");
  const double rate = row.at("I_measured") * std::sqrt(pressure);
  const double viscosity = row.at("gamma_n");
  Scene scene;
  scene.grains.mass = std::numbers::pi / 6.0;
  scene.grains.size_ratio = row.at("w");
  scene.max_overlap = 0.7;  // small grains between large ones, pulled by cohesion
  scene.normal = Hooke{.stiffness = 1.0, .dashpot = viscosity};
  if (row.at("mu_p") > 0.0) {
    scene.friction = Sliding{
        .coefficient = row.at("mu_p"), .stiffness = 2.0 / 7.0, .dashpot = 2.0 / 7.0 * viscosity};
  }
  if (row.at("Bo") > 0.0) {
    scene.cohesion = ReversibleAdhesion{.largest_force = row.at("Bo") * pressure, .slope = 1.0};
  }
  SimpleShear shear;
  shear.shear_rate = rate;
  shear.pressure = pressure;
  shear.grains = static_cast<int>(row.at("N"));
  scene.geometry = shear;
  const double strain = std::max(6.0, row.at("strain_to"));
  scene.measurement = {.bin_width = 1.0,
                       .sample_interval = 0.002 / rate,
                       .frame_interval = 0.1 / rate,
                       .averaging_time = strain / rate,
                       .time_limit = (strain + 3.0) / rate};
  return scene;
}

/// Half-widths as data/reference/lammps/README.md states them.
double allowed(double error, double reference_error, double systematic) {
  return 2.0 *
         std::sqrt(error * error + reference_error * reference_error + systematic * systematic);
}

struct Difference {
  double phi;  ///< over what is allowed
  double mu;
};

Difference compare(const Row& row) {
  const LocalData data = run(box(row));
  const LocalRow& found = data.rows.at(0);
  const double phi = row.at("phi");
  const double mu = row.at("mu");
  const Difference difference{
      (found.volume_fraction.value - phi) /
          allowed(found.volume_fraction.error, row.at("phi_se"), 0.002 * phi),
      (found.friction.value - mu) / allowed(found.friction.error, row.at("mu_se"), 0.02 * mu)};
  std::printf(
      "mu_p %.2f Bo %.0f I %.4f p* %.4f: phi %.5f +- %.5f (%.5f), mu %.4f +- %.4f (%.4f), "
      "Z %.3f (%.3f); of what is allowed: %+.2f %+.2f\n",
      row.at("mu_p"),
      row.at("Bo"),
      row.at("I_measured"),
      row.at("p_star"),
      found.volume_fraction.value,
      found.volume_fraction.error,
      phi,
      found.friction.value,
      found.friction.error,
      mu,
      data.summary.coordination,
      row.at("Z"),
      difference.phi,
      difference.mu);
  // Our own errors have to be small enough for the comparison to mean something.
  EXPECT_LE(2.0 * found.volume_fraction.error, 0.004 * phi);
  EXPECT_LE(2.0 * found.friction.error, 0.03 * mu);
  return difference;
}

TEST(SimpleShearAgainstLammps, VolumeFractionAndStressRatioAgree) {
  std::vector<Row> rows = read_csv("ss_noncohesive.csv");
  for (const Row& row : read_csv("ss_cohesive.csv")) rows.push_back(row);
  int inside = 0;
  int positive_phi = 0;
  int positive_mu = 0;
  for (const Row& row : rows) {
    const Difference d = compare(row);
    inside += std::abs(d.phi) <= 1.0 && std::abs(d.mu) <= 1.0;
    positive_phi += d.phi > 0.0;
    positive_mu += d.mu > 0.0;
  }
  const auto count = static_cast<int>(rows.size());
  EXPECT_GE(inside, 0.9 * count);
  // No common sign: with fair coins all heads or all tails of 11 come once in a thousand times.
  for (const int positive : {positive_phi, positive_mu}) {
    EXPECT_GT(positive, 0);
    EXPECT_LT(positive, count);
  }
}

}  // namespace
}  // namespace grainlaw::dem
