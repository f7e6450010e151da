#include "apps/report/ring_section.h"

#include <fmt/format.h>

#include "apps/report/numbers.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

using calibration::RingBandRow;

/// What one law says of the cell.
struct LawOfRing {
  std::string title;
  const RingPrediction* prediction = nullptr;
};

std::vector<LawOfRing> laws_of(const Report& report, const FlowComparison& flow) {
  std::vector<LawOfRing> laws;
  for (std::size_t t = 0; t < flow.tables.size(); ++t) {
    const FlowPrediction& table = flow.tables[t];
    if (table.ring_local) laws.push_back({law_title(report, t, "local"), &*table.ring_local});
    if (table.ring_nonlocal)
      laws.push_back({law_title(report, t, "nonlocal"), &*table.ring_nonlocal});
  }
  return laws;
}

/// Those that can be drawn.
std::vector<LawOfRing> compared_laws(const Report& report, const FlowComparison& flow) {
  std::vector<LawOfRing> laws = laws_of(report, flow);
  std::erase_if(laws, [](const LawOfRing& law) { return !law.prediction->comparison; });
  return laws;
}

std::vector<Html> law_row(const FlowComparison& flow, const LawOfRing& law) {
  const RingPrediction& prediction = *law.prediction;
  std::string outcome(continuum::name(prediction.flow.answer.outcome));
  if (prediction.flow.local_band_collapse) outcome += ", LOCAL_BAND_COLLAPSE";
  std::vector<Html> row = {text(law.title), text(outcome)};
  if (!prediction.comparison) {
    row.resize(10, text("–"));
    return row;
  }
  const calibration::RingComparison& c = *prediction.comparison;
  const double d = flow.data.conditions.grain_diameter;
  const RingBandRow& low = flow.ring->rows.front();
  const RingBandRow& top = flow.ring->rows.back();
  for (const std::string& cell : {percent_value(c.velocity),
                                  percent_value(c.velocity_maximum),
                                  with_error(scaled(top.centre, 1.0 / d)),
                                  significant(c.rows.back().centre / d, 4),
                                  with_error(scaled(low.width, 1.0 / d)),
                                  significant(c.rows.front().width / d, 3),
                                  with_error(scaled(top.width, 1.0 / d)),
                                  significant(c.rows.back().width / d, 3)})
    row.push_back(text(cell));
  return row;
}

Table law_table(const Report& report, const FlowComparison& flow) {
  const double d = flow.data.conditions.grain_diameter;
  Table result{
      .caption = code(flow.data.name) +
                 typeset(fmt::format(": rotation over radius and height. Centre at {:.3g} d, width "
                                     "there and at {:.3g} d, of error functions fitted alike.",
                                     flow.ring->rows.back().z / d,
                                     flow.ring->rows.front().z / d)),
      .head = {"Law"_html,
               "Answer"_html,
               "<i>u</i>, <i>L</i><sub>2</sub> [%]"_html,
               "<i>u</i>, largest [%]"_html,
               "<i>R<sub>c</sub></i> / <i>d</i>, DEM"_html,
               "law"_html,
               "<i>W</i> / <i>d</i> low, DEM"_html,
               "law"_html,
               "<i>W</i> / <i>d</i> high, DEM"_html,
               "law"_html},
      .rows = {},
      .text_columns = 2};
  for (const LawOfRing& law : laws_of(report, flow)) result.rows.push_back(law_row(flow, law));
  return result;
}

std::vector<Html> height_row(const RingBandRow& row, double d) {
  return {text(significant(row.z / d, 3)),
          text(with_error(scaled(row.centre, 1.0 / d))),
          text(with_error(scaled(row.width, 1.0 / d))),
          text(significant(row.chi_squared, 2)),
          text(significant(row.shear_rate / row.fitted_shear_rate, 3)),
          text(with_error(row.state.inertial_number)),
          text(with_error(row.state.softness)),
          text(with_error(row.state.friction))};
}

Table height_table(const FlowComparison& flow) {
  const double d = flow.data.conditions.grain_diameter;
  Table rows{.caption = code(flow.data.name) +
                        ": error functions fitted at each height. The rate is that measured at the "
                        "centre over that of the error function."_html,
             .head = {"<i>z</i> / <i>d</i>"_html,
                      "<i>R<sub>c</sub></i> / <i>d</i>"_html,
                      "<i>W</i> / <i>d</i>"_html,
                      "χ² / freedom"_html,
                      "rate"_html,
                      "<i>I</i>"_html,
                      "<i>p</i>*"_html,
                      "<i>μ</i>"_html},
             .rows = {},
             .text_columns = 0};
  for (const RingBandRow& row : flow.ring->rows) rows.rows.push_back(height_row(row, d));
  return rows;
}

std::string column(const char* quantity, const LawOfRing& law) {
  return fmt::format("{} {}", quantity, law.title);
}

/// Centre and width at every height, measured and by every law.
Csv height_csv(const FlowComparison& flow, const std::vector<LawOfRing>& laws) {
  const double d = flow.data.conditions.grain_diameter;
  Csv csv{.columns = {"z [d]", "R_c [d]", "R_c [d] error", "W [d]", "W [d] error"}, .rows = {}};
  for (const LawOfRing& law : laws)
    csv.columns.insert(csv.columns.end(), {column("R_c [d]", law), column("W [d]", law)});
  for (std::size_t k = 0; k < flow.ring->rows.size(); ++k) {
    const RingBandRow& row = flow.ring->rows[k];
    csv.rows.push_back({row.z / d,
                        row.centre.value / d,
                        row.centre.error / d,
                        row.width.value / d,
                        row.width.error / d});
    for (const LawOfRing& law : laws) {
      const calibration::BandShape& shape = law.prediction->comparison->rows[k];
      csv.rows.back().insert(csv.rows.back().end(), {shape.centre / d, shape.width / d});
    }
  }
  return csv;
}

Csv path_csv(const FlowComparison& flow, const continuum::SplitBottom& split) {
  const double d = flow.data.conditions.grain_diameter;
  Csv csv{.columns = {"z [d]", "R_c [d]", "W [d]"}, .rows = {}};
  for (const continuum::SplitBottomRow& row : split.rows) {
    csv.rows.push_back({row.z / d, row.radius / d, row.width / d});
  }
  return csv;
}

Csv rotation_csv(const FlowComparison& flow,
                 const RingBandRow& row,
                 const std::vector<LawOfRing>& laws) {
  const double d = flow.data.conditions.grain_diameter;
  Csv csv{.columns = {"r [d]", "rotation", "rotation error"}, .rows = {}};
  for (const LawOfRing& law : laws) csv.columns.push_back(column("rotation", law));
  for (const calibration::RotationShare& share : row.shares) {
    csv.rows.push_back({share.radius / d, share.value, share.error});
    for (const LawOfRing& law : laws)
      csv.rows.back().push_back(law.prediction->flow.rotation_at(share.radius, row.z));
  }
  return csv;
}

std::string law_style(std::size_t k) {
  return k == 0 ? "lw 1.6 lc rgb 'black'" : line_style(k);
}

void add_rotation(const FlowComparison& flow,
                  const RingBandRow& row,
                  const std::vector<LawOfRing>& laws,
                  const std::string& name,
                  FigureGroup& group) {
  const double d = flow.data.conditions.grain_diameter;
  group.data[name + ".csv"] = rotation_csv(flow, row, laws);
  std::string script = plot_head(name) + key_room(laws.size() + 1);
  script += fmt::format(
      "set xlabel '{{/:Italic r}} / {{/:Italic d}}'\nset ylabel '{{/:Italic ω}} / Ω'\n"
      "set yrange [-0.05:1.05]\n"
      "plot '{0}.csv' using \"r [d]\":\"rotation\":\"rotation error\" with yerrorbars {1} title "
      "'DEM'",
      name,
      point_style(0));
  for (std::size_t k = 0; k < laws.size(); ++k)
    script += fmt::format(", \\\n     '{}.csv' using \"r [d]\":\"{}\" with lines {} title '{}'",
                          name,
                          column("rotation", laws[k]),
                          law_style(k),
                          laws[k].title);
  group.figures.push_back(
      {.name = name,
       .script = script + "\n",
       .label = fmt::format("Rotation against radius at {:.3g} d, {}", row.z / d, flow.data.name),
       .caption = typeset(fmt::format("Rotation at the height of {:.3g} d", row.z / d))});
}

std::string shape_script(const std::string& name,
                         const std::string& base,
                         const char* quantity,
                         const char* axis,
                         const std::vector<LawOfRing>& laws,
                         const std::string& further) {
  std::string script = plot_head(name) + key_room(laws.size() + (further.empty() ? 2 : 3));
  script += fmt::format(
      "set xlabel '{1}'\nset ylabel '{{/:Italic z}} / {{/:Italic d}}'\n"
      "set yrange [0:*]\n"
      "plot '{0}_ring.csv' using \"{2}\":\"z [d]\":\"{2} error\" with xerrorbars {3} title 'DEM'",
      base,
      axis,
      quantity,
      point_style(0));
  for (std::size_t k = 0; k < laws.size(); ++k)
    script +=
        fmt::format(", \\\n     '{}_ring.csv' using \"{}\":\"z [d]\" with lines {} title '{}'",
                    base,
                    column(quantity, laws[k]),
                    law_style(k),
                    laws[k].title);
  script += fmt::format(
      ", \\\n     '{}_path.csv' using \"{}\":\"z [d]\" with lines dt 3 lw 1.6 lc rgb '{}' title "
      "'geometry'{}",
      base,
      quantity,
      colour::band,
      further);
  return script + "\n";
}

}  // namespace

Html ring_part(const Report& report, const FlowComparison& flow) {
  const double d = flow.data.conditions.grain_diameter;
  const auto& top = flow.ring->rows.back();
  Html words =
      typeset(fmt::format("Filling {:.3g} d = {:.3g} of the split radius. Highest fitted row, "
                          "{:.3g} d: centre at {:.4f} ± {:.4f} of it.",
                          flow.ring->height / d,
                          flow.ring->height / flow.split_radius,
                          top.z / d,
                          top.centre.value / flow.split_radius,
                          top.centre.error / flow.split_radius));
  const auto& split = flow.tables.front().split_bottom;
  if (split && !split->rows.empty()) {
    words += typeset(
        fmt::format(" At the surface: {:.4f} by the law of experiments, {:.4f} by the path of "
                    "least torque; both are geometry, which knows no law of flow.",
                    split->measured_radius / flow.split_radius,
                    split->path_radius / flow.split_radius));
  }
  return paragraph(words) + table(law_table(report, flow)) + table(height_table(flow));
}

void add_ring_figures(const Report& report,
                      const FlowComparison& flow,
                      const std::string& base,
                      FigureGroup& group) {
  if (flow.tables.empty() || !flow.tables.front().split_bottom) return;
  const continuum::SplitBottom& split = *flow.tables.front().split_bottom;
  const std::vector<LawOfRing> laws = compared_laws(report, flow);
  const double d = flow.data.conditions.grain_diameter;
  add_rotation(flow, flow.ring->rows.front(), laws, base + "_rotation_low", group);
  add_rotation(flow, flow.ring->rows.back(), laws, base + "_rotation_high", group);
  group.data[base + "_ring.csv"] = height_csv(flow, laws);
  group.data[base + "_path.csv"] = path_csv(flow, split);
  const std::string experiments = fmt::format(
      ", \\\n     '+' using ({:.6g}):({:.6g}) every ::0::0 with points pt 8 ps 1 lc rgb "
      "'{}' title 'experiments'",
      split.measured_radius / d,
      flow.ring->height / d,
      colour::predicted);
  const std::string centre = base + "_centre";
  group.figures.push_back(
      {.name = centre,
       .script = shape_script(
           centre, base, "R_c [d]", "{/:Italic R_c} / {/:Italic d}", laws, experiments),
       .label = "Centre of the band against height, " + flow.data.name,
       .caption = "Centre of the band: error functions fitted to DEM and laws; geometry: the path "
                  "of least torque (Unger et al. 2004), and at the surface the law of experiments "
                  "(Fenistein et al. 2004)"_html});
  const std::string width = base + "_width";
  group.figures.push_back(
      {.name = width,
       .script = shape_script(width, base, "W [d]", "{/:Italic W} / {/:Italic d}", laws, ""),
       .label = "Width of the band against height, " + flow.data.name,
       .caption = "Width of the band; geometry: a quarter ellipse of <i>d</i> "
                  "(<i>H</i>/<i>d</i>)<sup>2/3</sup>"_html});
}

}  // namespace grainlaw::report
