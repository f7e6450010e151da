#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "apps/report/figure.h"

namespace grainlaw::report {

/// Lines that differ in mark, dash and colour, so that a figure can be read without its colours.
struct MaterialSeries {
  int filled, hollow;  ///< gnuplot point types
  std::string_view dash, colour;
};
inline constexpr std::size_t material_series_count = 6;
/// Style of the k-th line; they repeat.
const MaterialSeries& material_series(std::size_t k);

/// The file of the points, which several figures read.
inline constexpr const char* points_file = "material_points.csv";

/// One plot command over several lines.
std::string plot_of(const std::vector<std::string>& parts);

/// First lines of a script, with room for a key of three rows.
std::string material_head(const std::string& name);

/// Logarithmic axis over the I of all points.
std::string inertia_axis(const MaterialReport& material);

Figure residual_figure(const MaterialReport& material);

/// Error of the coefficients of each law against DEM time; none where that is not known.
void add_cost_figures(const MaterialReport& material, FigureGroup& group);

}  // namespace grainlaw::report
