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

/// Velocity profiles are shown when the predicted mean velocity has come this far.
constexpr std::array<double, 4> shown_shares = {0.25, 0.5, 0.75, 0.95};

Csv mean_velocity_csv(const RunComparison& run) {
  const Scales unit = scales(run.data.conditions);
  Csv csv{.columns = {"t [sqrt(d/g)]",
                      "DEM [sqrt(g d)]",
                      "continuum [sqrt(g d)]",
                      "velocity error [steady L2]"},
          .rows = {}};
  for (const calibration::TransientError& moment : run.start_error) {
    csv.rows.push_back({moment.time / unit.time,
                        moment.measured_mean / unit.velocity,
                        moment.predicted_mean / unit.velocity,
                        moment.velocity_error});
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

const continuum::Snapshot* snapshot_at(const continuum::TransientChute& start, double time) {
  const auto nearest = std::min_element(
      start.snapshots.begin(), start.snapshots.end(), [&](const auto& a, const auto& b) {
        return std::abs(a.time - time) < std::abs(b.time - time);
      });
  return nearest == start.snapshots.end() ? nullptr : &*nearest;
}

/// First times at which the predicted mean velocity reaches the shown shares of its last value.
std::vector<double> shown_times(const std::vector<calibration::TransientError>& moments) {
  std::vector<double> times;
  for (const double share : shown_shares) {
    const auto reached = std::find_if(moments.begin(), moments.end(), [&](const auto& moment) {
      return moment.predicted_mean >= share * moments.back().predicted_mean;
    });
    const bool is_new = times.empty() || (reached != moments.end() && reached->time > times.back());
    if (reached != moments.end() && is_new) times.push_back(reached->time);
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
    const continuum::Snapshot* snapshot = snapshot_at(*run.start, times[k]);
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

std::string mean_velocity_script(const std::string& name) {
  return plot_head(name) +
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

std::string error_script(const std::string& name, const std::string& data) {
  return plot_head(name) +
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
  std::string result = plot_head(name);
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

}  // namespace

FigureGroup start_figures(const RunComparison& run, std::size_t number) {
  FigureGroup group{.title = text(run_title(run)), .data = {}, .figures = {}};
  if (run.start_error.empty() || !run.start) return group;
  const std::string mean = file_stem(run, number) + "_start_mean";
  group.data[mean + ".csv"] = mean_velocity_csv(run);
  group.figures.push_back({.name = mean,
                           .script = mean_velocity_script(mean),
                           .label = "Mean velocity against time from rest, " + run_title(run),
                           .caption = "Mean velocity from rest"_html});
  const std::vector<double> times = shown_times(run.start_error);
  const std::string profile = file_stem(run, number) + "_start_profile";
  group.data[profile + "_dem.csv"] = measured_csv(run, times);
  group.data[profile + "_continuum.csv"] = predicted_csv(run, times);
  if (times.empty() || group.data[profile + "_continuum.csv"].rows.empty()) return group;
  group.figures.push_back(
      {.name = profile,
       .script = profile_script(profile, times, scales(run.data.conditions).time),
       .label = "Velocity against height at several times from rest, " + run_title(run),
       .caption = "Velocity at times <i>t</i> [√(<i>d</i>/<i>g</i>)]: DEM frames (points), "
                  "continuum (lines)"_html});
  const std::string error = file_stem(run, number) + "_start_error";
  group.figures.push_back({.name = error,
                           .script = error_script(error, mean),
                           .label = "Error of the velocity profile against time, " + run_title(run),
                           .caption = "Error of <i>u</i>(<i>z</i>, <i>t</i>)"_html});
  return group;
}

}  // namespace grainlaw::report
