#include "calibration/contact_friction_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/calibration_checks.h"

namespace grainlaw::calibration {
namespace {

using testing::failure;

// Shi et al. 2020, tables 3 and 5, simple shear rows; p4 at mu_p = 0.05 with the sign that was lost
// in print (positive it would give phi = 0.93 at Bo = 5).
const std::vector<double> contact_frictions{0, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 0.9, 1};
const std::vector<double> phi0{
    0.656, 0.653, 0.643, 0.634, 0.619, 0.610, 0.603, 0.595, 0.591, 0.585, 0.583};
const std::vector<double> I_phi{
    1.960, 2.246, 3.171, 3.959, 4.806, 5.166, 5.319, 5.383, 5.422, 5.429, 5.430};
const std::vector<double> p1{-0.0175,
                             -0.0237,
                             -0.0394,
                             -0.0564,
                             -0.0845,
                             -0.1091,
                             -0.1195,
                             -0.1359,
                             -0.1516,
                             -0.1494,
                             -0.1511};
const std::vector<double> p2{
    -0.0060, -0.0056, 0.0030, 0.0134, 0.0310, 0.0480, 0.0542, 0.0668, 0.0779, 0.0733, 0.0746};
const std::vector<double> p3{
    0.0029, 0.0034, 0.0015, -0.0011, -0.0058, -0.0107, -0.0125, -0.0162, -0.0195, -0.0176, -0.0181};
const std::vector<double> p4{
    -0.0003, -0.0004, -0.0002, 0.00003, 0.0005, 0.0010, 0.0011, 0.0015, 0.0018, 0.0016, 0.0017};

FrictionDependence fit_column(const std::vector<double>& values) {
  std::vector<dem::Estimate> estimates;
  for (const double value : values) estimates.push_back({value, 0.0});
  return fit_friction_dependence(contact_frictions, estimates);
}

/// `digits`: half a unit in the last place of the table. Rounding of 11 rows moves the RMS over 8
/// degrees of freedom by digits/sqrt(3 * 8) at one standard deviation; its own print by 5e-6.
void expect_row(const std::vector<double>& values,
                const std::array<double, 3>& printed,
                double rms,
                double digits) {
  const FrictionDependence fit = fit_column(values);
  EXPECT_NEAR(fit.at_infinity, printed[0], digits + 2.0 * fit.summary["Q_inf"].error);
  EXPECT_NEAR(fit.at_zero, printed[1], digits + 2.0 * fit.summary["Q_0"].error);
  EXPECT_NEAR(fit.scale, printed[2], 2.0 * fit.summary["mu_p0"].error);
  EXPECT_NEAR(fit.rms, rms, 5e-6 + 3.0 * digits / std::sqrt(24.0));
}

TEST(ContactFrictionFit, PolynomialRowsOfTableEightFollowFromTableFive) {
  // Shi et al. 2020, table 8; the RMS they print is that over n - 3 degrees of freedom.
  expect_row(p1, {-0.1588, -0.0174, 0.2952}, 0.00321, 5e-5);
  expect_row(p2, {0.0816, -0.0088, 0.3159}, 0.00355, 5e-5);
  expect_row(p3, {-0.0204, 0.0042, 0.3355}, 0.00130, 5e-5);
  expect_row(p4, {0.0019, -0.0004, 0.3489}, 0.00014, 5e-5);
}

TEST(ContactFrictionFit, DensestPackingOfTableEightDoesNotFollowFromTableThree) {
  // Printed: Q_inf 0.5854, mu_p0 0.2756, RMS 0.00058. Rows 0.9 and 1.0 lie 0.003 and 0.004 below.
  const FrictionDependence fit = fit_column(phi0);
  EXPECT_NEAR(fit.at_infinity, 0.5813, 5e-5);
  EXPECT_NEAR(fit.at_zero, 0.6550, 5e-5);
  EXPECT_NEAR(fit.scale, 0.311, 5e-4);
  EXPECT_GT(fit.rms, 2.0 * 0.00058);
  const FrictionDependence rounded = fit_column(I_phi);
  EXPECT_NEAR(rounded.scale, 0.1166, 1e-3);
  EXPECT_LT(rounded.rms, 1e-3);  // three decimals
}

TEST(ContactFrictionFit, ExactCurveIsRecoveredAndInterpolationCostsNothing) {
  std::vector<double> values;
  for (const double mu_p : contact_frictions) values.push_back(0.58 + 0.07 * std::exp(-mu_p / 0.3));
  const FrictionDependence fit = fit_column(values);
  EXPECT_NEAR(fit.at_infinity, 0.58, 1e-9);
  EXPECT_NEAR(fit.at_zero, 0.65, 1e-9);
  EXPECT_NEAR(fit.scale, 0.3, 1e-8);
  EXPECT_NEAR(fit(0.25), 0.58 + 0.07 * std::exp(-0.25 / 0.3), 1e-9);
  EXPECT_LT(fit.interpolation_error, 1e-9);
}

TEST(ContactFrictionFit, TableInBetweenCarriesTheErrorOfInterpolation) {
  std::vector<continuum::RheologyTable> tables;
  for (std::size_t i = 0; i < phi0.size(); ++i) {
    continuum::MuPhi law;
    law.friction = {.mu0 = 0.14 + 0.22 * (1.0 - std::exp(-contact_frictions[i] / 0.2)),
                    .beta = 2.0 - 1.5 * (1.0 - std::exp(-contact_frictions[i] / 0.1))};
    law.volume_fraction = {.phi0 = phi0[i], .I_phi = I_phi[i]};
    continuum::RheologyTable table;
    table.law = law;
    table.contact_friction = contact_frictions[i];
    tables.push_back(table);
  }
  const auto curves = fit_friction_dependences(tables);
  EXPECT_TRUE(curves.left_out.empty());
  EXPECT_EQ(curves.constants.at("kappa"), 0.0);  // zero everywhere: no curve is needed
  const auto between = interpolate(curves, tables[0], 0.15);
  EXPECT_NEAR(continuum::coefficient(between, "mu0"), 0.14 + 0.22 * (1.0 - std::exp(-0.75)), 1e-8);
  EXPECT_EQ(continuum::coefficient(between, "kappa"), 0.0);
  const FrictionDependence& dense = curves.coefficients.at("phi0");
  EXPECT_GE(dense.interpolation_error, 0.001);
  EXPECT_LT(dense.interpolation_error, 0.005);
}

/// Five tables of phi, two of which state a friction law as well.
std::vector<continuum::RheologyTable> mostly_of_phi_only() {
  std::vector<continuum::RheologyTable> tables(5);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    continuum::MuPhi law;
    law.friction = {.mu0 = 0.3, .beta = 1.0};
    law.volume_fraction = {.phi0 = phi0[2 * i], .I_phi = I_phi[2 * i]};
    tables[i].law = law;
    tables[i].contact_friction = contact_frictions[2 * i];
    tables[i].has_friction = i < 2;
  }
  return tables;
}

TEST(ContactFrictionFit, CoefficientFollowsFromTheTablesThatStateIt) {
  const auto tables = mostly_of_phi_only();
  const auto curves = fit_friction_dependences(tables);
  EXPECT_EQ(curves.coefficients.at("phi0").deviation.size(), tables.size());
  EXPECT_TRUE(testing::mentions(curves.left_out, "mu0, beta, kappa: stated by 2 of 5 tables"));
  const auto between = interpolate(curves, tables.back(), 0.25);
  EXPECT_FALSE(between.has_friction);
  EXPECT_NE(failure([&] { interpolate(curves, tables.front(), 0.25); }).find("mu0"),
            std::string::npos);
}

TEST(ContactFrictionFit, ThreeTablesAreTooFew) {
  EXPECT_NE(failure([] {
              fit_friction_dependence({0, 0.1, 1}, {{1, 0}, {2, 0}, {3, 0}});
            }).find("4 different mu_p"),
            std::string::npos);
}

}  // namespace
}  // namespace grainlaw::calibration
