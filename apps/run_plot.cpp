#include "apps/run_plot.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "apps/io/safe_write.h"
#include "apps/report/gnuplot.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

/// A folder for script and picture, gone at the end.
class WorkFolder {
 public:
  WorkFolder() : path_((fs::temp_directory_path() / "grainlaw-plot-XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) {
      throw io::FileError("no folder for a plot can be made at " + path_);
    }
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }

  /// Runs a script in the folder; a sentence when that fails.
  std::optional<std::string> draw(const std::string& script) const {
    io::safe_write(fs::path(path_) / "plot.gp", script);
    return report::run_gnuplot(path_, "plot.gp");
  }
  std::string read(const std::string& name) const { return io::read_file(fs::path(path_) / name); }

 private:
  std::string path_;
};

std::string terminal(const fs::path& picture) {
  const std::string ending = picture.extension().string();
  if (ending == ".svg") return "set terminal svg size 990,360 enhanced font ',12'\n";
  if (ending == ".png") return "set terminal pngcairo size 1485,540 enhanced font ',16'\n";
  throw io::InputError(
      fmt::format("--plot {}: a name that ends in .svg or .png is expected", picture.string()));
}

/// One of the panels that stand side by side: points with error bars.
struct Panel {
  std::string x_axis;  ///< gnuplot enhanced text
  std::string y_axis;
  std::vector<std::array<double, 3>> points{};  ///< x, y, standard error (0: not known)
};

/// So that four or five labels stand along x: more would touch each other.
double tic_step(const Panel& panel, bool error_along_x) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& [x, y, error] : panel.points) {
    if (!std::isfinite(x)) continue;
    const double bar = error_along_x && std::isfinite(error) ? error : 0.0;
    low = std::fmin(low, x - bar);
    high = std::fmax(high, x + bar);
  }
  const double rough = high > low ? (high - low) / 4.0 : 1.0;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (digit * decade >= rough) return digit * decade;
  }
  return 10.0 * decade;
}

std::string script(const std::vector<Panel>& panels, bool error_along_x) {
  std::string text =
      "set output 'picture'\nset encoding utf8\nset border 3\nset tics nomirror out scale 0.5\n"
      "set format '%g'\nset minussign\nset errorbars 0\nunset key\nset rmargin 4\n"
      "set multiplot layout 1,3\n";
  for (const Panel& panel : panels) {
    text += "$points << END\n";
    for (const auto& [x, y, error] : panel.points) {
      text += fmt::format("{} {} {}\n", x, y, std::isfinite(error) ? error : 0.0);
    }
    text += "END\n";
    text += fmt::format("set xlabel '{}'\nset ylabel '{}'\nset xtics {:g}\n",
                        panel.x_axis,
                        panel.y_axis,
                        tic_step(panel, error_along_x));
    text += fmt::format("plot $points using 1:2:3 with {} pt 7 ps 0.4 lc rgb '#2b7fc4'\n",
                        error_along_x ? "xerrorbars" : "yerrorbars");
  }
  return text + "unset multiplot\n";
}

constexpr auto fraction_axis = "{/:Italic φ}";
constexpr auto friction_axis = "{/:Italic μ}";

/// v, phi and mu of the window against height.
std::vector<Panel> profiles(const dem::LocalData& data) {
  const std::string height =
      data.conditions.geometry == "split_bottom" ? "{/:Italic r / d}" : "{/:Italic z / d}";
  Panel velocity{"{/:Italic v} / √({/:Italic gd})", height};
  Panel fraction{fraction_axis, height};
  Panel friction{friction_axis, height};
  for (const dem::LocalRow& row : data.rows) {
    velocity.points.push_back({row.velocity.value, row.z, row.velocity.error});
    fraction.points.push_back({row.volume_fraction.value, row.z, row.volume_fraction.error});
    friction.points.push_back({row.friction.value, row.z, row.friction.error});
  }
  return {velocity, fraction, friction};
}

/// phi, mu and T of a box that is the same everywhere, frame by frame.
std::vector<Panel> histories(const dem::LocalData& data) {
  const std::string strain = "strain γ̇ {/:Italic t}";  // such a box knows no gravity
  const double d = data.conditions.grain_diameter;
  Panel fraction{strain, fraction_axis};
  Panel friction{strain, friction_axis};
  Panel temperature{strain, "{/:Italic T} / (γ̇ {/:Italic d})²"};
  for (const dem::ProfileFrame& frame : data.frames.frames) {
    const auto rows =
        dem::average(data.frames, data.conditions, {true, frame.begin, frame.end, {}, {}});
    if (rows.empty()) continue;
    const dem::LocalRow& row = rows.front();
    const double rate = row.shear_rate.value;
    const double t = 0.5 * (frame.begin + frame.end) * rate;
    fraction.points.push_back({t, row.volume_fraction.value, 0.0});
    friction.points.push_back({t, row.friction.value, 0.0});
    temperature.points.push_back({t, row.temperature.value / (rate * d * rate * d), 0.0});
  }
  return {fraction, friction, temperature};
}

}  // namespace

void require_plottable(const fs::path& picture) {
  const WorkFolder folder;
  if (const auto why = folder.draw(terminal(picture))) {
    throw io::InputError(fmt::format("--plot {}: {}", picture.string(), *why));
  }
}

void plot(const dem::LocalData& data, const fs::path& picture) {
  const bool over_time = data.conditions.geometry == "simple_shear";
  const std::vector<Panel> panels = over_time ? histories(data) : profiles(data);
  if (panels.front().points.empty()) {
    throw io::FileError(fmt::format("{}: no row to plot", picture.string()));
  }
  const WorkFolder folder;
  if (const auto why = folder.draw(terminal(picture) + script(panels, !over_time))) {
    throw io::FileError(fmt::format("{}: {}", picture.string(), *why));
  }
  io::safe_write(picture, folder.read("picture"));
}

}  // namespace grainlaw
