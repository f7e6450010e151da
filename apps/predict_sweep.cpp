#include "apps/predict_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "apps/io/input_file.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/io/safe_write.h"
#include "apps/steady_question.h"
#include "apps/summary.h"
#include "continuum/well_posedness.h"

namespace grainlaw {
namespace {

using io::SweepAxis;
using Kind = io::SweepAxis::Kind;
namespace is = io::dimension;

constexpr std::size_t most_points = 1'000'000;

/// The case and the table at one combination of values.
struct Point {
  continuum::ChuteCase chute;
  std::optional<double> depth;
  continuum::RheologyTable table;  ///< in its own units
};

void set_value(Point& point, const SweepAxis& axis, double value) {
  switch (axis.kind) {
    case Kind::inclination:
      point.chute.inclination = value;
      return;
    case Kind::mass_per_area:
      point.chute.mass_per_area = value;
      point.depth.reset();
      return;
    case Kind::depth:
      point.depth = value;
      return;
    case Kind::stiffness:
      point.chute.grains.stiffness = value;
      return;
    case Kind::adhesion:
      point.chute.grains.adhesion = value > 0.0 ? std::optional(value) : std::nullopt;
      return;
    case Kind::coefficient:
      continuum::set_coefficient(point.table, axis.name, value);
  }
}

io::Dimension dimension_of(Kind kind) {
  switch (kind) {
    case Kind::mass_per_area:
      return is::mass_per_area;
    case Kind::depth:
      return is::length;
    case Kind::stiffness:
      return is::stiffness;
    case Kind::adhesion:
      return is::force;
    default:
      return is::number;
  }
}

double in_file_units(const SweepAxis& axis, double value, const io::Units& units) {
  return axis.kind == Kind::inclination ? io::degrees(value)
                                        : value * units.size(dimension_of(axis.kind));
}

/// A value of `which` for each axis, the last one running fastest.
std::vector<double> combination(const std::vector<SweepAxis>& axes, std::size_t which) {
  std::vector<double> values(axes.size());
  for (std::size_t k = axes.size(); k-- > 0;) {
    values[k] = axes[k].values[which % axes[k].values.size()];
    which /= axes[k].values.size();
  }
  return values;
}

std::size_t count_points(const io::CaseFile& file) {
  std::size_t count = 1;
  for (const SweepAxis& axis : *file.sweep) {
    count *= axis.values.size();
    if (count > most_points)
      throw io::InputError(io::case_message(
          file, "sweep", "", fmt::format("the sweep has more than {} points", most_points)));
  }
  return count;
}

/// Refuses coefficients that the table does not have, at their place in the file.
void require_coefficients(const io::CaseFile& file, const continuum::RheologyTable& table) {
  try {
    for (const SweepAxis& axis : *file.sweep)
      if (axis.kind == Kind::coefficient) continuum::coefficient(table, axis.name);
  } catch (const continuum::TableError& error) {
    throw io::InputError(io::case_message(file, "sweep", "coefficients", error.what()));
  }
}

struct Row {
  std::string outcome;
  continuum::SteadyChute steady{};
  double mass_per_area = NAN;
  double margin = NAN;  ///< least F of the flow
};

/// A point that the law or the geometry refuses is a row of the table too, not the end of it.
Row predict_point(Point point, const io::Units& units) {
  try {
    const auto table = io::in_grain_units(point.table, units);
    Row row;
    row.steady = steady_with_band(table, point.chute, point.depth);
    row.outcome = name(row.steady.answer.outcome);
    row.mass_per_area = point.chute.mass_per_area;
    if (const auto flow = continuum::certify(table, row.steady.profile, point.chute.grains))
      row.margin = flow->worst.well_posedness.margin;
    return row;
  } catch (const NoAnswer&) {
    return {.outcome = "NO_SUCH_DEPTH"};
  } catch (const continuum::TableError&) {
    return {.outcome = "TABLE_REFUSED"};
  } catch (const std::invalid_argument&) {
    return {.outcome = "CASE_REFUSED"};
  }
}

bool flows(const Row& row) {
  return !row.steady.profile.rows.empty();
}

std::string field(double value) {
  return std::isfinite(value) ? fmt::format("{:.10g}", value) : std::string();
}

std::string header(const std::vector<SweepAxis>& axes) {
  std::string out;
  for (const SweepAxis& axis : axes) out += axis.name + ",";
  return out +
         "outcome,flowing_mass,height,surface_velocity,surface_velocity_error,flux,"
         "base_inertial_number,condition_number,share_outside_range,well_posedness_margin\n";
}

/// Numbers of a row without a flow are empty, and so is an error that the table does not state.
std::string line(const Row& row, const io::Units& units) {
  if (!flows(row)) return row.outcome + ",,,,,,,,,\n";
  const auto& profile = row.steady.profile;
  const auto& answer = row.steady.answer;
  const double error = profile.rows.back().velocity_error;
  double outside = 0.0;
  for (const auto& flag : answer.out_of_domain) outside = std::max(outside, flag.fraction_outside);
  const double velocity = units.size(is::velocity);
  return fmt::format("{},{},{},{},{},{},{},{},{},{}\n",
                     row.outcome,
                     field(row.mass_per_area * units.size(is::mass_per_area)),
                     field(profile.height * units.size(is::length)),
                     field(profile.surface_velocity * velocity),
                     field(error > 0.0 ? error * velocity : NAN),
                     field(profile.flux * units.size(is::flux)),
                     field(profile.rows.front().inertial_number),
                     field(answer.condition_number),
                     field(outside),
                     field(row.margin));
}

struct Sweep {
  std::string csv;
  std::map<std::string, long> outcomes;
  long flowing = 0;
};

Sweep run(const io::CaseFile& file, const continuum::RheologyTable& table) {
  const auto& axes = *file.sweep;
  Sweep sweep;
  sweep.csv = header(axes);
  const std::size_t points = count_points(file);
  for (std::size_t i = 0; i < points; ++i) {
    const std::vector<double> values = combination(axes, i);
    Point point{file.chute, file.depth, table};
    for (std::size_t k = 0; k < axes.size(); ++k) {
      set_value(point, axes[k], values[k]);
      sweep.csv += field(in_file_units(axes[k], values[k], file.units)) + ",";
    }
    const Row row = predict_point(std::move(point), file.units);
    sweep.csv += line(row, file.units);
    ++sweep.outcomes[row.outcome];
    sweep.flowing += flows(row) ? 1 : 0;
  }
  return sweep;
}

Summary summary_of(const Sweep& sweep, std::size_t points, const std::string& output) {
  Summary summary;
  summary.add("points", "points", static_cast<long>(points));
  for (const auto& [outcome, count] : sweep.outcomes)
    summary.add("outcome_" + outcome, "  " + outcome, count);
  if (!output.empty()) summary.add("output", "table", output);
  return summary;
}

}  // namespace

ExitCode predict_sweep(const io::CaseFile& file,
                       const std::string& table_path,
                       const std::string& output,
                       const CommonOptions& options) {
  const continuum::RheologyTable table = io::read_table(table_path);
  require_coefficients(file, table);
  io::in_grain_units(table, file.units);  // refuses a table in another set of units, once
  const std::size_t points = count_points(file);
  if (options.check) {
    print(summary_of({}, points, {}), options);
    return ExitCode::answered;
  }
  const Sweep sweep = run(file, table);
  if (!output.empty()) io::safe_write(output, sweep.csv);
  if (output.empty() && !options.json)
    std::fputs(sweep.csv.c_str(), stdout);
  else
    print(summary_of(sweep, points, output), options);
  if (sweep.flowing == 0) throw NoAnswer("no point of the sweep has a steady flow");
  return ExitCode::answered;
}

}  // namespace grainlaw
