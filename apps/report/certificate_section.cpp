#include <cmath>

#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "continuum/well_posedness.h"

namespace grainlaw::report {
namespace {

std::string interval_text(const continuum::Range& range) {
  if (range.lower == 0.0 && std::isinf(range.upper)) return "all";
  if (range.lower == 0.0) return "up to " + significant(range.upper);
  if (std::isinf(range.upper)) return "from " + significant(range.lower);
  return interval(range.lower, range.upper);
}

Html intervals_cell(const std::vector<continuum::Range>& intervals) {
  std::string words;
  for (const continuum::Range& range : intervals)
    words += (words.empty() ? "" : ", ") + interval_text(range);
  return text(words.empty() ? "nowhere" : words);
}

Table interval_table(const Report& report) {
  Table result{.caption = "Where the law is well-posed in two and three dimensions."_html,
               .head = {"<i>p</i>*"_html, "Bo"_html, "<i>I</i>"_html},
               .rows = {},
               .text_columns = 0};
  for (const auto& at : continuum::well_posedness_map(report.table)) {
    result.rows.push_back({text(at.softness == 0.0 ? "0 (rigid)" : significant(at.softness)),
                           text(significant(at.bond_number)),
                           intervals_cell(at.intervals)});
  }
  return result;
}

/// The tail of a normal distribution means nothing as far out as 1e-100.
std::string probability_text(double probability) {
  return probability < 1e-6 ? "< 10⁻⁶" : significant(probability, 2);
}

std::vector<Html> state_row(const RunComparison& run, const continuum::CertifiedState& state) {
  const auto& found = state.well_posedness;
  const auto& probability = state.ill_posed_probability;
  return {
      run_label(run),
      text(significant(state.at.inertial_number)),
      text(significant(state.at.softness, 2)),
      text(significant(state.at.bond_number, 2)),
      text(state.margin_error ? with_error({.value = found.margin, .error = *state.margin_error})
                              : significant(found.margin)),
      text(significant(found.direction)),
      text(probability ? probability_text(*probability) : "–"),
      text(found.holds() ? "yes" : "no")};
}

/// States of a chute: one I, at the base, and without cohesion at the surface too; cohesive grains
/// have a plug there, and Bo has no bound.
std::vector<continuum::FlowState> states_of(const RunComparison& run) {
  const auto& grains = run.data.conditions;
  const double I = run.point->inertial_number.value;
  if (!(grains.attraction > 0.0))
    return {{I, run.point->softness_upper, 0.0}, {I, run.point->softness_lower, 0.0}};
  const double pressure = grains.gravity * std::cos(grains.inclination) * grains.mass_per_area;
  const double bond_number =
      grains.attraction / (pressure * grains.grain_diameter * grains.grain_diameter);
  return {{I, run.point->softness_upper, bond_number}};
}

Table state_table(const Report& report) {
  Table result{.caption =
                   "The margin <i>F</i> at each data point: at the base of each chute and, "
                   "without cohesion, at its surface."_html,
               .head = {"Run"_html,
                        "<i>I</i>"_html,
                        "<i>p</i>*"_html,
                        "Bo"_html,
                        "<i>F</i>"_html,
                        "Worst direction <i>a</i>"_html,
                        "P[<i>F</i> &lt; 0]"_html,
                        "Well-posed"_html},
               .rows = {},
               .text_columns = 1};
  for (const RunComparison& run : report.runs) {
    if (!run.point) continue;
    for (const continuum::FlowState& at : states_of(run)) {
      const auto state = continuum::certify(report.table, at);
      if (state) result.rows.push_back(state_row(run, *state));
    }
  }
  return result;
}

}  // namespace

Html certificate_section(const Report& report) {
  Html content = paragraph(
      "Short waves in plane shear grow without bound where <i>F</i> &lt; 0, the least over "
      "directions <i>a</i> of <i>q</i> − <i>ra</i> + (1 − <i>q</i>)<i>a</i>² with <i>q</i> = "
      "d ln <i>τ</i>/d ln <i>γ̇</i> and <i>r</i> = d<i>τ</i>/d<i>p</i>; for <i>μ</i>(<i>I</i>) "
      "this is the condition of Barker et al. 2015. A two- or three-dimensional code must not use "
      "the law there. The one-dimensional predictions of this report need only <i>q</i> &gt; 0."_html);
  content += table(interval_table(report));
  const bool of_inertial_number = std::holds_alternative<continuum::MuPhi>(report.table.law);
  const Table states = state_table(report);
  if (of_inertial_number && !states.rows.empty()) content += table(states);
  return section("certificate", "Well-posedness"_html, content);
}

}  // namespace grainlaw::report
