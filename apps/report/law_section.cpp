#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/law_curve.h"
#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

using calibration::FitSummary;
using calibration::FittedCoefficient;

std::string remark(const FittedCoefficient& coefficient) {
  if (!coefficient.identifiable) return "not identifiable";
  return coefficient.at_bound ? "at its bound" : "";
}

bool has_remark(const FittedCoefficient& coefficient) {
  return !remark(coefficient).empty();
}

Table fit_table(const std::string& law, const FitSummary& fit, const std::string& units) {
  Table result{.caption = fit_caption(law, fit),
               .head = {"Coefficient"_html, "Value"_html, "Standard error"_html},
               .rows = {},
               .text_columns = 1};
  const std::size_t size = fit.coefficients.size();
  const bool correlated = fit.correlation.size() == size * size;
  for (std::size_t j = 0; correlated && j < size; ++j) {
    result.head.push_back("Corr. "_html + coefficient_symbol(fit.coefficients[j].name));
  }
  const bool remarks = std::any_of(fit.coefficients.begin(), fit.coefficients.end(), has_remark);
  if (remarks) result.head.push_back("Remark"_html);
  for (std::size_t i = 0; i < size; ++i) {
    const FittedCoefficient& coefficient = fit.coefficients[i];
    const std::string unit = coefficient_unit(coefficient.name, units);
    std::vector<Html> cells = {coefficient_symbol(coefficient.name) +
                               text(unit == "1" ? std::string() : fmt::format(" [{}]", unit))};
    for (Html& cell : value_cells({.value = coefficient.value, .error = coefficient.error})) {
      cells.push_back(std::move(cell));
    }
    for (std::size_t j = 0; correlated && j < size; ++j) {
      cells.push_back(text(fixed(fit.correlation[i * size + j], 2)));
    }
    if (remarks) cells.push_back(text(remark(coefficient)));
    result.rows.push_back(std::move(cells));
  }
  return result;
}

/// Coefficients of a table that was given, not fitted here.
Table given_table(const continuum::RheologyTable& given) {
  Table result{.caption = "Table used: "_html + typeset(given.provenance.source) + "."_html,
               .head = {"Coefficient"_html, "Value"_html, "Standard error"_html},
               .rows = {},
               .text_columns = 1};
  for (const Coefficient& coefficient : coefficients(given)) {
    const std::string unit = coefficient_unit(coefficient.name, given.units);
    std::vector<Html> cells = {coefficient_symbol(coefficient.name) +
                               text(unit == "1" ? std::string() : fmt::format(" [{}]", unit))};
    for (Html& cell : value_cells(coefficient.estimate)) cells.push_back(std::move(cell));
    result.rows.push_back(std::move(cells));
  }
  return result;
}

Table point_table(const std::vector<calibration::FlowPoint>& points) {
  Table result{.caption =
                   "The points: one per run. Depth rows of one chute share <i>μ</i> and "
                   "<i>I</i> and are not independent."_html,
               .head = {"Run"_html,
                        "Tilt"_html,
                        "<i>I</i>"_html,
                        "<i>μ</i>"_html,
                        "<i>φ</i>"_html,
                        "No-slip height [<i>d</i>]"_html,
                        "<i>p</i>* of the layer"_html},
               .rows = {},
               .text_columns = 1};
  for (const calibration::FlowPoint& point : points) {
    result.rows.push_back({code(point.name),
                           text(degrees(point.inclination)),
                           text(with_error(point.inertial_number)),
                           text(with_error(point.friction)),
                           text(with_error(point.volume_fraction)),
                           text(with_error(point.no_slip_height)),
                           text(significant(point.softness_lower, 2) + " to " +
                                significant(point.softness_upper, 2))});
  }
  return result;
}

Html sentences(const std::vector<std::string>& lines) {
  std::vector<Html> items;
  for (const std::string& line : lines) items.push_back(typeset(line));
  return items.empty() ? Html{} : long_list(items, "remarks");
}

/// What was left out stands with the fits; here only what a reader must know of the points.
Html point_remarks(const std::vector<calibration::FlowPoint>& points) {
  std::vector<std::string> lines;
  for (const calibration::FlowPoint& point : points) {
    for (const std::string& note : point.notes) {
      lines.push_back(note.starts_with(point.name) ? note : point.name + ": " + note);
    }
  }
  return sentences(lines);
}

Html base_sentence(const continuum::RheologyTable& given) {
  if (!given.base) return paragraph("The table has <i>u</i> = 0 at <i>z</i> = 0."_html);
  Html words = "Effective base: <i>u</i> = 0 at <i>z</i> = "_html +
               text(significant(given.base->no_slip_height, 3)) +
               " <i>d</i>, with a mass per area of "_html +
               text(significant(given.base->mass_below, 3)) +
               " <i>ρ<sub>p</sub>d</i> below it"_html;
  if (!given.base->recipe.empty()) words += text(", for the base: " + given.base->recipe);
  return paragraph(words + "."_html);
}

}  // namespace

std::vector<Html> value_cells(const dem::Estimate& estimate) {
  const std::string both = with_error(estimate);
  const std::string separator = " ± ";
  const std::size_t at = both.find(separator);
  if (at == std::string::npos || both.front() == '(') return {text(both), text("–")};
  return {text(both.substr(0, at)), text(both.substr(at + separator.size()))};
}

Html fit_caption(const std::string& law, const FitSummary& fit) {
  const double freedom = fit.data - static_cast<double>(fit.coefficients.size());
  // as many data as coefficients: what is left of chi^2 is rounding
  std::string words = freedom < 0.5
                          ? fmt::format("{}: {} data, as many as coefficients", law, fit.data)
                          : fmt::format("{}: {} data, χ² = {} for {:.0f} {} of freedom",
                                        law,
                                        fit.data,
                                        significant(fit.chi_squared, 3),
                                        freedom,
                                        freedom == 1.0 ? "degree" : "degrees");
  words += fit.converged ? ", converged." : ", NOT converged. " + fit.termination;
  return text(words);
}

Html fit_remarks(const FitSummary& fit) {
  Html result = sentences(fit.not_identifiable) + sentences(fit.notes);
  if (!fit.left_out.empty()) {
    result += R"(<div class="aside">Left out of the fit:)"_html + sentences(fit.left_out) +
              "</div>\n"_html;
  }
  return result;
}

Html law_section(const Report& report, const FigureGroup& group, const Pictures& pictures) {
  Html content;
  if (report.fit) {
    const calibration::MuPhiFit& fit = *report.fit;
    content += table(fit_table("Friction μ(I)", fit.friction, report.table.units));
    content += fit_remarks(fit.friction);
    content += table(fit_table("Volume fraction φ(I)", fit.volume_fraction, report.table.units));
    content += fit_remarks(fit.volume_fraction);
    content += table(point_table(fit.points));
    content += point_remarks(fit.points);
  } else {
    content += table(given_table(report.table));
    if (!report.table.covariance) {
      content += paragraph("No bands: this table states no errors."_html);
    }
  }
  content += base_sentence(report.table);
  return section(
      "law", report.fit ? "The fitted law"_html : "The law"_html, content + show(group, pictures));
}

Html coefficient_symbol(const std::string& name) {
  static const std::map<std::string, Html> known = {
      {"mu0", "<i>μ</i><sub>0</sub>"_html},
      {"beta", "<i>β</i>"_html},
      {"kappa", "<i>κ</i>"_html},
      {"exponent", "<i>n</i> of <i>I<sup>n</sup></i>"_html},
      {"mu_inf", "<i>μ</i><sub>∞</sub>"_html},
      {"I_mu", "<i>I<sub>μ</sub></i>"_html},
      {"cohesion_alpha", "<i>α</i> of <i>f<sub>B</sub></i>"_html},
      {"cohesion_beta", "<i>β</i> of <i>f<sub>B</sub></i>"_html},
      {"cohesion_factor",
       "<i>C</i> of <i>C</i> Bo<sup><i>b</i></sup> <i>p</i>*<sup><i>g</i></sup>"_html},
      {"cohesion_bond_exponent", "<i>b</i> of Bo<sup><i>b</i></sup>"_html},
      {"cohesion_softness_exponent", "<i>g</i> of <i>p</i>*<sup><i>g</i></sup>"_html},
      {"p1", "<i>p</i><sub>1</sub>"_html},
      {"p2", "<i>p</i><sub>2</sub>"_html},
      {"p3", "<i>p</i><sub>3</sub>"_html},
      {"p4", "<i>p</i><sub>4</sub>"_html},
      {"phi0", "<i>φ</i><sub>0</sub>"_html},
      {"I_phi", "<i>I<sub>φ</sub></i>"_html},
      {"p_mu", "<i>p<sub>μ</sub></i>*"_html},
      {"p_phi", "<i>p<sub>φ</sub></i>*"_html},
      {"a", "<i>a</i>"_html},
      {"b", "<i>b</i>"_html},
      {"tau_c", "<i>τ<sub>c</sub></i>"_html},
      {"volume_fraction", "<i>φ</i>"_html},
      {"no_slip_height", "<i>z</i><sub>0</sub>, no-slip height"_html},
      {"mass_below", "mass below <i>z</i><sub>0</sub>"_html}};
  const auto found = known.find(name);
  return found == known.end() ? text(name) : found->second;
}

std::string coefficient_unit(const std::string& name, const std::string& units) {
  static const std::map<std::string, std::map<std::string, std::string>> known = {
      {"grain", {{"a", "m/d"}, {"b", "m/(d\u00a0τ)"}, {"tau_c", "m g/d²"}}},
      {"stiffness", {{"a", "ρₚd²"}, {"b", "√(ρₚkₙd)"}, {"tau_c", "kₙ/d"}}},
      {"si", {{"a", "kg/m"}, {"b", "Pa s"}, {"tau_c", "Pa"}}}};
  if (name == "no_slip_height") return "d";
  if (name == "mass_below") return "ρₚd";
  const auto set = known.find(units);
  if (set == known.end()) return "1";
  const auto unit = set->second.find(name);
  return unit == set->second.end() ? "1" : unit->second;
}

}  // namespace grainlaw::report
