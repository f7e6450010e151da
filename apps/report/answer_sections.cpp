#include <fmt/format.h>

#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

Html condition_cell(const continuum::Answer& answer) {
  return text(answer.condition_number > 0.0 ? significant(answer.condition_number, 2) : "–");
}

Table answer_table(const Report& report) {
  Table result{.caption = {},
               .head = {"Run"_html,
                        "Steady question"_html,
                        "In time"_html,
                        "In words"_html,
                        "d ln <i>I</i> / d ln <i>μ</i>"_html},
               .rows = {},
               .text_columns = 4};
  for (const RunComparison& run : report.runs) {
    result.rows.push_back(
        {run_label(run),
         text(continuum::name(run.steady.answer.outcome)),
         text(run.transient ? continuum::name(run.transient->answer.outcome) : "–"),
         R"(<span class="prose">)"_html + typeset(run.steady.answer.text) + "</span>"_html,
         condition_cell(run.steady.answer)});
  }
  return result;
}

Table flag_table(const Report& report) {
  Table result{.caption = "Predictions outside the range of the data."_html,
               .head = {"Run"_html,
                        "Quantity"_html,
                        "Range of the data"_html,
                        "Reached"_html,
                        "Flowing mass outside [%]"_html},
               .rows = {},
               .text_columns = 2};
  for (const RunComparison& run : report.runs) {
    for (const continuum::RangeFlag& flag : run.steady.answer.out_of_domain) {
      result.rows.push_back({run_label(run),
                             typeset(flag.quantity),
                             text(interval(flag.lower, flag.upper)),
                             text(interval(flag.reached_lowest, flag.reached_highest)),
                             text(significant(100.0 * flag.fraction_outside, 3))});
    }
  }
  return result;
}

Html definition(const Html& term, const Html& meaning) {
  return "<dt>"_html + term + "</dt><dd>"_html + meaning + "</dd>\n"_html;
}

Html state_definitions() {
  return definition(
      "<i>I</i>, <i>p</i>*, Bo, <i>μ</i>, <i>φ</i>"_html,
      "<i>I</i> = <i>γ̇</i> <i>d</i> √(<i>ρ<sub>p</sub></i>/<i>p</i>), <i>p</i>* = "
      "<i>p</i> <i>d</i>/<i>k<sub>n</sub></i>, Bo = <i>f<sub>a</sub></i>/(<i>p</i> <i>d</i>²) "
      "(Shi et al. 2020, eqs. 10 to 12) with the measured rate, the density of the grains and the "
      "largest attraction <i>f<sub>a</sub></i> of two grains of mean diameter; <i>p</i> is the "
      "stress across the shear, <i>σ<sub>zz</sub></i> in a chute and <i>σ<sub>yy</sub></i> in a "
      "box, <i>μ</i> the shear stress over it, <i>φ</i> the volume fraction. Stress is contact "
      "plus kinetic stress."_html);
}

Html base_definitions() {
  return definition("<i>z</i> = 0"_html,
                    "Plane of the highest base-grain centre plus <i>d</i>/2."_html) +
         definition("No-slip height <i>z</i><sub>0</sub>"_html,
                    "A bumpy base holds <i>u</i> = 0 not at its top but somewhat above. Profiles "
                    "are fitted and predicted with <i>u</i> = 0 there; the mass below it does not "
                    "flow."_html);
}

Html error_definitions() {
  return definition(
             "Relative <i>L</i><sub>2</sub>"_html,
             "√(∫(predicted − measured)² d<i>z</i> / ∫measured² d<i>z</i>) from <i>z</i> = 0, "
             "base layer included, up to where <i>φ</i> falls below half its bulk value; <i>φ</i> "
             "and <i>μ</i> only up to the reach of the kernel below there, as nearer the surface "
             "fields are mixed with the void above. It is never negative, so noise alone makes it "
             "positive: compare with rms / s.e., which is 1 for a perfect prediction."_html) +
         definition("In sample, interpolation, extrapolation"_html,
                    "Tilt fitted; between fitted tilts; outside them. Left out: the law refitted "
                    "without this tilt. Cross geometry: the law comes from another flow. Never "
                    "joined in one number. All runs of a campaign share one seed, so one base and "
                    "one packing."_html) +
         definition("d ln <i>I</i> / d ln <i>μ</i>"_html,
                    "How much an error of the friction grows: at 6, a friction 1 % off gives an "
                    "<i>I</i>, and a velocity, about 6 % off."_html);
}

Html balance_definition() {
  return definition("Predicted <i>μ</i>"_html,
                    "Is tan <i>θ</i> by the balance of forces, whatever the law: its difference "
                    "from the measured one tests the DEM, not the law."_html);
}

Html common_definitions() {
  return definition("± standard error"_html,
                    "One standard error. Measured numbers: block averages over the steady window. "
                    "Coefficients: covariance of the fit. Profile errors: scatter of the DEM "
                    "profile only. Bands: covariance of the law only. All of it is scatter in time "
                    "of one run on one base: another seed, so another base and packing, scatters "
                    "more."_html) +
         definition("Units of the figures"_html,
                    "Lengths in <i>d</i>, times in √(<i>d</i>/<i>g</i>), velocities in "
                    "√(<i>gd</i>). Every figure stands in <code>plots/</code> as CSV, gnuplot "
                    "script and SVG; change the script and run gnuplot on it there."_html);
}

Html guide(const Html& definitions) {
  return section("reading",
                 "How to read this"_html,
                 "<dl>"_html + definitions + common_definitions() + "</dl>\n"_html);
}

}  // namespace

Html answer_section(const Report& report) {
  const Table flags = flag_table(report);
  Html content = table(answer_table(report));
  content += flags.rows.empty()
                 ? paragraph("Every prediction stays inside the range of the data."_html)
                 : table(flags);
  return section("answers", "Answers and range flags"_html, content);
}

Html reading_section(const Report& report) {
  const bool predicted = !report.runs.empty() || !report.flows.empty();
  Html definitions = state_definitions();
  if (!report.runs.empty()) definitions += base_definitions();
  if (predicted) definitions += error_definitions();
  if (!report.runs.empty()) definitions += balance_definition();
  return guide(definitions);
}

Html reading_section(const SeriesReport&) {
  return guide(state_definitions() + base_definitions());
}

}  // namespace grainlaw::report
