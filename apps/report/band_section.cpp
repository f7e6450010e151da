#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "apps/report/numbers.h"
#include "apps/report/ring_section.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

using calibration::LawResidual;
using calibration::StateComparison;

std::string in_words(std::string geometry) {
  std::ranges::replace(geometry, '_', ' ');
  return geometry;
}

/// What the numbers in figures and tables stand for.
Html table_numbers(const Report& report) {
  if (report.tables.size() < 2) return {};
  std::vector<Html> parts;
  for (std::size_t t = 0; t < report.tables.size(); ++t)
    parts.push_back(text(fmt::format("{}: ", t + 1)) + code(report.tables[t].name));
  return paragraph("Tables by number: "_html + join(parts, ", "_html) + "."_html);
}

Html table_title(const Report& report, std::size_t t) {
  return report.tables.size() > 1 ? code(report.tables[t].name) + ": "_html : Html{};
}

/// The quantities that have left the data of the table.
Html flags_text(const std::vector<continuum::RangeFlag>& flags) {
  std::string result;
  for (const continuum::RangeFlag& flag : flags)
    result += (result.empty() ? "" : ", ") + flag.quantity;
  return typeset(result.empty() ? "inside" : result);
}

/// The data of the table for each quantity that any state has left.
std::string left_ranges(const Report& report, std::size_t t) {
  std::map<std::string, std::string> ranges;
  for (const FlowComparison& flow : report.flows) {
    for (const StateComparison& state : flow.tables[t].states) {
      for (const continuum::RangeFlag& flag : state.out_of_domain)
        ranges[flag.quantity] = interval(flag.lower, flag.upper);
    }
  }
  std::string words;
  for (const auto& [quantity, range] : ranges)
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", quantity, range);
  return words.empty() ? words : fmt::format(" Range: what lies outside the data ({}).", words);
}

std::vector<Html> residual_cells(const dem::Estimate& measured, const LawResidual& residual) {
  return {text(with_error(measured)),
          text(with_error(residual.law)),
          text(significant(100.0 * residual.difference, 2)),
          text(significant(residual.in_standard_errors, 2))};
}

std::vector<Html> state_row(const StateComparison& state) {
  std::vector<Html> row = {code(state.point.name),
                           text(significant(state.point.inertial_number.value, 3)),
                           text(significant(state.point.softness.value, 2)),
                           text(significant(state.point.bond_number.value, 2))};
  const auto add = [&](std::vector<Html> cells) {
    row.insert(row.end(), cells.begin(), cells.end());
  };
  add(residual_cells(state.point.friction, state.friction));
  add(residual_cells(state.point.volume_fraction, state.volume_fraction));
  row.push_back(text(significant(state.condition_number, 2)));
  row.push_back(flags_text(state.out_of_domain));
  return row;
}

/// One line per state; the rows of a heading are those of one run.
Table state_table(const Report& report, std::size_t t) {
  Table result{
      .caption =
          table_title(report, t) +
          "The law at measured states of flow. Off: law / measured − 1. In standard "
          "errors: of the DEM (also through <i>I</i> and <i>p</i>*) and of the "
          "table together. <i>p</i> is <i>σ<sub>yy</sub></i> or <i>σ<sub>zz</sub></i>, in a ring "
          "cell a third of the trace."_html +
          typeset(left_ranges(report, t)),
      .head = {"State"_html,
               "<i>I</i>"_html,
               "<i>p</i>*"_html,
               "Bo"_html,
               "<i>μ</i>, DEM"_html,
               "law"_html,
               "off [%]"_html,
               "in s.e."_html,
               "<i>φ</i>, DEM"_html,
               "law"_html,
               "off [%]"_html,
               "in s.e."_html,
               "d ln <i>I</i>/d ln <i>μ</i>"_html,
               "Range"_html},
      .rows = {},
      .text_columns = 1};
  for (const FlowComparison& flow : report.flows) {
    const FlowPrediction& prediction = flow.tables[t];
    if (prediction.states.empty()) continue;
    if (prediction.states.size() > 1)
      result.rows.push_back(
          {code(flow.data.name) + text(fmt::format(", {} ({})",
                                                   in_words(flow.data.conditions.geometry),
                                                   calibration::name(prediction.kind)))});
    for (const StateComparison& state : prediction.states) result.rows.push_back(state_row(state));
  }
  return result;
}

std::vector<Html> band_row(const std::string& law,
                           const BandPrediction& prediction,
                           double length) {
  const continuum::ShearBand& band = prediction.band;
  std::string outcome(continuum::name(band.answer.outcome));
  if (band.local_band_collapse) outcome += ", LOCAL_BAND_COLLAPSE";
  std::vector<Html> row = {text(law), text(outcome)};
  if (!prediction.comparison) {
    row.resize(11, text("–"));
    return row;
  }
  const calibration::BandComparison& c = *prediction.comparison;
  for (const std::string& cell : {percent_value(c.profile.velocity),
                                  percent_value(c.profile.velocity_maximum),
                                  percent_value(c.profile.volume_fraction),
                                  percent_value(c.profile.friction),
                                  percent_value(c.drive_difference),
                                  with_error(scaled(c.width, 1.0 / length)),
                                  significant(band.band_width / length, 3),
                                  fmt::format("{} / {}",
                                              significant(c.height / length, 3),
                                              significant(band.profile.height / length, 3)),
                                  c.no_slip ? fmt::format("{} / {}",
                                                          significant(c.no_slip->lower / length, 2),
                                                          significant(c.no_slip->upper / length, 2))
                                            : std::string("–")})
    row.push_back(text(cell));
  return row;
}

Table band_table(const Report& report) {
  Table result{
      .caption =
          "Shear bands. Drive: the shear stress on a wall of given speed, the largest "
          "velocity in a box. Width: what takes 90 % of the velocity. No-slip heights: "
          "above the lower and below the upper end of the layer, fitted; a dash: farther than "
          "2 <i>d</i>, then the shape itself is off."_html,
      .head = {"Law"_html,
               "Answer"_html,
               "<i>u</i>, <i>L</i><sub>2</sub> [%]"_html,
               "<i>u</i>, largest [%]"_html,
               "<i>φ</i>, <i>L</i><sub>2</sub> [%]"_html,
               "<i>μ</i>, <i>L</i><sub>2</sub> [%]"_html,
               "drive off [%]"_html,
               "width, DEM [<i>d</i>]"_html,
               "width, law [<i>d</i>]"_html,
               "extent, DEM / law [<i>d</i>]"_html,
               "no-slip heights [<i>d</i>]"_html},
      .rows = {},
      .text_columns = 2};
  for (const FlowComparison& flow : report.flows) {
    if (flow.tables.empty() || !flow.tables.front().local) continue;
    const double d = flow.data.conditions.grain_diameter;
    result.rows.push_back({code(flow.data.name) +
                           text(fmt::format(", {}{}",
                                            in_words(flow.data.conditions.geometry),
                                            flow.data.window.steady ? "" : ", DEM not steady"))});
    for (std::size_t t = 0; t < flow.tables.size(); ++t) {
      const std::string name = report.tables.size() > 1 ? fmt::format("{} ", t + 1) : "";
      result.rows.push_back(band_row(name + "local", *flow.tables[t].local, d));
      if (flow.tables[t].nonlocal)
        result.rows.push_back(band_row(name + "nonlocal", *flow.tables[t].nonlocal, d));
    }
  }
  return result;
}

Html nonlocal_sentence(const Report& report) {
  if (!report.nonlocal) return {};
  const NonlocalAmplitude& fit = *report.nonlocal;
  if (fit.run.empty())
    return paragraph(text(fmt::format("Nonlocal amplitude A = {:.4g}, as given.", fit.value)));
  return paragraph(text(fmt::format(
      "Nonlocal amplitude A = {}, fitted to the velocities of {} alone ({} points: χ² = {}, with "
      "the local law {}); the other flows test it.",
      with_error({.value = fit.value, .error = fit.error}),
      fit.run,
      fit.points,
      significant(fit.chi_squared, 3),
      significant(fit.local_chi_squared, 3))));
}

/// Cells of one score in the table of kinds.
std::vector<Html> score_row(const Score& score) {
  std::vector<Html> row = {
      code(score.run),
      text(in_words(score.flow)),
      typeset(score.quantity),
      text(percent_value(score.difference)),
      text(significant(score.in_standard_errors, 2)),
      text(score.condition_number > 0.0 ? significant(score.condition_number, 2) : "–")};
  if (score.budget) {
    const calibration::ErrorBudget& part = *score.budget;
    for (const double share :
         {part.statistics, part.law, part.geometry, part.numerics, part.rest()})
      row.push_back(text(significant(100.0 * share, 2)));
  } else {
    row.resize(11, text("–"));
  }
  row.push_back(score.remark.size() > 40
                    ? R"(<span class="prose short">)"_html + typeset(score.remark) + "</span>"_html
                    : typeset(score.remark));
  return row;
}

Html kind_title(calibration::SampleKind kind) {
  using enum calibration::SampleKind;
  switch (kind) {
    case in_sample:
      return "In sample: fitted to these runs"_html;
    case leave_one_out:
      return "Left out: the law refitted without this run"_html;
    case interpolation:
      return "Interpolation: same geometry, inside the data"_html;
    case extrapolation:
      return "Extrapolation: same geometry, beyond the data"_html;
    case cross_geometry:
      return "Cross geometry: the law comes from another flow"_html;
    case independent:
      break;
  }
  return "Independent table"_html;
}

Table score_table(const TableScores& scores) {
  Table result{
      .caption = text(scores.name + ": ") +
                 "differences in % of the measured. <i>u</i>: relative <i>L</i><sub>2</sub> of "
                 "the velocity, with what it is made of; rest: what the four parts leave, added "
                 "in squares; over all moments of a start, a tilt step or an arrest likewise. "
                 "<i>μ</i>, <i>φ</i>: the law at the measured states. Times: signed."_html,
      .head = {"Run"_html,
               "Flow"_html,
               "Of"_html,
               "Difference [%]"_html,
               "in s.e."_html,
               "d ln <i>I</i>/d ln <i>μ</i>"_html,
               "statistics [%]"_html,
               "law [%]"_html,
               "geometry [%]"_html,
               "numerics [%]"_html,
               "rest [%]"_html,
               "Remark"_html},
      .rows = {},
      .text_columns = 3};
  for (const calibration::SampleKind kind : all_kinds) {
    bool first = true;
    for (const Score& score : scores.scores) {
      if (score.kind != kind) continue;
      if (first) result.rows.push_back({kind_title(kind)});
      first = false;
      result.rows.push_back(score_row(score));
    }
  }
  return result;
}

bool same(const Score& a, const Score& b) {
  const auto left_out = [](const Score& s) {
    return s.kind == calibration::SampleKind::leave_one_out;
  };
  return a.run == b.run && a.quantity == b.quantity && left_out(a) == left_out(b);
}

/// One column per table.
Table side_by_side(const Report& report) {
  Table result{
      .caption = "All tables side by side: difference in %, and the kind of the sample."_html,
      .head = {"Run"_html, "Of"_html},
      .rows = {},
      .text_columns = 2};
  for (const TableScores& scores : report.tables) result.head.push_back(code(scores.name));
  for (const Score& row : report.tables.front().scores) {
    result.rows.push_back({code(row.run), typeset(row.quantity)});
    for (const TableScores& scores : report.tables) {
      const auto found =
          std::ranges::find_if(scores.scores, [&](const Score& s) { return same(s, row); });
      result.rows.back().push_back(text(found == scores.scores.end()
                                            ? "–"
                                            : fmt::format("{} ({})",
                                                          percent_value(found->difference),
                                                          calibration::name(found->kind))));
    }
  }
  return result;
}

}  // namespace

Html score_section(const Report& report) {
  if (report.tables.empty()) return {};
  Html content;
  if (report.tables.size() > 1) content += table(side_by_side(report));
  for (const TableScores& scores : report.tables) content += table(score_table(scores));
  return section("scores", "Errors by kind of sample, and their parts"_html, content);
}

Html flow_section(const Report& report,
                  const std::vector<FigureGroup>& groups,
                  const Pictures& pictures) {
  if (report.flows.empty()) return {};
  Html content = table_numbers(report);
  const Table bands = band_table(report);
  if (!bands.rows.empty()) content += table(bands);
  content += nonlocal_sentence(report);
  for (const FlowComparison& flow : report.flows) {
    if (flow.ring) content += ring_part(report, flow);
  }
  for (const FigureGroup& group : groups) content += show(group, pictures);
  for (std::size_t t = 0; t < report.tables.size(); ++t) {
    const Table states = state_table(report, t);
    if (!states.rows.empty()) content += table(states);
  }
  return section("flows", "Shear boxes, bands and ring cells"_html, content);
}

}  // namespace grainlaw::report
