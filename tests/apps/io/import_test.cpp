#include "apps/io/import.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "apps/io/safe_write.h"
#include "apps/io/text_table.h"
#include "calibration/bagnold_fit.h"
#include "calibration/comparison.h"
#include "calibration/mu_phi_fit.h"
#include "continuum/chute_1d.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw::io {
namespace {

using dem::Estimate;
using dem::LocalRow;

const std::filesystem::path data = GRAINLAW_DATA;

RunRecord imported(const std::string& name) {
  return read_run(data / "imports" / (name + ".toml"));
}

const ImportCheck& check(const RunRecord& record, std::string_view name) {
  return *std::ranges::find(record.checks, name, &ImportCheck::name);
}

/// A law of constant I in a layer of 10 m/d^2 at 23 degrees, written by hand as a program would.
struct Layer {
  static constexpr double phi = 0.57;
  static constexpr double tilt = 23.0 * std::numbers::pi / 180.0;
  static constexpr double density = phi * 6.0 / std::numbers::pi;
  double depth(double z) const { return 10.0 - z; }
  double normal(double z) const { return density * std::cos(tilt) * depth(z); }
  double shear(double z) const { return density * std::sin(tilt) * depth(z); }
  double velocity(double z) const { return 0.2 * (std::pow(10.0, 1.5) - std::pow(depth(z), 1.5)); }
};

/// The layer as CSV, every field times a factor: length, velocity, stress.
std::string layer_csv(double length = 1.0,
                      double velocity = 1.0,
                      double normal = 1.0,
                      double shear = 1.0) {
  const Layer layer;
  std::string csv =
      "z,velocity,volume_fraction,shear_stress,normal_stress,velocity_error,volume_fraction_error,"
      "shear_stress_error,normal_stress_error\n";
  for (double z = 0.5; z < 10.0; z += 1.0) {
    csv += fmt::format("{},{},{},{},{},{},0.01,{},{}\n",
                       z * length,
                       layer.velocity(z) * velocity,
                       Layer::phi,
                       layer.shear(z) * shear,
                       layer.normal(z) * normal,
                       0.01 * velocity,
                       0.05 * std::abs(shear),
                       0.05 * std::abs(normal));
  }
  return csv;
}

struct WithImport {
  TemporaryDirectory directory;
  RunRecord read(const std::string& csv,
                 const std::string& top = "units = \"grain\"\n",
                 const std::string& stiffness = "2e4",
                 const std::string& more = "[window]\nsteady = true\n") {
    directory.write("layer.csv", csv);
    return read_run(directory.write("layer.toml",
                                    top + "format = \"csv\"\nfile = \"layer.csv\"\n" + more +
                                        "[conditions]\ninclination = 23\ncontact_friction = 0.5\n" +
                                        "base = \"any\"\nbase_top = 0\nstiffness = " + stiffness +
                                        "\n"));
  }
};

TEST(Import, AveragesOfAKnownLayerBecomeItsRows) {
  const RunRecord record = WithImport().read(layer_csv());
  const Layer layer;
  ASSERT_EQ(record.data.rows.size(), 10u);
  EXPECT_TRUE(record.data.window.steady) << record.data.window.reason;
  EXPECT_NEAR(record.data.conditions.mass_per_area, 10.0 * Layer::density, 1e-12);
  for (const LocalRow& row : record.data.rows) {
    EXPECT_NEAR(row.velocity.value, layer.velocity(row.z), 1e-12);
    EXPECT_NEAR(row.volume_fraction.value, Layer::phi, 1e-12);
    EXPECT_NEAR(row.mass_above, Layer::density * layer.depth(row.z), 1e-12);
    EXPECT_NEAR(row.friction.value, std::tan(Layer::tilt), 1e-12);
    EXPECT_NEAR(row.normal_stress.value, layer.normal(row.z), 1e-12);
    EXPECT_NEAR(row.softness.value, layer.normal(row.z) / 2e4, 1e-15);
    EXPECT_EQ(row.velocity.error, 0.01);
    EXPECT_TRUE(std::isnan(row.temperature.value));
    EXPECT_TRUE(std::isnan(row.effective_samples));
  }
  // Central difference over 2 d between errors of 0.01.
  EXPECT_NEAR(record.data.rows[4].shear_rate.error, std::sqrt(2.0) * 0.01 / 2.0, 1e-12);
}

TEST(Import, SiNumbersGiveTheSameLocalData) {
  const double d = 2e-3, density = 2500.0, g = 9.81;
  const double stress = density * std::numbers::pi / 6.0 * d * g;  // m g / d^2
  const double stiffness = density * std::numbers::pi / 6.0 * d * d * g;
  const std::string si =
      fmt::format("units = \"si\"\ngrains = {{ diameter = {}, density = {} }}\n", d, density);
  const RunRecord grain = WithImport().read(layer_csv());
  const RunRecord record =
      WithImport().read(layer_csv(d, std::sqrt(g * d), stress, stress),
                        si,
                        fmt::format("{}\ngravity = {}", 2e4 * stiffness * d / d, g));
  ASSERT_EQ(record.data.rows.size(), grain.data.rows.size());
  EXPECT_NEAR(record.data.conditions.stiffness / 2e4, 1.0, 1e-12);
  for (std::size_t k = 0; k < grain.data.rows.size(); ++k) {
    const LocalRow& a = record.data.rows[k];
    const LocalRow& b = grain.data.rows[k];
    EXPECT_NEAR(a.z, b.z, 1e-12);
    EXPECT_NEAR(a.velocity.value, b.velocity.value, 1e-11);
    EXPECT_NEAR(a.inertial_number.value, b.inertial_number.value, 1e-12);
    EXPECT_NEAR(a.normal_stress.error, b.normal_stress.error, 1e-12);
  }
}

TEST(Import, EverySignConventionGivesTheSameStresses) {
  const RunRecord plain = WithImport().read(layer_csv());
  const std::string units = "units = \"grain\"\nsigns = ";
  const RunRecord tension = WithImport().read(layer_csv(1, 1, -1, 1), units + "\"tension\"\n");
  const RunRecord compression =
      WithImport().read(layer_csv(1, 1, 1, -1), units + "\"compression\"\n");
  for (const RunRecord* other : {&tension, &compression}) {
    for (std::size_t k = 0; k < plain.data.rows.size(); ++k) {
      EXPECT_EQ(other->data.rows[k].shear_stress.value, plain.data.rows[k].shear_stress.value);
      EXPECT_EQ(other->data.rows[k].normal_stress.value, plain.data.rows[k].normal_stress.value);
    }
  }
}

TEST(Import, ALayerOutOfBalanceIsNotSteadyAndSaysWhy) {
  const RunRecord heavy = WithImport().read(layer_csv(1, 1, 1.3, 1.3));
  EXPECT_EQ(check(heavy, "weight").outcome, CheckOutcome::failed);
  EXPECT_EQ(check(heavy, "friction").outcome, CheckOutcome::passed);
  EXPECT_FALSE(heavy.data.window.steady);
  EXPECT_NE(heavy.data.window.reason.find("off by 30.0 %"), std::string::npos)
      << heavy.data.window.reason;
  const RunRecord wrong_sign = WithImport().read(layer_csv(1, 1, 1, -1));
  EXPECT_EQ(check(wrong_sign, "friction").outcome, CheckOutcome::failed);
  EXPECT_THROW(calibration::fit_bagnold(wrong_sign.data), calibration::FitError);
}

TEST(Import, AveragesAreSteadyOnlyWhereTheirFileSaysSo) {
  const RunRecord record = WithImport().read(layer_csv(), "units = \"grain\"\n", "2e4", "");
  EXPECT_FALSE(record.data.window.steady);
  EXPECT_EQ(check(record, "steadiness").outcome, CheckOutcome::failed);
}

TEST(Import, CheckedDataAreReadBackAsTheyWereStored) {
  const TemporaryDirectory directory;
  const RunRecord record = imported("lammps_chute_kn2e4");
  const auto path = directory.path() / "run.h5";
  write_imported_data(record, path);
  const RunRecord again = read_run(path);
  EXPECT_EQ(digest(again), digest(record));
  EXPECT_EQ(again.imported_from, record.imported_from);
  EXPECT_FALSE(again.data.frames.from_rest);
  ASSERT_EQ(again.checks.size(), record.checks.size());
  for (std::size_t k = 0; k < record.checks.size(); ++k) {
    EXPECT_EQ(again.checks[k].name, record.checks[k].name);
    EXPECT_EQ(again.checks[k].outcome, record.checks[k].outcome);
    EXPECT_EQ(again.checks[k].text, record.checks[k].text);
  }
}

/// Of chute_summary.csv, window of z from 5.5 d: a, b of Brewster et al. (2008), Eq. 9, and the
/// shear rate at mid depth. a and b are nearly degenerate; a + b/rate, the stress over the square
/// of the rate there, is not.
struct Reference {
  const char* run;
  double a, b, rate;
};

TEST(Import, ProfilesOfLammpsAreFittedLikeOurs) {
  for (const Reference& reference : {Reference{"lammps_chute_kn2e4", 40.171, 4.229, 0.3592},
                                     Reference{"lammps_chute_kn2e5", 73.566, 1.992, 0.2924}}) {
    const RunRecord record = imported(reference.run);
    ASSERT_TRUE(record.data.window.steady) << record.data.window.reason;
    const calibration::BagnoldFit fit = calibration::fit_bagnold(record.data);
    const auto& law = std::get<continuum::GeneralisedBagnold>(fit.table.law);
    // 2 % of the stress: what right programs differ by (data/reference/lammps, section 3); the
    // fits of the same profile differ in window and weights only.
    const double expected = reference.a + reference.b / reference.rate;
    EXPECT_NEAR((law.a + law.b / reference.rate) / expected, 1.0, 0.02) << reference.run;
    continuum::ChuteCase chute;
    chute.inclination = record.data.conditions.inclination;
    chute.mass_per_area = record.data.conditions.mass_per_area;
    chute.grains.density = record.data.conditions.grain_density;
    chute.grains.stiffness = record.data.conditions.stiffness;
    const auto predicted = continuum::steady_chute(fit.table, chute);
    ASSERT_FALSE(predicted.profile.rows.empty());
    const auto error = calibration::profile_error(record.data, predicted.profile);
    // u goes with the root of the stress: 2 % of that are 1 % of the velocity; two such.
    EXPECT_LT(error.velocity.value, 0.02) << reference.run;
  }
}

TEST(Import, BlocksOfFixAveChunkBecomeFramesWithOurStatistics) {
  const RunRecord record = imported("lammps_thin_chute_25");
  const dem::LocalData& run = record.data;
  ASSERT_TRUE(run.window.steady) << run.window.reason;
  EXPECT_EQ(run.frames.frames.size(), 60u);
  EXPECT_NEAR(run.frames.frames.front().begin, 0.0, 1e-9);
  EXPECT_NEAR(run.frames.frames.back().end, 300.0, 1e-9);
  EXPECT_GT(run.window.begin, 0.0);  // the start from rest is cut
  for (const ImportCheck& check : record.checks) {
    EXPECT_EQ(check.outcome, CheckOutcome::passed) << check.name << ": " << check.text;
  }
  for (const LocalRow& row : run.rows) {
    EXPECT_GT(row.velocity.error, 0.0);
    EXPECT_GT(row.temperature.value, 0.0);
    EXPECT_GE(row.effective_samples, 1.0);
  }
  const calibration::FlowPoint point = calibration::flow_point(run);
  EXPECT_GE(point.blocks, 4);
  EXPECT_NEAR(point.friction.value, std::tan(point.inclination), 3.0 * point.friction.error);
}

TEST(Import, RunsOfLammpsGiveALawThatInterpolates) {
  const std::vector<dem::LocalData> runs{imported("lammps_thin_chute_24").data,
                                         imported("lammps_thin_chute_26").data};
  const calibration::MuPhiFit fit = calibration::fit_mu_phi(runs);
  const calibration::FlowPoint between =
      calibration::flow_point(imported("lammps_thin_chute_25").data);
  const auto& law = std::get<continuum::MuPhi>(fit.table.law).friction;
  const double excess = std::tan(between.inclination) - law.mu0;
  const double I = excess / law.beta;  // two tilts: no kappa
  // Errors of the law at both ends carry to the middle; 2 % of mu is what is systematic.
  const double error =
      std::hypot(fit.points[0].inertial_number.error, fit.points[1].inertial_number.error) +
      between.inertial_number.error + 0.02 * law.mu0 / law.beta;
  EXPECT_NEAR(I, between.inertial_number.value, 2.0 * error);
}

TEST(Import, MercuryCgOfTheSameBlocksGivesTheSameRows) {
  const TemporaryDirectory directory;
  const RunRecord mercury = imported("mercury_cg");
  ASSERT_EQ(mercury.data.frames.frames.size(), 16u);
  const RunRecord lammps = imported("lammps_thin_chute_24");
  dem::SteadyWindow window = mercury.data.window;
  EXPECT_EQ(check(mercury, "weight").outcome, CheckOutcome::passed);
  EXPECT_EQ(check(mercury, "mass").outcome, CheckOutcome::passed);
  const auto expected = dem::average(lammps.data.frames, lammps.data.conditions, window);
  const auto rows = dem::average(mercury.data.frames, mercury.data.conditions, window);
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    // Numbers of five digits, products of up to three of them; phi from another column.
    const auto same = [&](Estimate LocalRow::*field, double scale) {
      EXPECT_NEAR((rows[k].*field).value, (expected[k].*field).value, 2e-4 * scale) << k;
      EXPECT_NEAR((rows[k].*field).error, (expected[k].*field).error, 2e-4 * scale) << k;
    };
    EXPECT_NEAR(rows[k].z, expected[k].z, 1e-9);
    same(&LocalRow::velocity, 6.0);
    same(&LocalRow::volume_fraction, 1.0);
    same(&LocalRow::shear_stress, 10.0);
    same(&LocalRow::normal_stress, 10.0);
    same(&LocalRow::temperature, 36.0);  // a difference of squares of velocities
  }
}

}  // namespace
}  // namespace grainlaw::io
