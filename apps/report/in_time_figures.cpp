#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "apps/report/figure.h"
#include "apps/report/numbers.h"

namespace grainlaw::report {
namespace {

using calibration::Moment;
using calibration::Stretch;

/// Velocity profiles are shown when the predicted mean velocity has come this far on its way.
constexpr std::array<double, 5> shown_shares = {0.0, 0.25, 0.5, 0.75, 0.95};
constexpr double share_from_rest = 0.1;  ///< in the place of the first: at rest there is no profile

Csv mean_velocity_csv(const RunComparison& run) {
  const Scales unit = scales(run.data.conditions);
  Csv csv{.columns = {"t [sqrt(d/g)]",
                      "DEM [sqrt(g d)]",
                      "continuum [sqrt(g d)]",
                      "velocity error [steady L2]"},
          .rows = {}};
  for (const Stretch& stretch : run.in_time) {
    for (const Moment& moment : stretch.moments) {
      csv.rows.push_back({moment.time / unit.time,
                          moment.measured_mean / unit.velocity,
                          moment.predicted_mean / unit.velocity,
                          moment.velocity_error});
    }
  }
  return csv;
}

const dem::ProfileFrame* frame_at(const dem::ProfileFrames& frames, double time) {
  const auto found =
      std::find_if(frames.frames.begin(), frames.frames.end(), [&](const dem::ProfileFrame& frame) {
        return frame.begin <= time && time <= frame.end;
      });
  return found == frames.frames.end() ? nullptr : &*found;
}

const continuum::Snapshot* snapshot_at(const continuum::TransientChute& run, double time) {
  const auto nearest = std::min_element(
      run.snapshots.begin(), run.snapshots.end(), [&](const auto& a, const auto& b) {
        return std::abs(a.time - time) < std::abs(b.time - time);
      });
  return nearest == run.snapshots.end() ? nullptr : &*nearest;
}

/// First times at which the predicted mean velocity has gone the shown shares of its way; the last
/// counts as its end.
std::vector<double> shown_times(const Stretch& stretch) {
  const auto& moments = stretch.moments;
  const bool from_rest = stretch.change == calibration::Change::start;
  const double first = from_rest ? 0.0 : moments.front().predicted_mean;
  const double way = moments.back().predicted_mean - first;
  std::vector<double> times;
  for (double share : shown_shares) {
    if (from_rest && share == 0.0) share = share_from_rest;
    const auto reached = std::ranges::find_if(
        moments, [&](const Moment& m) { return (m.predicted_mean - first) / way >= share; });
    if (reached == moments.end()) continue;
    if (times.empty() || reached->time > times.back()) times.push_back(reached->time);
  }
  return times;
}

const std::vector<std::string> profile_columns = {
    "curve", "t [sqrt(d/g)]", "z [d]", "velocity [sqrt(g d)]"};

Csv measured_csv(const RunComparison& run, const std::vector<double>& times) {
  const Scales unit = scales(run.data.conditions);
  const double highest =
      run.data.rows.empty() ? std::numeric_limits<double>::infinity() : run.data.rows.back().z;
  Csv csv{.columns = profile_columns, .rows = {}};
  for (std::size_t k = 0; k < times.size(); ++k) {
    const dem::ProfileFrame* frame = frame_at(run.data.frames, times[k]);
    const std::vector<double> velocity =
        frame ? dem::velocities(*frame, run.data.frames.bins_per_row) : std::vector<double>{};
    for (std::size_t bin = 0; bin < velocity.size(); ++bin) {
      const double z = run.data.frames.row_centre(bin);
      if (z < 0.0 || z > highest || !std::isfinite(velocity[bin])) continue;
      csv.rows.push_back({static_cast<double>(k + 1),
                          times[k] / unit.time,
                          z / unit.length,
                          velocity[bin] / unit.velocity});
    }
  }
  return csv;
}

Csv predicted_csv(const RunComparison& run, const std::vector<double>& times) {
  const Scales unit = scales(run.data.conditions);
  Csv csv{.columns = profile_columns, .rows = {}};
  for (std::size_t k = 0; k < times.size(); ++k) {
    const continuum::Snapshot* snapshot = snapshot_at(*run.transient, times[k]);
    if (snapshot == nullptr) continue;
    for (const continuum::ProfileRow& row : snapshot->profile.rows) {
      csv.rows.push_back({static_cast<double>(k + 1),
                          snapshot->time / unit.time,
                          row.z / unit.length,
                          row.velocity / unit.velocity});
    }
  }
  return csv;
}

/// Where the tilt changes.
std::string change_marks(const RunComparison& run) {
  std::string marks;
  for (const Stretch& stretch : run.in_time) {
    if (stretch.begin == 0.0) continue;
    marks += fmt::format(
        "set arrow from first {0:.6g}, graph 0 to first {0:.6g}, graph 1 nohead lw 1 dt (2,4) lc "
        "rgb '{1}'\n",
        stretch.begin / scales(run.data.conditions).time,
        colour::band);
  }
  return marks;
}

std::string mean_velocity_script(const RunComparison& run, const std::string& name) {
  return plot_head(name) + change_marks(run) +
         fmt::format(R"(set xlabel '{{/:Italic t}} / √({{/:Italic d}}/{{/:Italic g}})'
set ylabel 'mean {{/:Italic v_x}} / √({{/:Italic gd}})'
set xrange [0:*]
set yrange [0:*]
plot '{0}.csv' using "t [sqrt(d/g)]":"DEM [sqrt(g d)]" with points pt 7 ps 0.3 lc rgb '{1}' title 'DEM', \
     '{0}.csv' using "t [sqrt(d/g)]":"continuum [sqrt(g d)]" with lines lw 1.6 lc rgb 'black' title 'continuum'
)",
                     name,
                     colour::measured);
}

std::string error_script(const RunComparison& run,
                         const std::string& name,
                         const std::string& data) {
  return plot_head(name) + change_marks(run) +
         fmt::format(R"(set xlabel '{{/:Italic t}} / √({{/:Italic d}}/{{/:Italic g}})'
set ylabel '{{/:Italic L}}_2 error / steady {{/:Italic L}}_2 [%]'
set xrange [0:*]
set yrange [0:*]
plot '{0}.csv' using "t [sqrt(d/g)]":(100 * column("velocity error [steady L2]")) with lines lw 1.2 lc rgb '{1}' notitle
)",
                     data,
                     colour::predicted);
}

std::string profile_script(const std::string& name,
                           const std::vector<double>& times,
                           double time_unit) {
  std::string result = plot_head(name) + "set tmargin at screen 0.80\n";  // three rows of times
  result += "set xlabel '{/:Italic v_x} / √({/:Italic gd})'\n";
  result += "set ylabel '{/:Italic z} / {/:Italic d}'\nset xrange [0:*]\nset yrange [0:*]\nplot ";
  const char* part =
      "'{0}_{1}.csv' using (column(\"curve\") == {2} ? column(\"velocity [sqrt(g d)]\") : NaN)"
      ":\"z [d]\" with {3}";
  for (std::size_t k = 0; k < times.size(); ++k) {
    const std::string points = fmt::format("points {} title '{{/:Italic t}} = {}'",
                                           point_style(k),
                                           fmt::format("{:.3g}", times[k] / time_unit));
    const std::string lines = "lines " + line_style(k) + " notitle";
    result += k > 0 ? ", \\\n     " : "";
    result += fmt::format(fmt::runtime(part), name, "dem", k + 1, points) + ", \\\n     ";
    result += fmt::format(fmt::runtime(part), name, "continuum", k + 1, lines);
  }
  return result + "\n";
}

/// Profiles of one stretch at its shown times, where there are any.
void add_profiles(FigureGroup& group,
                  const RunComparison& run,
                  const Stretch& stretch,
                  const std::string& name) {
  if (stretch.moments.empty()) return;
  const std::vector<double> times = shown_times(stretch);
  Csv predicted = predicted_csv(run, times);
  if (times.empty() || predicted.rows.empty()) return;
  group.data[name + "_dem.csv"] = measured_csv(run, times);
  group.data[name + "_continuum.csv"] = std::move(predicted);
  const std::string title = stretch_title(stretch);
  group.figures.push_back(
      {.name = name,
       .script = profile_script(name, times, scales(run.data.conditions).time),
       .label = "Velocity against height at several times, " + title + ", " + run.data.name,
       .caption = text(title) + ": velocity at times <i>t</i> [√(<i>d</i>/<i>g</i>)], DEM frames "
                                "(points) and continuum (lines)"_html});
}

}  // namespace

FigureGroup in_time_figures(const RunComparison& run, std::size_t number) {
  FigureGroup group{.title = code(run.data.name), .data = {}, .figures = {}};
  Csv means = mean_velocity_csv(run);
  if (means.rows.empty()) return group;
  const std::string mean = file_stem(run, number) + "_mean_velocity";
  const std::string error = file_stem(run, number) + "_error_in_time";
  group.data[mean + ".csv"] = std::move(means);
  group.figures.push_back({.name = mean,
                           .script = mean_velocity_script(run, mean),
                           .label = "Mean velocity against time, " + run.data.name,
                           .caption = "Mean velocity in time"_html});
  for (std::size_t k = 0; k < run.in_time.size(); ++k) {
    const std::string name = fmt::format("{}_in_time_{}", file_stem(run, number), k + 1);
    add_profiles(group, run, run.in_time[k], name);
  }
  group.figures.push_back({.name = error,
                           .script = error_script(run, error, mean),
                           .label = "Error of the velocity profile in time, " + run.data.name,
                           .caption = "Error of <i>u</i>(<i>z</i>, <i>t</i>)"_html});
  return group;
}

}  // namespace grainlaw::report
