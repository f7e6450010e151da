#include <fmt/format.h>

#include <cmath>

#include "apps/report/law_curve.h"
#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

using calibration::FitSummary;

/// Value and error of a coefficient; a dagger marks one that the data push against its bound.
Html value_cell(const FitSummary& fit, std::string_view name) {
  for (const calibration::FittedCoefficient& coefficient : fit.coefficients) {
    if (coefficient.name != name) continue;
    const std::string number = with_error({.value = coefficient.value, .error = coefficient.error});
    return text(coefficient.at_bound ? number + " †" : number);
  }
  return text("–");
}

/// p* in the middle of the measured rows.
double middle_softness(const dem::LocalData& data) {
  const double softness = data.rows.empty() ? NAN : data.rows[data.rows.size() / 2].softness.value;
  return std::isfinite(softness) ? softness : 0.0;
}

/// a(theta) = rho_p d^2 tan(theta) / I(theta)^2 that mu(I) implies, with the error of the law.
dem::Estimate implied_a(const Report& report, const dem::LocalData& data) {
  const dem::ChuteConditions& chute = data.conditions;
  const dem::Estimate I =
      inertial_number_at(report.table, chute.inclination, middle_softness(data));
  const double scale = chute.grain_density * chute.grain_diameter * chute.grain_diameter;
  const double a = scale * std::tan(chute.inclination) / (I.value * I.value);
  return {.value = a, .error = 2.0 * a * I.error / I.value};
}

Html error_cell(const std::optional<calibration::ProfileError>& error) {
  return text(error ? percent_value(error->velocity) : "–");
}

std::vector<Html> free_row(const Report& report, const RunComparison& run) {
  const calibration::BagnoldFit& fit = *run.own_bagnold;
  return {run_label(run),
          text("free"),
          value_cell(fit.summary, "a"),
          value_cell(fit.summary, "b"),
          text(with_error(fit.ratio_mid_depth)),
          value_cell(fit.summary, "no_slip_height"),
          text(with_error(implied_a(report, run.data))),
          error_cell(run.own_bagnold_error),
          error_cell(run.foreign_bagnold_error),
          text(run.foreign_bagnold_source.empty() ? "–" : run.foreign_bagnold_source)};
}

std::vector<Html> fixed_row(const calibration::BagnoldFit& fit) {
  return {Html{},
          text("fixed at 0"),
          value_cell(fit.fixed_base_summary, "a"),
          value_cell(fit.fixed_base_summary, "b"),
          text(with_error(fit.ratio_mid_depth_fixed)),
          text("0"),
          Html{},
          Html{},
          Html{},
          Html{}};
}

Html unit(const std::string& name, const std::string& units) {
  return text(" [" + coefficient_unit(name, units) + "]");
}

Table bagnold_table(const Report& report, const std::string& units) {
  const Html a = "<i>a</i>"_html;
  Table result{.caption =
                   "Closure (A), <i>τ</i> − <i>τ<sub>c</sub></i> = <i>a</i> <i>γ̇</i>² + <i>b</i> "
                   "<i>γ̇</i>, fitted to every run by itself. Errors of <i>u</i>: relative "
                   "<i>L</i><sub>2</sub>, in %. † at its bound, error one-sided."_html,
               .head = {"Run"_html,
                        "<i>z</i><sub>0</sub>"_html,
                        a + unit("a", units),
                        "<i>b</i>"_html + unit("b", units),
                        "<i>Ξ</i> at half depth"_html,
                        "<i>z</i><sub>0</sub> [<i>d</i>]"_html,
                        a + " of <i>μ</i>(<i>I</i>)"_html,
                        "Error at own tilt"_html,
                        "Error with <i>a</i>, <i>b</i> of another tilt"_html,
                        "taken from"_html},
               .rows = {},
               .text_columns = 2};
  for (const RunComparison& run : report.runs) {
    if (!run.own_bagnold) continue;
    result.rows.push_back(free_row(report, run));
    result.rows.push_back(fixed_row(*run.own_bagnold));
  }
  return result;
}

/// Value, error and 95 % interval.
Html interval_cell(const calibration::FittedCoefficient& c) {
  return text(
      with_interval({.value = c.value, .error = c.error}, c.interval.lower, c.interval.upper));
}

Table variant_table(const Report& report) {
  Table result{.caption =
                   "The same law from part of the data: where <i>a</i>, <i>b</i> and <i>Ξ</i> "
                   "come from. Brackets: 95 %."_html,
               .head = {"Run"_html,
                        "Data"_html,
                        "<i>z</i><sub>0</sub>"_html,
                        "<i>a</i>"_html,
                        "<i>b</i>"_html,
                        "<i>τ<sub>c</sub></i>"_html,
                        "<i>Ξ</i>(<i>h</i>/4)"_html,
                        "<i>Ξ</i>(<i>h</i>/2)"_html,
                        "<i>Ξ</i>(3<i>h</i>/4)"_html},
               .rows = {},
               .text_columns = 3};
  for (const RunComparison& run : report.runs) {
    if (!run.own_bagnold) continue;
    for (const calibration::BagnoldVariant& variant : run.own_bagnold->variants) {
      const bool first = &variant == &run.own_bagnold->variants.front();
      const bool pairs = variant.data == "pairs";
      std::vector<Html> cells = {first ? run_label(run) : Html{},
                                 text(variant.data),
                                 text(pairs ? "–" : (variant.free_base ? "free" : "fixed at 0")),
                                 value_cell(variant.summary, "a"),
                                 value_cell(variant.summary, "b"),
                                 value_cell(variant.summary, "tau_c")};
      for (const calibration::FittedCoefficient& ratio : variant.ratios) {
        cells.push_back(interval_cell(ratio));
      }
      result.rows.push_back(std::move(cells));
    }
  }
  return result;
}

Html remarks(const Report& report) {
  std::vector<Html> items;
  for (const RunComparison& run : report.runs) {
    if (!run.own_bagnold) continue;
    const FitSummary& fit = run.own_bagnold->summary;
    for (const auto* sentences : {&fit.not_identifiable, &fit.notes}) {
      for (const std::string& sentence : *sentences) {
        const bool named = sentence.starts_with(run.data.name);
        items.push_back(named ? typeset(sentence) : run_label(run) + ": "_html + typeset(sentence));
      }
    }
  }
  return items.empty() ? Html{} : list(items);
}

}  // namespace

Html bagnold_section(const Report& report) {
  std::string units = report.table.units;
  for (const RunComparison& run : report.runs) {
    if (run.own_bagnold) units = run.own_bagnold->table.units;
  }
  const Table numbers = bagnold_table(report, units);
  const Html content =
      numbers.rows.empty()
          ? paragraph("No run was steady enough to fit it."_html)
          : paragraph(
                "Brewster et al. (2008), eq. 1. A <i>μ</i>(<i>I</i>) material on a slope has "
                "<i>a</i>(<i>θ</i>) = <i>ρ<sub>p</sub></i><i>d</i>² tan <i>θ</i> / "
                "<i>I</i>(<i>θ</i>)²: <i>a</i> belongs to a tilt, it is no constant of the "
                "grains. <i>Ξ</i> = <i>b</i>/(<i>a</i><i>γ̇</i>) (their eq. 10) depends on where "
                "<i>u</i> = 0 is put, so it stands here with the no-slip height free and "
                "fixed."_html) +
                table(numbers) + table(variant_table(report)) + remarks(report);
  return section("bagnold", "Generalised Bagnold law, tilt by tilt"_html, content);
}

}  // namespace grainlaw::report
