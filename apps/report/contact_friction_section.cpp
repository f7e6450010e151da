#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/figure.h"
#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

using calibration::FrictionDependence;

constexpr std::size_t curve_points = 101;

/// Coefficient of each table with its standard error, 0 where none is stated; NaN where the table
/// has no such coefficient.
dem::Estimate coefficient_of(const continuum::RheologyTable& table, const std::string& name) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const auto stated = continuum::coefficient_names(table);
  if (std::find(stated.begin(), stated.end(), name) == stated.end()) return {none, none};
  dem::Estimate result{continuum::coefficient(table, name), 0.0};
  if (!table.covariance) return result;
  const auto& names = table.covariance->names;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return result;
  const auto k = static_cast<std::size_t>(found - names.begin());
  result.error = std::sqrt((*table.covariance)(k, k));
  return result;
}

Csv tables_csv(const ContactFrictionReport& report) {
  Csv csv{.columns = {"mu_p"}, .rows = {}};
  for (const auto& [name, curve] : report.curves.coefficients) {
    csv.columns.push_back(name);
    csv.columns.push_back(name + " error");
  }
  for (const continuum::RheologyTable& table : report.tables) {
    std::vector<double>& row = csv.rows.emplace_back(std::vector{table.contact_friction});
    for (const auto& [name, curve] : report.curves.coefficients) {
      const dem::Estimate value = coefficient_of(table, name);
      row.push_back(value.value);
      row.push_back(value.error);
    }
  }
  return csv;
}

Csv curves_csv(const ContactFrictionReport& report) {
  double highest = 0.0;
  for (const auto& table : report.tables) highest = std::max(highest, table.contact_friction);
  Csv csv{.columns = {"mu_p"}, .rows = {}};
  for (const auto& [name, curve] : report.curves.coefficients) csv.columns.push_back(name);
  for (std::size_t k = 0; k < curve_points; ++k) {
    const double mu_p = 1.05 * highest * static_cast<double>(k) / (curve_points - 1);
    std::vector<double>& row = csv.rows.emplace_back(std::vector{mu_p});
    for (const auto& [name, curve] : report.curves.coefficients) row.push_back(curve(mu_p));
  }
  return csv;
}

Table curve_table(const ContactFrictionReport& report) {
  Table result{
      .caption =
          "<i>Q</i>(<i>μ<sub>p</sub></i>) = <i>Q</i><sub>∞</sub> + (<i>Q</i><sub>0</sub> − "
          "<i>Q</i><sub>∞</sub>) exp(−<i>μ<sub>p</sub></i>/<i>μ<sub>p0</sub></i>) (Shi et "
          "al. 2020, eq. 1B). Rms: of the tables about the curve, over n − 3. "
          "Interpolation: largest miss of a table by the curve through the others."_html,
      .head = {"Coefficient"_html,
               "<i>Q</i><sub>∞</sub>"_html,
               "<i>Q</i><sub>0</sub>"_html,
               "<i>μ<sub>p0</sub></i>"_html,
               "Rms"_html,
               "Interpolation"_html},
      .rows = {},
      .text_columns = 1};
  if (report.interpolated) {
    result.head.push_back(
        text(fmt::format("at μp = {:.3g}", report.interpolated->contact_friction)));
  }
  for (const auto& [name, curve] : report.curves.coefficients) {
    std::vector<Html> cells = {coefficient_symbol(name)};
    for (const char* part : {"Q_inf", "Q_0", "mu_p0"}) {
      const auto& c = curve.summary[part];
      cells.push_back(text(with_error({c.value, c.error})));
    }
    cells.push_back(text(significant(curve.rms, 2)));
    cells.push_back(text(significant(curve.interpolation_error, 2)));
    if (report.interpolated) {
      cells.push_back(text(with_error(coefficient_of(*report.interpolated, name))));
    }
    result.rows.push_back(std::move(cells));
  }
  return result;
}

Figure curve_figure(const std::string& name) {
  const std::string figure = "contact_friction_" + name;
  const std::string script =
      plot_head(figure) + "set xlabel '{/:Italic μ}_p'\nset ylabel '" +
      plot_symbol(coefficient_symbol(name)) +
      "'\nset lmargin at screen 0.225  # p4 has numbers of seven signs\nset xrange [0:*]\nset "
      "offsets 0, 0, graph 0.05, graph 0.05\n" +
      fmt::format(
          "plot 'contact_friction_curves.csv' using \"mu_p\":\"{0}\" with lines {1} title 'curve', "
          "\\\n     'contact_friction_tables.csv' using \"mu_p\":\"{0}\":\"{0} error\" with "
          "yerrorbars {2} title 'tables'\n",
          name,
          line_style(1),
          point_style(0));
  return {.name = figure,
          .script = script,
          .label = name + " against contact friction, tables and curve",
          .caption = coefficient_symbol(name)};
}

}  // namespace

FigureGroup contact_friction_figures(const ContactFrictionReport& report) {
  FigureGroup group;
  group.data["contact_friction_tables.csv"] = tables_csv(report);
  group.data["contact_friction_curves.csv"] = curves_csv(report);
  for (const auto& [name, curve] : report.curves.coefficients) {
    group.figures.push_back(curve_figure(name));
  }
  return group;
}

Html contact_friction_section(const ContactFrictionReport& report,
                              const FigureGroup& group,
                              const Pictures& pictures) {
  std::vector<Html> names;
  for (const std::string& name : report.table_names) names.push_back(code(name));
  Html content = paragraph("Tables: "_html + join(names, ", "_html) + "."_html);
  content += table(curve_table(report));
  std::vector<Html> items;
  for (const std::string& sentence : report.curves.left_out) items.push_back(typeset(sentence));
  if (!items.empty()) content += "<p>Without a curve:</p>\n"_html + list(items);
  return section("contact-friction",
                 "Coefficients over contact friction"_html,
                 content + show(group, pictures));
}

}  // namespace grainlaw::report
