#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/figure.h"
#include "apps/report/ring_section.h"

namespace grainlaw::report {
namespace {

/// One predicted curve of a figure.
struct Curve {
  std::string title;
  std::string file;
  const continuum::ShearBand* band = nullptr;
};

std::string stem(const std::string& name, std::size_t number) {
  RunComparison named;
  named.data.name = name;
  return "flow_" + file_stem(named, number);
}

std::vector<Curve> curves(const Report& report,
                          const FlowComparison& flow,
                          const std::string& base) {
  std::vector<Curve> result;
  const auto add =
      [&](const std::optional<BandPrediction>& prediction, std::size_t table, const char* law) {
        if (!prediction || prediction->band.profile.rows.empty()) return;
        result.push_back({law_title(report, table, law),
                          fmt::format("{}_law{}.csv", base, result.size() + 1),
                          &prediction->band});
      };
  for (std::size_t t = 0; t < flow.tables.size(); ++t) {
    add(flow.tables[t].local, t, "local");
    add(flow.tables[t].nonlocal, t, "nonlocal");
  }
  return result;
}

const std::vector<std::string> band_columns = {
    "z [d]", "velocity [sqrt(g d)]", "velocity [sqrt(g d)] error", "phi", "phi error"};

/// Positions of a periodic box are those of the first curve.
Csv measured_band(const FlowComparison& flow, const std::vector<Curve>& predicted) {
  const Scales unit = scales(flow.data.conditions);
  const bool box = flow.data.frames.periodic;
  const auto& frames = flow.data.frames;
  const double period = frames.frames.empty()
                            ? 1.0
                            : frames.bin_width * static_cast<double>(frames.frames[0].bins.size());
  const double stretch =
      box && !predicted.empty() ? predicted.front().band->profile.height / period : 1.0;
  double momentum = 0.0, mass = 0.0;
  for (const dem::LocalRow& row : flow.data.rows) {
    momentum += row.volume_fraction.value * row.velocity.value;
    mass += row.volume_fraction.value;
  }
  const double drift = box ? momentum / mass : 0.0;
  Csv csv{.columns = band_columns, .rows = {}};
  for (const dem::LocalRow& row : flow.data.rows) {
    csv.rows.push_back({stretch * row.z / unit.length,
                        (row.velocity.value - drift) / unit.velocity,
                        row.velocity.error / unit.velocity,
                        row.volume_fraction.value,
                        row.volume_fraction.error});
  }
  return csv;
}

Csv predicted_band(const FlowComparison& flow, const continuum::ShearBand& band) {
  const Scales unit = scales(flow.data.conditions);
  Csv csv{.columns = {"z [d]", "velocity [sqrt(g d)]", "phi"}, .rows = {}};
  for (const continuum::ProfileRow& row : band.profile.rows) {
    csv.rows.push_back({row.z / unit.length, row.velocity / unit.velocity, row.volume_fraction});
  }
  return csv;
}

/// Up from the dilute rows of a band, not those at a wall, to above the densest.
std::string fraction_range(const dem::LocalData& data) {
  double densest = 0.0;
  for (const dem::LocalRow& row : data.rows) {
    densest = std::max(densest, row.volume_fraction.value);
  }
  if (!(densest > 0.0)) return {};
  return fmt::format("set xrange [{:.3f}:{:.3f}]\nset xtics 0.1\n", 0.65 * densest, 1.15 * densest);
}

std::string band_script(const std::string& name,
                        const std::string& further,
                        const std::string& measured,
                        const std::vector<Curve>& predicted,
                        const std::string& column,
                        const std::string& axis,
                        const char* z) {
  std::string result = plot_head(name) + key_room(predicted.size() + 1) + further;
  result +=
      fmt::format("set xlabel '{}'\nset ylabel '{{/:Italic {}}} / {{/:Italic d}}'\n", axis, z);
  result += fmt::format(
      "plot '{0}' using \"{1}\":\"z [d]\":\"{1} error\" with xerrorbars {2} "
      "title 'DEM'",
      measured,
      column,
      point_style(0));
  for (std::size_t k = 0; k < predicted.size(); ++k) {
    const std::string style = k == 0 ? "lw 1.6 lc rgb 'black'" : line_style(k);
    result += fmt::format(", \\\n     '{}' using \"{}\":\"z [d]\" with lines {} title '{}'",
                          predicted[k].file,
                          column,
                          style,
                          predicted[k].title);
  }
  return result + "\n";
}

void add_band(const Report& report,
              const FlowComparison& flow,
              const std::string& base,
              FigureGroup& group) {
  const std::vector<Curve> predicted = curves(report, flow, base);
  const std::string measured = base + "_dem.csv";
  group.data[measured] = measured_band(flow, predicted);
  for (const Curve& curve : predicted) group.data[curve.file] = predicted_band(flow, *curve.band);
  const char* z = flow.data.frames.periodic ? "y" : "z";
  const std::string velocity = base + "_velocity";
  group.figures.push_back({.name = velocity,
                           .script = band_script(velocity,
                                                 "",
                                                 measured,
                                                 predicted,
                                                 "velocity [sqrt(g d)]",
                                                 "{/:Italic v_x} / √({/:Italic gd})",
                                                 z),
                           .label = "Velocity against height, " + flow.data.name,
                           .caption = "Velocity"_html});
  const std::string phi = base + "_volume_fraction";
  group.figures.push_back(
      {.name = phi,
       .script = band_script(
           phi, fraction_range(flow.data), measured, predicted, "phi", "{/:Italic φ}", z),
       .label = "Volume fraction against height, " + flow.data.name,
       .caption = "Volume fraction; the kernel mixes rows at a wall with the void beyond"_html});
}

/// Measured states with, beside each, what every table says there.
Csv states_csv(const std::vector<FlowPrediction>& tables) {
  Csv csv{.columns = {"I", "mu", "mu error", "phi", "phi error"}, .rows = {}};
  for (std::size_t t = 0; t < tables.size(); ++t) {
    for (const char* column : {"mu law ", "phi law ", "mu residual ", "phi residual "})
      csv.columns.push_back(column + std::to_string(t + 1));
  }
  for (std::size_t i = 0; !tables.empty() && i < tables.front().states.size(); ++i) {
    const calibration::StatePoint& point = tables.front().states[i].point;
    csv.rows.push_back({point.inertial_number.value,
                        point.friction.value,
                        point.friction.error,
                        point.volume_fraction.value,
                        point.volume_fraction.error});
    for (const FlowPrediction& table : tables) {
      const calibration::StateComparison& state = table.states[i];
      csv.rows.back().insert(csv.rows.back().end(),
                             {state.friction.law.value,
                              state.volume_fraction.law.value,
                              state.friction.in_standard_errors,
                              state.volume_fraction.in_standard_errors});
    }
  }
  return csv;
}

continuum::Range range_of(const Csv& csv, const std::vector<std::size_t>& columns) {
  continuum::Range range{1e300, -1e300};
  for (const std::vector<double>& row : csv.rows) {
    for (const std::size_t k : columns) {
      range.lower = std::fmin(range.lower, row[k]);
      range.upper = std::fmax(range.upper, row[k]);
    }
  }
  return range;
}

/// I over decades needs a logarithm; differences below some percent are not to fill the figure.
std::string state_axes(const Csv& csv, std::size_t quantity, std::size_t tables) {
  constexpr double narrow = 3.0;
  constexpr double least_span = 0.2;  // of the largest value
  constexpr std::size_t measured = 5, per_table = 4;
  const continuum::Range I = range_of(csv, {0});
  std::vector<std::size_t> columns = {quantity == 0 ? 1U : 3U};
  for (std::size_t t = 0; t < tables; ++t) columns.push_back(measured + per_table * t + quantity);
  const continuum::Range y = range_of(csv, columns);
  std::string text = I.upper > narrow * I.lower
                         ? std::string("set logscale x\n")
                         : fmt::format("set xrange [0:{:.4g}]\n", 1.3 * I.upper);
  if (y.upper - y.lower < least_span * y.upper) {
    const double middle = 0.5 * (y.lower + y.upper);
    text += fmt::format("set yrange [{:.3g}:{:.3g}]\n",
                        middle - 0.5 * least_span * y.upper,
                        middle + 0.5 * least_span * y.upper);
  }
  return text;
}

std::string states_script(const Report& report,
                          const std::string& name,
                          const std::string& data,
                          const std::string& quantity,
                          const std::string& axis,
                          const std::string& axes,
                          std::size_t tables) {
  std::string result = plot_head(name) + axes;
  result += "set xlabel '{/:Italic I}'\nset ylabel '" + axis + "'\n";
  result += fmt::format(
      "plot '{0}' using \"I\":\"{1}\":\"{1} error\" with yerrorbars {2} "
      "title 'DEM'",
      data,
      quantity,
      point_style(0));
  constexpr int open_shapes[] = {6, 4, 8, 12};
  for (std::size_t t = 0; t < tables; ++t) {
    const std::string title =
        report.tables.size() > 1 ? fmt::format("law {}", t + 1) : std::string("law there");
    result += fmt::format(
        ", \\\n     '{}' using \"I\":\"{} law {}\" with points pt {} ps 0.8 lc "
        "rgb 'black' title '{}'",
        data,
        quantity,
        t + 1,
        open_shapes[t % 4],
        title);
  }
  return result + "\n";
}

void add_states(const Report& report,
                const std::vector<FlowPrediction>& tables,
                const std::string& base,
                const std::string& what,
                FigureGroup& group) {
  if (tables.empty() || tables.front().states.empty()) return;
  const std::string data = base + "_states.csv";
  group.data[data] = states_csv(tables);
  for (const bool friction : {true, false}) {
    const std::string quantity = friction ? "mu" : "phi";
    const std::string name = base + "_states_" + quantity;
    const std::string axis = friction ? "{/:Italic μ}" : "{/:Italic φ}";
    group.figures.push_back(
        {.name = name,
         .script = states_script(report,
                                 name,
                                 data,
                                 quantity,
                                 axis,
                                 state_axes(group.data[data], friction ? 0 : 1, tables.size()),
                                 tables.size()),
         .label = (friction ? "Friction" : "Volume fraction") + std::string(" against I, ") + what,
         .caption = friction ? "<i>μ</i> measured, and by the law at the same <i>I</i>, <i>p</i>*, "
                               "Bo"_html
                             : "<i>φ</i> measured, and by the law there"_html});
  }
}

/// All boxes of simple shear as one flow: they share the figures.
std::vector<FlowPrediction> box_states(const Report& report) {
  std::vector<FlowPrediction> all(report.tables.size());
  for (const FlowComparison& flow : report.flows) {
    if (flow.data.conditions.geometry != "simple_shear") continue;
    for (std::size_t t = 0; t < all.size(); ++t) {
      const auto& states = flow.tables[t].states;
      all[t].states.insert(all[t].states.end(), states.begin(), states.end());
    }
  }
  return all;
}

}  // namespace

std::vector<FigureGroup> flow_figures(const Report& report) {
  std::vector<FigureGroup> groups;
  FigureGroup boxes{.title = "Simple shear"_html, .data = {}, .figures = {}};
  add_states(report, box_states(report), "flow_boxes", "all boxes", boxes);
  groups.push_back(std::move(boxes));
  for (std::size_t k = 0; k < report.flows.size(); ++k) {
    const FlowComparison& flow = report.flows[k];
    if (flow.data.conditions.geometry == "simple_shear") continue;
    const std::string base = stem(flow.data.name, k + 1);
    FigureGroup group{.title = code(flow.data.name), .data = {}, .figures = {}};
    if (flow.ring) {
      add_ring_figures(report, flow, base, group);
    } else if (!flow.data.rows.empty()) {
      add_band(report, flow, base, group);
    }
    add_states(report, flow.tables, base, flow.data.name, group);
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace grainlaw::report
