// The tables of data/tables give the published numbers, without any run.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "apps/io/rheology_table_toml.h"
#include "continuum/chute_1d.h"
#include "continuum/homogeneous_shear.h"
#include "continuum/shear_band.h"
#include "continuum/split_bottom.h"

namespace grainlaw::io {
namespace {

using namespace continuum;
namespace fs = std::filesystem;

const fs::path folder = fs::path(GRAINLAW_DATA) / "tables";

RheologyTable table(const std::string& name) {
  return read_table(folder / (name + ".toml"));
}

HomogeneousState at(const RheologyTable& table, double Bo, double I = 0.02, double p = 0.01) {
  return homogeneous_shear(table, {I}, {p}, {Bo}).front();
}

/// mu at I = 0.02, p* = 0.01 of Shi et al. 2020, eq. 1A with tables 6 and 7.
TEST(PublishedTables, FrictionFollowsTheAppendixOfShi) {
  struct Row {
    double Bo, mu_0, mu_001, mu_05;
  };
  for (const Row& row : {Row{0, .1582, .1724, .3047},
                         Row{0.1, .1579, .1733, .3043},
                         Row{0.5, .1669, .1919, .3178},
                         Row{1, .1921, .2326, .3523},
                         Row{2, .2718, .3467, .4531},
                         Row{3, .3774, .4875, .5782},
                         Row{5, .6343, .8119, .8625}}) {
    EXPECT_NEAR(*at(table("shi2020_mu_p_0.00"), row.Bo).friction, row.mu_0, 5e-5);
    EXPECT_NEAR(*at(table("shi2020_mu_p_0.01"), row.Bo).friction, row.mu_001, 5e-5);
    EXPECT_NEAR(*at(table("shi2020_mu_p_0.50"), row.Bo).friction, row.mu_05, 5e-5);
  }
}

/// The lines of Fig. 10: eq. 16 with tables 3 and 5, computed apart from this program.
TEST(PublishedTables, VolumeFractionFollowsTheLinesOfShiFigure10) {
  EXPECT_NEAR(*at(table("shi2020_mu_p_0.01"), 2).volume_fraction, 0.683356, 1e-6);
  EXPECT_NEAR(*at(table("shi2020_mu_p_0.01"), 5).volume_fraction, 0.723986, 1e-6);
  EXPECT_NEAR(*at(table("shi2020_mu_p_0.50"), 1).volume_fraction, 0.580961, 1e-6);
  EXPECT_NEAR(*at(table("shi2020_mu_p_0.50"), 5).volume_fraction, 0.647196, 1e-6);
  EXPECT_NEAR(*at(table("shi2020_phi_mu_p_0.05"), 3).volume_fraction, 0.683235, 1e-6);
  EXPECT_NEAR(*at(table("shi2020_phi_mu_p_0.05"), 5).volume_fraction, 0.732517, 1e-6);
  EXPECT_NEAR(*at(table("shi2020_phi_mu_p_1.00"), 0).volume_fraction, 0.600677, 1e-6);
  EXPECT_NEAR(*at(table("shi2020_phi_mu_p_1.00"), 1).volume_fraction, 0.562857, 1e-6);
}

TEST(PublishedTables, AnyContactFrictionFollowsEquation1B) {
  RheologyTable curve = table("shi2020_eq1B");  // at 0.5
  EXPECT_NEAR(*at(curve, 0).volume_fraction, 0.615227, 1e-6);
  EXPECT_NEAR(*at(curve, 2).volume_fraction, 0.583894, 1e-6);
  EXPECT_NEAR(*at(curve, 5).volume_fraction, 0.646148, 1e-6);
}

/// Printed with the wrong sign p4 gives 1.19 at Bo = 5; its neighbours lie at 0.92 and 0.93.
TEST(PublishedTables, TheLostSignOfTable5IsRestored) {
  const auto factor = [](const std::string& name) {
    const auto rigid = [&](double Bo) { return *at(table(name), Bo, 0.0, 0.0).volume_fraction; };
    return rigid(5.0) / rigid(0.0);
  };
  EXPECT_NEAR(factor("shi2020_phi_mu_p_0.05"), 0.9405, 5e-5);
  EXPECT_NEAR(factor("shi2020_mu_p_0.01"), 0.9165, 5e-5);
  EXPECT_NEAR(factor("shi2020_phi_mu_p_0.10"), 0.9343, 5e-5);
}

TEST(PublishedTables, NoFlowFollowsFromVolumeFractionsAlone) {
  for (const char* name : {"shi2020_phi_mu_p_0.30", "shi2020_eq1B"}) {
    const RheologyTable phi_only = table(name);
    EXPECT_FALSE(at(phi_only, 0).friction);
    const ChuteCase chute{.inclination = 0.4, .mass_per_area = 30.0};
    const ShearBandCase band{
        .flow = PlaneShear{.drive = {.stress = 4.0}, .extent = {.height = 20.0}, .load = 10}};
    const SplitBottomCase ring{.split_radius = 40, .depth = 10, .rotation_rate = 0.01};
    EXPECT_THROW(steady_chute(phi_only, chute), TableError);
    EXPECT_THROW(start_from_rest(phi_only, chute), TableError);
    EXPECT_THROW(split_bottom(phi_only, ring), TableError);
    try {
      shear_band(phi_only, band);
      FAIL() << "a flow followed from phi only";
    } catch (const TableError& error) {
      EXPECT_NE(std::string(error.what()).find("phi only"), std::string::npos) << error.what();
    }
  }
}

TEST(PublishedTables, EveryOneStatesItsSourceAndCompleteOnesTheirChecks) {
  int tables = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const RheologyTable read = read_table(entry.path());
    EXPECT_FALSE(read.provenance.source.empty()) << entry.path();
    if (read.has_friction && std::holds_alternative<MuPhi>(read.law)) {
      EXPECT_FALSE(read.provenance.checked_against.empty()) << entry.path();
    }
    ++tables;
  }
  EXPECT_GE(tables, 13);
}

TEST(PublishedTables, ATableOfPhiOnlySurvivesWritingAndReading) {
  const RheologyTable before = table("shi2020_eq1B");
  const RheologyTable after = parse_table(to_toml(before), "again.toml");
  EXPECT_FALSE(after.has_friction);
  ASSERT_EQ(coefficient_names(after), coefficient_names(before));
  for (const std::string& name : coefficient_names(before))
    EXPECT_EQ(coefficient(after, name), coefficient(before, name)) << name;
}

/// A user must see that this row gives twice the velocity of a chute of its own grains.
TEST(PublishedTables, TheFrictionalRowSaysHowFarItIsFromAChute) {
  const auto checks = table("shi2020_mu_p_0.50").provenance.checked_against;
  ASSERT_FALSE(checks.empty());
  EXPECT_NE(checks.front().find("1.90 times"), std::string::npos);
}

TEST(HomogeneousShear, LeavesOutWhatHasLeftPhysics) {
  const RheologyTable frictional = table("shi2020_mu_p_0.50");
  EXPECT_FALSE(at(frictional, 0, 6.0).volume_fraction);  // I_phi = 5.383
  EXPECT_FALSE(at(frictional, 3, 0.02, 0.1).friction);   // f_p < 0 from Bo = 2.9
  EXPECT_TRUE(at(frictional, 2.8, 0.02, 0.1).friction);
  EXPECT_FALSE(at(table("shi2020_mu_p_0.01"), 0, 0.0, 0.146).volume_fraction);  // above 1
  EXPECT_FALSE(at(frictional, 0, 0.3).in_range);
  EXPECT_TRUE(at(frictional, 0, 0.2).in_range);
}

}  // namespace
}  // namespace grainlaw::io
