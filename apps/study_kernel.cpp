// What the width of the coarse-graining kernel smears, and what noise it leaves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/study_kinds.h"
#include "apps/study_source.h"
#include "dem/fields.h"

namespace grainlaw::study {
namespace {

/// A field that depends on the width of the kernel.
struct Field {
  std::string_view name;
  double dem::FieldRow::*value;
};
constexpr Field kernel_fields[] = {{"shear rate", &dem::FieldRow::shear_rate},
                                   {"phi", &dem::FieldRow::volume_fraction},
                                   {"mu", &dem::FieldRow::friction},
                                   {"temperature", &dem::FieldRow::temperature}};

std::size_t index_at(const dem::WidthFields& fields, double z) {
  return static_cast<std::size_t>(std::floor((z - fields.z_begin) / fields.row_width));
}

/// Heights of dense flow.
std::vector<double> dense_heights(const dem::LocalData& data) {
  constexpr double dense = 0.9;  // of the densest: the saltating surface is left out
  double most = 0.0;
  for (const dem::LocalRow& row : data.rows) most = std::max(most, row.volume_fraction.value);
  std::vector<double> heights;
  for (const dem::LocalRow& row : data.rows) {
    if (row.volume_fraction.value >= dense * most) heights.push_back(row.z);
  }
  return heights;
}

/// Relative root mean squares over the heights, of what the width costs in bias and in noise.
struct WidthError {
  double bias = 0.0;
  double noise = 0.0;
};

/// The kernel smears a field f by f'' times the variance of the kernel, so f(w) = f(0) + c w^2, and
/// f(0) follows from w/2 and w (Richardson).
WidthError width_error(const std::vector<dem::WidthFields>& fields,
                       std::size_t width,
                       const std::vector<double>& heights,
                       double dem::FieldRow::*value) {
  double bias = 0.0, noise = 0.0, size = 0.0;
  for (const double z : heights) {
    const auto at = [&](std::size_t k) { return index_at(fields[k], z); };
    const double half = fields[0].values[at(0)].*value;
    const double sharp = half - (fields[1].values[at(1)].*value - half) / 3.0;
    const double here = fields[width].values[at(width)].*value;
    const double error = fields[width].errors[at(width)].*value;
    if (!std::isfinite(sharp) || !std::isfinite(here) || !std::isfinite(error)) continue;
    bias += (here - sharp) * (here - sharp);
    noise += error * error;
    size += sharp * sharp;
  }
  return {std::sqrt(bias / size), std::sqrt(noise / size)};
}

void add_kernel_point(Result& result,
                      const std::string& field,
                      const std::string& series,
                      double width,
                      double error) {
  Point point;
  point.quantity = field;
  point.series = field + ", " + series;
  point.setting = fmt::format("{:g} d", width);
  point.cost = width;
  point.error = error;
  result.points.push_back(point);
}

void study_field(Result& result, const dem::LocalData& data, const Field& field) {
  const std::vector<double> heights = dense_heights(data);
  const std::string name(field.name);
  std::string best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < data.fields.size(); ++k) {
    const WidthError error = width_error(data.fields, k, heights, field.value);
    const double width = data.fields[k].width / data.conditions.grain_diameter;
    add_kernel_point(result, name, "bias", width, error.bias);
    add_kernel_point(result, name, "noise", width, error.noise);
    const double total = std::hypot(error.bias, error.noise);
    if (total >= least) continue;
    least = total;
    best = fmt::format("Of these widths take w = {1:g} d for {0}: bias {2}, noise {3}.",
                       name,
                       width,
                       error_text(error.bias),
                       error_text(error.noise));
  }
  result.advice.push_back(best);
}

}  // namespace

Plan plan(const io::KernelStudy& study) {
  Plan plan{.scenes = source_scenes(study.source), .other = {}};
  if (plan.scenes.empty()) plan.other.push_back("widths of " + study.source.run.string());
  return plan;
}

Result run(const io::KernelStudy& study, const io::StudyFile&, const Context& context) {
  const std::vector<Run> runs = obtain(study.source, source_scenes(study.source), context);
  const dem::LocalData& data = *runs.front().data;
  if (data.fields.size() != 3) {
    throw io::InputError(data.name + ": a " + data.conditions.geometry +
                         " without a kernel; this study takes a flow with profiles");
  }
  Result result;
  result.reference = "the fields at w = 0, from w/2 and w as they go with w^2 (Richardson).";
  result.cost_label = "width of the kernel w / d";
  for (const Field& field : kernel_fields) study_field(result, data, field);
  result.remarks.emplace_back(
      "Bias: what the width smears. Noise: the standard error of the field at this width. Root "
      "mean "
      "squares over the heights of dense flow, relative. A width costs no time: one run holds "
      "all.");
  return result;
}

}  // namespace grainlaw::study
