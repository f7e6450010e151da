#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "apps/report/csv.h"
#include "apps/report/html.h"
#include "apps/report/report.h"

namespace grainlaw::report {

/// One picture: a gnuplot script NAME.gp that reads CSV files beside it and writes NAME.svg.
struct Figure {
  std::string name;
  std::string script;
  std::string label;  ///< what it shows, in plain words
  Html caption;
};

/// Pictures that stand side by side, and the data behind them.
struct FigureGroup {
  Html title;
  std::map<std::string, Csv> data;  ///< by file name
  std::vector<Figure> figures;
};

// Pictures in the order of the report. A group without data has no figures.
FigureGroup law_figures(const Report& report);
FigureGroup profile_figures(const RunComparison& run, std::size_t number);
FigureGroup in_time_figures(const RunComparison& run, std::size_t number);
FigureGroup time_figures(const Report& report);
FigureGroup budget_figures(const BudgetReport& budget);
std::vector<FigureGroup> series_figures(const SeriesReport& series);
std::vector<FigureGroup> material_figures(const MaterialReport& material);
FigureGroup contact_friction_figures(const ContactFrictionReport& report);
std::vector<FigureGroup> flow_figures(const Report& report);

/// "24.8°, predicted (interpolation)".
std::string run_title(const RunComparison& run);

/// "start, 24°", "tilt step, 24° → 26°".
std::string stretch_title(const calibration::Stretch& stretch);

/// File name stem of a run: its number, from 1, and its name reduced to letters and digits.
std::string file_stem(const RunComparison& run, std::size_t number);

/// What gnuplot shows as it stands between single quotes: nothing it would take for a command or
/// for enhanced text.
std::string plot_text(std::string_view name);

struct PlotSize {
  int width = 360;
  int height = 306;
};

/// First lines of every script: terminal, output file, CSV reading and the common look.
std::string plot_head(const std::string& name, PlotSize size = {});

/// Room above the plot for a key of so many entries, two in a row.
std::string key_room(std::size_t entries);

/// A law in a key: tables by their numbers, as names of files do not fit beside a figure.
std::string law_title(const Report& report, std::size_t table, const char* law);

/// Colours with a contrast of at least 3:1 on a white and on a nearly black page. Lines of the law
/// are black in the files, which becomes the colour of the text in the page.
namespace colour {
inline constexpr std::string_view measured = "#2b7fc4";
inline constexpr std::string_view predicted = "#d0541b";
inline constexpr std::string_view third = "#138a5e";
inline constexpr std::string_view fourth = "#a35fc0";
inline constexpr std::string_view band = "#808890";
}  // namespace colour

/// Point shape, dash and colour of the k-th series of a figure, as gnuplot options.
std::string point_style(std::size_t k, double size = 0.5);
std::string hollow_style(std::size_t k, double size = 0.6);
std::string line_style(std::size_t k);

/// A logarithmic axis with labels close enough for its span; left to itself gnuplot labels powers
/// of ten only, of which a short axis holds one or none.
std::string log_axis(char axis, double lower, double upper);

/// Labelled tics at these digits of every decade, and small ones between them.
std::string log_tics(const std::vector<double>& digits);

/// The key above the frame, in two columns where the longest title lets it, and the room it needs.
std::string key_above(std::size_t entries, std::size_t longest_title, PlotSize size = {});

/// In letters.
std::size_t longest(const std::vector<std::string>& titles);

/// Units in which everything is plotted: d, sqrt(g d), sqrt(d/g) of the run.
struct Scales {
  double length = 1.0;
  double velocity = 1.0;
  double time = 1.0;
};
Scales scales(const dem::ChuteConditions& conditions);

}  // namespace grainlaw::report
