#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/figure.h"

namespace grainlaw::report {
namespace {

struct Files {
  std::string measured;
  std::string predicted;
  std::string band;
};

/// One of the three quantities shown against height.
struct Quantity {
  std::string name;    ///< of the file
  std::string label;   ///< in words
  std::string column;  ///< in all CSV files
  std::string axis;    ///< gnuplot enhanced text
  std::string range;   ///< further gnuplot lines
  bool band = false;
};

Csv measured_csv(const dem::LocalData& data) {
  const Scales unit = scales(data.conditions);
  Csv csv{.columns = {"z [d]",
                      "velocity [sqrt(g d)]",
                      "velocity [sqrt(g d)] error",
                      "phi",
                      "phi error",
                      "mu",
                      "mu error",
                      "I",
                      "I error"},
          .rows = {}};
  for (const dem::LocalRow& row : data.rows) {
    csv.rows.push_back({row.z / unit.length,
                        row.velocity.value / unit.velocity,
                        row.velocity.error / unit.velocity,
                        row.volume_fraction.value,
                        row.volume_fraction.error,
                        row.friction.value,
                        row.friction.error,
                        row.inertial_number.value,
                        row.inertial_number.error});
  }
  return csv;
}

Csv predicted_csv(const RunComparison& run) {
  const Scales unit = scales(run.data.conditions);
  Csv csv{.columns = {"z [d]",
                      "velocity [sqrt(g d)]",
                      "velocity [sqrt(g d)] error",
                      "phi",
                      "phi error",
                      "mu",
                      "I"},
          .rows = {}};
  for (const continuum::ProfileRow& row : run.steady.profile.rows) {
    csv.rows.push_back({row.z / unit.length,
                        row.velocity / unit.velocity,
                        row.velocity_error / unit.velocity,
                        row.volume_fraction,
                        row.volume_fraction_error,
                        row.shear_stress / row.pressure,
                        row.inertial_number});
  }
  return csv;
}

/// Outline of the error band: up along its lower edge, down along its upper edge, as gnuplot fills
/// closed curves.
Csv band_outline(const Csv& predicted) {
  Csv csv{.columns = {"z [d]", "velocity [sqrt(g d)]", "phi"}, .rows = {}};
  for (const auto& row : predicted.rows) {
    csv.rows.push_back({row[0], row[1] - row[2], row[3] - row[4]});
  }
  for (auto row = predicted.rows.rbegin(); row != predicted.rows.rend(); ++row) {
    csv.rows.push_back({(*row)[0], (*row)[1] + (*row)[2], (*row)[3] + (*row)[4]});
  }
  return csv;
}

bool has_band(const RunComparison& run) {
  const auto& rows = run.steady.profile.rows;
  return std::any_of(
      rows.begin(), rows.end(), [](const auto& row) { return row.velocity_error > 0.0; });
}

/// Volume fraction of the middle row, where no layer of base or surface reaches.
double bulk_volume_fraction(const dem::LocalData& data) {
  return data.rows[data.rows.size() / 2].volume_fraction.value;
}

/// An axis range around one value, wide enough for scatter, narrow enough to show differences.
std::string range_around(double value) {
  if (!(value > 0.0)) return {};
  return fmt::format("set xrange [{:.3f}:{:.3f}]\nset xtics 0.05\n", 0.8 * value, 1.2 * value);
}

std::vector<Quantity> quantities(const RunComparison& run) {
  const double friction = std::tan(run.data.conditions.inclination);
  const bool band = has_band(run);
  return {{"velocity",
           "Velocity",
           "velocity [sqrt(g d)]",
           "{/:Italic v_x} / √({/:Italic gd})",
           "set xrange [0:*]\n",
           band},
          {"volume_fraction",
           "Volume fraction",
           "phi",
           "{/:Italic φ}",
           range_around(bulk_volume_fraction(run.data)),
           band},
          {"friction",
           "Friction",
           "mu",
           "{/:Italic μ} = {/:Italic σ_{xz}} / {/:Italic σ_{zz}}",
           range_around(friction),
           false}};
}

/// Upper end of the height axis, the same for the quantities of one run [d].
double top(const RunComparison& run) {
  const double highest = std::max(run.data.rows.back().z, run.steady.profile.height);
  return std::ceil(highest / scales(run.data.conditions).length + 0.5);
}

std::string script(const std::string& name,
                   const Quantity& quantity,
                   const Files& files,
                   const RunComparison& run) {
  const bool predicted = !run.steady.profile.rows.empty();
  std::string result = plot_head(name);
  result += "set xlabel '" + quantity.axis + "'\n";
  result +=
      "set ylabel '{/:Italic z} / {/:Italic d}'\nset yrange [0:" + fmt::format("{:.4g}", top(run)) +
      "]\n" + quantity.range;
  result += "plot ";
  if (quantity.band) {
    result += fmt::format(
        "'{}' using \"{}\":\"z [d]\" with filledcurves closed fc rgb '{}' "
        "fs transparent solid 0.3 noborder title '± 1 s.e.', \\\n     ",
        files.band,
        quantity.column,
        colour::band);
  }
  result += fmt::format(
      "'{0}' using \"{1}\":\"z [d]\":\"{1} error\" with xerrorbars {2} "
      "title 'DEM'",
      files.measured,
      quantity.column,
      point_style(0));
  if (predicted) {
    result += fmt::format(
        ", \\\n     '{}' using \"{}\":\"z [d]\" with lines lw 1.6 "
        "lc rgb 'black' title 'continuum'",
        files.predicted,
        quantity.column);
  }
  return result + "\n";
}

Html caption(const Quantity& quantity) {
  if (quantity.name == "velocity") return "Velocity"_html;
  if (quantity.name == "friction") return "Friction, axis ± 20 %"_html;
  return "Volume fraction, axis bulk ± 20 %"_html;
}

}  // namespace

FigureGroup profile_figures(const RunComparison& run, std::size_t number) {
  FigureGroup group{
      .title = code(run.data.name) + text(", " + run_title(run)), .data = {}, .figures = {}};
  if (run.data.rows.empty()) return group;
  const std::string stem = file_stem(run, number);
  const Files files{stem + "_dem.csv", stem + "_continuum.csv", stem + "_band.csv"};
  const Csv predicted = predicted_csv(run);
  group.data[files.measured] = measured_csv(run.data);
  if (!predicted.rows.empty()) group.data[files.predicted] = predicted;
  if (has_band(run)) group.data[files.band] = band_outline(predicted);
  for (const Quantity& quantity : quantities(run)) {
    const std::string name = stem + "_" + quantity.name;
    group.figures.push_back(
        {.name = name,
         .script = script(name, quantity, files, run),
         .label = quantity.label + " against height, " + run.data.name + ", " + run_title(run),
         .caption = caption(quantity)});
  }
  return group;
}

}  // namespace grainlaw::report
