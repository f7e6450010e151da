#include "apps/io/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/io/import_checks.h"
#include "apps/io/import_frames.h"
#include "apps/io/text_table.h"
#include "apps/io/toml_tree.h"
#include "dem/steady_state.h"

namespace grainlaw::io {
namespace {

using dem::BinMoments;
using dem::Estimate;
using dem::LocalRow;

TextTable read_table_of(const Import& import) {
  switch (import.format) {
    case ImportFormat::lammps_chunk:
      return read_lammps_chunk(import.file);
    case ImportFormat::mercury_cg:
      return read_mercury_cg(import.file);
    case ImportFormat::csv:
      break;
  }
  const auto time = import.columns.find("time");
  return read_csv(import.file, time == import.columns.end() ? "" : time->second.name);
}

/// Mean over the frames of the window of the mass per unit area in all bins.
double mass_of(const dem::ProfileFrames& frames, const dem::SteadyWindow& window) {
  double mass = 0.0;
  int count = 0;
  for (const dem::ProfileFrame& frame : frames.frames) {
    if (frame.begin < window.begin) continue;
    for (const BinMoments& bin : frame.bins) mass += bin.mass * frames.bin_width;
    ++count;
  }
  return mass / std::max(count, 1);
}

/// Judges the frames on a clock that begins with them: a history that begins steady shall not wait
/// for its start to be over.
dem::SteadyWindow judge(const Import& import, const dem::ProfileFrames& frames) {
  std::vector<dem::ProfileFrame> shifted = frames.frames;
  const double begin = shifted.front().begin;
  for (dem::ProfileFrame& frame : shifted) {
    frame.begin -= begin;
    frame.end -= begin;
  }
  const double wanted =
      import.averaging_time > 0.0 ? import.averaging_time : 0.25 * shifted.back().end;
  const dem::SteadyCriteria criteria{.averaging_time = wanted};
  dem::SteadyWindow window = dem::steady_window(dem::assess(shifted, criteria), shifted);
  window.begin += begin;
  window.end += begin;
  return window;
}

bool has_squares(const Import& import, const Columns& columns) {
  if (import.format == ImportFormat::mercury_cg) return true;
  return columns.has("square_xx") && columns.has("square_yy") && columns.has("square_zz");
}

bool has_kinetic_part(const Import& import, const Columns& columns) {
  return import.format == ImportFormat::mercury_cg || import.stress == StressContent::total ||
         (columns.has("square_zz") && columns.has("square_xz"));
}

/// Fields of averages that a column may state beside what the rows give.
struct Stated {
  const char* field;
  Estimate LocalRow::*member;
  bool required;  ///< has an error, or none is known
};
constexpr auto stated_fields = std::to_array<Stated>({
    {"velocity", &LocalRow::velocity, true},
    {"volume_fraction", &LocalRow::volume_fraction, true},
    {"shear_stress", &LocalRow::shear_stress, true},
    {"normal_stress", &LocalRow::normal_stress, true},
    {"shear_rate", &LocalRow::shear_rate, false},
    {"temperature", &LocalRow::temperature, false},
});

double largest(const std::vector<LocalRow>& rows, Estimate LocalRow::*field) {
  double value = 0.0;
  for (const LocalRow& row : rows) {
    if (std::isfinite((row.*field).value)) value = std::max(value, std::abs((row.*field).value));
  }
  return value;
}

/// Values and errors that the columns of averages state; those of the velocity gradient otherwise
/// from the velocities of the neighbours, as independent ones.
void take_stated(const Import& import, const TextTable& table, dem::LocalData& data) {
  const Columns columns(import, table);
  const std::vector<TableRow>& lines = table.blocks.front().rows;
  const auto line_of = [&](const LocalRow& row) -> const TableRow& {
    const double bin = (row.z - data.frames.z_begin) / data.frames.bin_width;
    return lines[static_cast<std::size_t>(bin)];
  };
  for (const Stated& stated : stated_fields) {
    const std::string field = stated.field;
    const bool has_value = !stated.required && columns.has(field);
    const bool has_error = columns.has(field + "_error");
    if (!has_error && stated.required && !import.relative_error) {
      table.fail({table.names_line, 1, 1},
                 fmt::format("no standard error of the {}", field),
                 fmt::format("name its column in [columns], {0}_error = \"...\"; or state "
                             "[source] relative_error",
                             field));
    }
    const double otherwise =
        import.relative_error.value_or(0.0) * largest(data.rows, stated.member);
    for (LocalRow& row : data.rows) {
      Estimate& estimate = row.*stated.member;
      if (has_value) estimate.value = columns.value(line_of(row), field);
      if (has_error) {
        estimate.error = columns.value(line_of(row), field + "_error");
      } else if (stated.required || has_value) {
        estimate.error = otherwise;
      }
    }
  }
}

void add_numbers(const dem::ChuteConditions& grains, LocalRow& row) {
  const dem::DimensionlessNumbers numbers = dem::dimensionless_numbers(grains, row);
  const auto relative = [](const Estimate& x) { return x.error / std::abs(x.value); };
  const double pressure = relative(row.normal_stress);
  if (grains.attraction > 0.0) {
    row.bond_number = {numbers.bond_number, numbers.bond_number * pressure};
  }
  row.scaled_temperature = {numbers.temperature,
                            numbers.temperature * std::hypot(relative(row.temperature), pressure)};
  const double phi = row.volume_fraction.value;
  const double bulk =
      row.inertial_number.value * dem::conversion(dem::InertialNumber::shear_bulk, phi);
  row.bulk_inertial_number = {
      bulk, bulk * std::hypot(relative(row.inertial_number), 0.5 * relative(row.volume_fraction))};
}

/// Errors of what follows from other fields, their errors taken as independent.
void propagate_errors(const dem::ChuteConditions& grains, std::vector<LocalRow>& rows) {
  for (std::size_t k = 0; k < rows.size(); ++k) {
    LocalRow& row = rows[k];
    const LocalRow& low = rows[k > 0 ? k - 1 : k];
    const LocalRow& high = rows[std::min(k + 1, rows.size() - 1)];
    if (!(row.shear_rate.error > 0.0)) {
      row.shear_rate.error = std::hypot(low.velocity.error, high.velocity.error) / (high.z - low.z);
    }
    const auto relative = [](const Estimate& x) { return x.error / std::abs(x.value); };
    const double p = row.normal_stress.value;
    row.inertial_number.value =
        row.shear_rate.value * grains.grain_diameter * std::sqrt(grains.grain_density / p);
    row.inertial_number.error =
        row.inertial_number.value *
        std::hypot(relative(row.shear_rate), 0.5 * relative(row.normal_stress));
    row.softness.error = row.softness.value * relative(row.normal_stress);
    add_numbers(grains, row);
    row.friction.error =
        row.friction.value * std::hypot(relative(row.shear_stress), relative(row.normal_stress));
  }
}

/// Averages have no history to make blocks of.
void finish_averages(const Import& import, const TextTable& table, dem::LocalData& data) {
  take_stated(import, table, data);
  propagate_errors(data.conditions, data.rows);
  for (LocalRow& row : data.rows) row.effective_samples = std::nan("");
  // Until here that of the rows: the mass above them then counts from the top down.
  if (import.conditions.mass_per_area > 0.0) {
    data.conditions.mass_per_area = import.conditions.mass_per_area;
  }
  data.frames.frames.clear();
}

/// What nobody measured.
dem::RunSummary unknown_summary(const Import& import) {
  const double unknown = std::nan("");
  dem::RunSummary summary;
  for (double* number : {&summary.time_step,
                         &summary.contact_time,
                         &summary.restitution,
                         &summary.largest_overlap,
                         &summary.deep_overlap_share,
                         &summary.energy_residual,
                         &summary.coordination}) {
    *number = unknown;
  }
  if (import.format == ImportFormat::lammps_chunk) summary.time_step = import.time_step;
  summary.wall_seconds = import.wall_seconds;
  return summary;
}

/// A run that fails a check is not used: its window is not steady, and says why.
void judge_by(const std::vector<ImportCheck>& checks, dem::SteadyWindow& window) {
  for (const ImportCheck& check : checks) {
    if (check.outcome != CheckOutcome::failed || check.name == "steadiness") continue;
    if (window.steady) window.reason.clear();
    window.reason += fmt::format(
        "{}check of the {}: {}", window.reason.empty() ? "" : "; ", check.name, check.text);
    window.steady = false;
  }
}

/// Whether the scene gives its grains velocities at the start.
bool starts_with_a_profile(const std::string& scene_text) {
  const TomlValue scene = parse_toml(scene_text, "scene");
  const TomlEntry* start = scene.table() == nullptr ? nullptr : scene.table()->find("start");
  return start != nullptr && start->value.table() != nullptr &&
         start->value.table()->find("profile") != nullptr;
}

}  // namespace

RunRecord import_run(const Import& import) {
  const TextTable table = read_table_of(import);
  const Columns columns(import, table);
  RunRecord record;
  dem::LocalData& data = record.data;
  data.name = import.name;
  data.conditions = import.conditions;
  data.summary = unknown_summary(import);
  data.frames = frames_of(import, table);
  const bool history = data.frames.frames.size() > 1;
  data.window = history ? judge(import, data.frames)
                        : dem::SteadyWindow{.steady = import.steady,
                                            .begin = data.frames.frames.front().begin,
                                            .end = data.frames.frames.front().end,
                                            .reason = "averages only"};
  CheckedProfile profile{.mass_of_rows = mass_of(data.frames, data.window),
                         .has_history = history,
                         .has_kinetic_part = has_kinetic_part(import, columns),
                         .errors = "by block averaging of the blocks of the file"};
  if (!history || import.conditions.mass_per_area == 0.0) {
    data.conditions.mass_per_area = profile.mass_of_rows;
  }
  data.rows = dem::average(data.frames, data.conditions, data.window);
  if (!has_squares(import, columns)) {
    for (LocalRow& row : data.rows) row.temperature = {};
  }
  if (!history) {
    profile.errors = import.relative_error
                         ? fmt::format("as stated, {} of the largest value where no column says",
                                       *import.relative_error)
                         : "as stated by the columns";
    finish_averages(import, table, data);
  }
  record.checks = check_import(import, data, profile);
  if (!history) data.window.reason = record.checks[3].text;
  judge_by(record.checks, data.window);
  record.scene_text = import.text;
  record.units = import.units;
  record.imported_from = import.program.empty() ? "another program" : import.program;
  record.version = GRAINLAW_VERSION;
  return record;
}

RunRecord read_run(const std::filesystem::path& path) {
  if (path.extension() == ".toml") return import_run(read_import_input(path));
  RunRecord record = read_run_record(path);
  // Files older than the mark of a begin in motion still hold the scene, which tells.
  if (record.imported_from.empty() && starts_with_a_profile(record.scene_text)) {
    record.data.frames.from_rest = false;
  }
  return record;
}

}  // namespace grainlaw::io
