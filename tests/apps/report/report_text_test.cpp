#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "apps/report/csv.h"
#include "apps/report/figure.h"
#include "apps/report/html.h"
#include "apps/report/law_curve.h"
#include "apps/report/numbers.h"
#include "apps/report/svg.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

TEST(Numbers, ValueIsCutAtTheSecondDigitOfItsError) {
  EXPECT_EQ(with_error({.value = 0.36718, .error = 0.00213}), "0.3672 ± 0.0021");
  EXPECT_EQ(with_error({.value = 73.566, .error = 6.665}), "73.6 ± 6.7");
  EXPECT_EQ(with_error({.value = 7356.6, .error = 666.5}), "7360 ± 670");
  EXPECT_EQ(with_error({.value = -1.906, .error = 1.308}), "−1.9 ± 1.3");
  EXPECT_EQ(with_error({.value = 0.5, .error = 0.0996}), "0.50 ± 0.10");
  EXPECT_EQ(with_error({.value = 0.002, .error = 12.0}), "0 ± 12");
}

TEST(Numbers, VerySmallAndVeryLargeNumbersShowTheirPowerOfTen) {
  EXPECT_EQ(significant(4.97e-7, 3), "4.97 × 10⁻⁷");
  EXPECT_EQ(significant(6035000.0, 3), "6.04 × 10⁶");
  EXPECT_EQ(with_error({.value = 3.19e-7, .error = 2.4e-8}), "(3.19 ± 0.24) × 10⁻⁷");
  EXPECT_EQ(significant(0.0, 3), "0");
}

TEST(Numbers, ValueAndErrorEndAtTheSameDecimal) {
  EXPECT_EQ(with_error({.value = 0.31, .error = 0.063}), "0.310 ± 0.063");
  EXPECT_EQ(with_error({.value = 1.0, .error = 1.2e-12}), "1.0000000000000 ± 0.0000000000012");
  EXPECT_EQ(with_error({.value = 3.4e6, .error = 1.2e5}), "(3.40 ± 0.12) × 10⁶");
  EXPECT_EQ(with_error({.value = 3.4e-12, .error = 1e-12}), "(3.4 ± 1.0) × 10⁻¹²");
  EXPECT_EQ(with_error({.value = 0.0, .error = 0.02}), "0.000 ± 0.020");
  EXPECT_EQ(with_error({.value = 0.0, .error = 0.0}), "0");
  EXPECT_EQ(with_interval({.value = 0.564, .error = 0.027}, 0.484, 0.651),
            "0.564 ± 0.027 [0.484, 0.651]");
  EXPECT_EQ(with_interval({.value = 0.0, .error = 0.022}, 0.0, 0.0713), "0.000 ± 0.022 [0, 0.071]");
  EXPECT_EQ(with_interval({.value = 0.2, .error = 0.1}, 0.0, INFINITY), "0.20 ± 0.10");
  EXPECT_EQ(interval(-0.00197, 7.99e-5), "−0.00197 to 0.00008");
}

TEST(Numbers, WhatIsNotThereIsADash) {
  EXPECT_EQ(with_error({}), "–");
  EXPECT_EQ(percent({}), "–");
  EXPECT_EQ(significant(NAN), "–");
  EXPECT_EQ(significant(INFINITY), "–");
  EXPECT_EQ(duration(NAN), "–");
  EXPECT_EQ(with_error({.value = 2.5, .error = NAN}), "2.500");
}

TEST(Numbers, DurationsAndAnglesReadAsPeopleSayThem) {
  EXPECT_EQ(duration(0.0384), "38 ms");
  EXPECT_EQ(duration(12.34), "12.3 s");
  EXPECT_EQ(duration(412.0), "6 min 52 s");
  EXPECT_EQ(duration(7500.0), "2 h 05 min");
  EXPECT_EQ(degrees(24.8 * M_PI / 180.0), "24.8°");
  EXPECT_EQ(count(6035000.0), "6\u202f035\u202f000");
}

TEST(Typeset, SentencesOfTheProgramReadAsInPrint) {
  const auto of = [](const char* plain) { return typeset(plain).markup; };
  EXPECT_EQ(of("mu0 + beta I^n"), "<i>μ</i><sub>0</sub> + <i>β</i> <i>I</i><sup>n</sup>");
  EXPECT_EQ(of("Bo^beta p*^g"), "Bo<sup><i>β</i></sup> <i>p</i>*<sup>g</sup>");
  EXPECT_EQ(of("1.2e-06 +- 3e-07"), "1.2 × 10⁻⁶ ± 3 × 10⁻⁷");
  EXPECT_EQ(of("z = -0.5 to 0.5"), "<i>z</i> = −0.5 to 0.5");
  EXPECT_EQ(of("at 23 deg"), "at 23°");
  EXPECT_EQ(of("a < b & tau_c"), "a &lt; b &amp; <i>τ<sub>c</sub></i>");
}

TEST(Typeset, NamesOfRunsAndFilesStayAsTheyAre) {
  for (const char* name : {"mu0.5_I0.02_p0.01", "hooke_kn2e5", "shi2020_mu_p_0.50"})
    EXPECT_EQ(typeset(name).markup, code(name).markup);
  EXPECT_EQ(code("a_b").markup, "<code>a_<wbr/>b</code>");
  for (const char* name : {"table.toml", "runs/theta24.h5"}) EXPECT_EQ(typeset(name).markup, name);
}

TEST(Typeset, PowersOfTenAndRatiosOfSymbols) {
  const auto of = [](const char* plain) { return typeset(plain).markup; };
  EXPECT_EQ(of("k_n = 2e5"), "<i>k<sub>n</sub></i> = 2 × 10⁵");
  EXPECT_EQ(of("rtol 1e-06"), "rtol 10⁻⁶");
  EXPECT_EQ(of("(3.19 +- 0.24)e-07"), "(3.19 ± 0.24) × 10⁻⁷");
  EXPECT_EQ(of("R_c/R_s."), "<i>R<sub>c</sub></i>/<i>R<sub>s</sub></i>.");
  EXPECT_EQ(of("5 us"), "5 µs");
  EXPECT_EQ(plot_symbol(typeset("k_n of kn2e5_theta23")), "{/:Italic k_{n}} of kn2e5\\_theta23");
}

TEST(Typeset, SymbolsBecomeEnhancedTextOfGnuplot) {
  EXPECT_EQ(plot_symbol({"<i>I<sub>φ</sub></i>"}), "{/:Italic I_{φ}}");
}

TEST(Csv, NumbersThatAreNotThereAreEmptyFields) {
  const Csv csv{.columns = {"z [d]", "u"}, .rows = {{0.5, NAN}, {1.5, 0.25}}};
  EXPECT_EQ(csv.text(), "z [d],u\n0.5,\n1.5,0.25\n");
}

TEST(Figure, NamesOfRunsBecomeSafeFileNamesAndPlotText) {
  RunComparison run;
  run.data.name = "../a b'c\"<&";
  EXPECT_EQ(file_stem(run, 3), "3_a_b_c");
  const std::string shown = plot_text("a'b\"c\\d{e}^f@g\n%");
  EXPECT_EQ(shown.find_first_of("'\"\\{}^@\n%"), std::string::npos);
  EXPECT_EQ(plot_text("kn2e5_theta23, fitted"), "kn2e5\\_theta23, fitted");
}

double channel(double value) {
  return value <= 0.03928 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

/// Relative luminance as in the Web Content Accessibility Guidelines 2.1.
double luminance(std::string_view hex) {
  const auto part = [&](std::size_t at) {
    return channel(std::stoi(std::string(hex.substr(at, 2)), nullptr, 16) / 255.0);
  };
  return 0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5);
}

double contrast(std::string_view first, std::string_view second) {
  const double a = luminance(first);
  const double b = luminance(second);
  return (std::max(a, b) + 0.05) / (std::min(a, b) + 0.05);
}

TEST(Figure, SeriesColoursStandOutOnLightAndOnDarkPages) {
  // 3:1 is what the guidelines ask of graphical objects.
  for (const auto colour : {colour::measured, colour::predicted, colour::third, colour::fourth}) {
    EXPECT_GE(contrast(colour, "#ffffff"), 3.0) << colour;
    EXPECT_GE(contrast(colour, "#15171a"), 3.0) << colour;
  }
}

TEST(Svg, IdsArePrefixedAndBlackFollowsThePage) {
  const std::string drawn = R"(<?xml version="1.0"?>
<svg
 viewBox="0 0 360 300"
 xmlns="http://www.w3.org/2000/svg">
<path id='p' stroke='black' fill='rgb(  0,   0,   0)'/><use xlink:href='#p' color="black"/>
</svg>)";
  const std::string svg = inline_svg(drawn, "one", "a \"label\" of $1");
  EXPECT_NE(svg.find(R"(id="one-p")"), std::string::npos);
  EXPECT_NE(svg.find(R"(href="#one-p")"), std::string::npos);
  EXPECT_NE(svg.find(R"(aria-label="a &quot;label&quot; of $1")"), std::string::npos);
  EXPECT_EQ(svg.find("black"), std::string::npos);
  EXPECT_EQ(svg.find("xmlns"), std::string::npos);
  EXPECT_EQ(inline_svg("no picture", "one", "label"), "");
}

continuum::RheologyTable linear_table() {
  continuum::RheologyTable table;
  continuum::MuPhi law;
  law.friction = {.mu0 = 0.36, .beta = 0.6, .kappa = 0.0};
  law.volume_fraction = {.phi0 = 0.6, .I_phi = 3.0};
  table.law = law;
  table.covariance =
      continuum::Covariance{.names = {"mu0", "beta"}, .matrix = {4e-6, -6e-6, -6e-6, 9e-5}};
  return table;
}

TEST(LawCurve, BandOfALinearLawIsTheClosedForm) {
  // mu = mu0 + beta I is linear in its coefficients: var = v00 + 2 I v01 + I^2 v11. The difference
  // quotient of a linear function is exact but for rounding, about 1e-16 / (0.01 * 2e-3).
  for (const LawPoint& point : law_curve(linear_table(), {.lower = 0.0, .upper = 0.4}, 0.0, 5)) {
    const double I = point.inertial_number;
    EXPECT_DOUBLE_EQ(point.friction.value, 0.36 + 0.6 * I);
    EXPECT_NEAR(point.friction.error, std::sqrt(4e-6 - 12e-6 * I + 9e-5 * I * I), 1e-12);
    EXPECT_EQ(point.volume_fraction.error, 0.0);
  }
}

TEST(LawCurve, InertialNumberAtATiltInvertsTheFriction) {
  const dem::Estimate I = inertial_number_at(linear_table(), std::atan(0.48), 0.0);
  EXPECT_NEAR(I.value, 0.2, 1e-15);
  EXPECT_TRUE(std::isnan(inertial_number_at(linear_table(), std::atan(0.3), 0.0).value));
}

}  // namespace
}  // namespace grainlaw::report
