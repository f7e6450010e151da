#include "apps/io/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/io/import_checks.h"
#include "apps/io/text_table.h"
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

/// The columns of a data file as our fields, in internal units.
class Columns {
 public:
  Columns(const Import& import, const TextTable& table) : import_(import), table_(table) {}

  /// Is the field there? One that the import file names has to be.
  bool has(std::string_view field) const {
    const auto found = import_.columns.find(field);
    if (found == import_.columns.end()) return false;
    if (found->second.stated) table_.column(found->second.name, field);
    return table_.find(found->second.name).has_value();
  }
  double value(const TableRow& row, std::string_view field) const {
    const auto found = import_.columns.find(field);
    if (found == import_.columns.end()) {
      table_.fail({table_.names_line, 1, 1},
                  fmt::format("no column is named as {}", field),
                  fmt::format("name it in [columns]: {} = \"...\"", field));
    }
    const ImportColumn& column = found->second;
    const double number = table_.number(row, table_.column(column.name, field));
    return number * column.factor / import_.units.size(column.dimension);
  }
  double value_or(const TableRow& row, std::string_view field, double otherwise) const {
    return has(field) ? value(row, field) : otherwise;
  }
  [[noreturn]] void fail(const TableRow& row, const std::string& message) const {
    table_.fail({row.line, 1, 1}, message);
  }
  /// A column of MercuryCG.
  double raw(const TableRow& row, std::string_view name, Dimension dimension) const {
    return table_.number(row, table_.column(name, "MercuryCG")) / import_.units.size(dimension);
  }

 private:
  const Import& import_;
  const TextTable& table_;
};

constexpr std::array<std::string_view, 6> components{"xx", "yy", "zz", "xy", "xz", "yz"};
constexpr Dimension mass_flux{1, -2, -1};

BinMoments mercury_moments(const Columns& columns, const TableRow& row) {
  BinMoments bin;
  bin.mass = columns.raw(row, "density", dimension::density);
  bin.momentum = {columns.raw(row, "momentumx", mass_flux),
                  columns.raw(row, "momentumy", mass_flux),
                  columns.raw(row, "momentumz", mass_flux)};
  for (std::size_t k = 0; k < components.size(); ++k) {
    const std::string name(components[k]);
    bin.momentum_flux[k] = columns.raw(row, "momentumflux" + name, dimension::stress);
    bin.contact_stress[k] = columns.raw(row, "contactstress" + name, dimension::stress);
  }
  return bin;
}

double density(const Import& import, const Columns& columns, const TableRow& row) {
  const dem::ChuteConditions& grains = import.conditions;
  if (columns.has("density")) return columns.value(row, "density");
  if (columns.has("number_density")) return columns.value(row, "number_density");  // m = 1
  return grains.grain_density * columns.value(row, "volume_fraction");
}

/// Signs and amount of the stress columns: contact stress is kept compression positive.
void add_stress(const Import& import,
                const Columns& columns,
                const TableRow& row,
                BinMoments& bin) {
  double amount = 1.0;
  if (import.stress == StressContent::per_grain) {
    amount = columns.value_or(row, "number_density", bin.mass);  // m = 1
  }
  const double normal = import.signs == StressSigns::tension ? -amount : amount;
  const double shear = import.signs == StressSigns::compression ? amount : -amount;
  bin.contact_stress[2] = normal * columns.value(row, "normal_stress");
  bin.contact_stress[4] = shear * columns.value(row, "shear_stress");
}

/// Mean squares of the velocity; without them those of a flow that does not fluctuate.
void add_momentum(const Import& import,
                  const Columns& columns,
                  const TableRow& row,
                  BinMoments& bin) {
  const double vx = columns.value(row, "velocity");
  const double vz = columns.value_or(row, "velocity_z", 0.0);
  bin.momentum = {bin.mass * vx, 0.0, bin.mass * vz};
  const bool total = import.stress == StressContent::total;
  const auto square = [&](std::string_view field, double mean) {
    return bin.mass * (total ? mean : columns.value_or(row, field, mean));
  };
  bin.momentum_flux = {square("square_xx", vx * vx),
                       square("square_yy", 0.0),
                       square("square_zz", vz * vz),
                       0.0,
                       square("square_xz", vx * vz),
                       0.0};
}

BinMoments moments_of(const Import& import, const Columns& columns, const TableRow& row) {
  BinMoments bin;
  if (import.format == ImportFormat::mercury_cg) {
    bin = mercury_moments(columns, row);
  } else {
    bin.mass = density(import, columns, row);
    if (bin.mass > 0.0) add_momentum(import, columns, row, bin);
    if (bin.mass > 0.0) add_stress(import, columns, row, bin);
  }
  const double fraction = bin.mass / import.conditions.grain_density;
  if (fraction < 0.0 || fraction > 1.0) {
    columns.fail(row,
                 fmt::format("volume fraction {:.4g}, outside 0 to 1: the column of the density or "
                             "its units are wrong",
                             fraction));
  }
  return bin;
}

/// Heights of the rows of the first block, which have to be equally far apart.
std::vector<double> heights(const TextTable& table, const Columns& columns) {
  std::vector<double> z;
  const std::vector<TableRow>& rows = table.blocks.front().rows;
  for (const TableRow& row : rows) {
    z.push_back(columns.value(row, "z"));
    const std::size_t k = z.size() - 1;
    if (k > 0 && z[k] <= z[k - 1]) {
      table.fail({row.line, 1, 1}, "z does not rise: rows go from the base to the surface");
    }
    constexpr double rounding = 0.01;  // of the width: files round z
    if (k > 1 && std::abs((z[k] - z[k - 1]) / (z[1] - z[0]) - 1.0) > rounding) {
      table.fail({row.line, 1, 1}, "z is not equally spaced");
    }
  }
  if (z.size() < 2) table.fail({table.names_line, 1, 1}, "at least two heights are needed");
  return z;
}

void require_same_heights(const TextTable& table,
                          const Columns& columns,
                          const TableBlock& block,
                          const std::vector<double>& z) {
  const double rounding = 0.01 * (z[1] - z[0]);
  for (std::size_t k = 0; k < std::min(block.rows.size(), z.size()); ++k) {
    if (std::abs(columns.value(block.rows[k], "z") - z[k]) > rounding) {
      table.fail({block.rows[k].line, 1, 1}, "z is not that of the first block");
    }
  }
  if (block.rows.size() != z.size()) {
    table.fail({block.rows.back().line, 1, 1},
               fmt::format("a block of {} rows, the first has {}", block.rows.size(), z.size()));
  }
}

/// Spread of the heights of grains in a bin, uniform density and the slope of the velocity taken
/// for granted: without it (gd w)^2/12 would count as temperature.
void add_spread(std::vector<BinMoments>& bins, double width) {
  const auto velocity = [&](std::size_t k) { return bins[k].momentum[0] / bins[k].mass; };
  for (std::size_t k = 0; k < bins.size(); ++k) {
    if (bins[k].mass == 0.0) continue;
    const std::size_t low = k > 0 && bins[k - 1].mass > 0.0 ? k - 1 : k;
    const std::size_t high = k + 1 < bins.size() && bins[k + 1].mass > 0.0 ? k + 1 : k;
    if (low == high) continue;
    const double slope =
        (velocity(high) - velocity(low)) / (static_cast<double>(high - low) * width);
    bins[k].mass_offset_squared = bins[k].mass * width * width / 12.0;
    bins[k].momentum_offset = bins[k].mass_offset_squared * slope;
  }
}

void add_totals(dem::ProfileFrame& frame, const dem::ProfileFrames& all) {
  double mass = 0.0;
  double height = 0.0;
  double energy = 0.0;
  for (std::size_t k = 0; k < frame.bins.size(); ++k) {
    const BinMoments& bin = frame.bins[k];
    mass += bin.mass;
    height += bin.mass * all.bin_centre(k);
    energy += 0.5 * (bin.momentum_flux[0] + bin.momentum_flux[1] + bin.momentum_flux[2]);
  }
  frame.centre_of_mass = height / mass;
  frame.kinetic_energy = energy / mass;  // the mass of a grain is 1
}

dem::ProfileFrames frames_of(const Import& import, const TextTable& table) {
  const Columns columns(import, table);
  const std::vector<double> z = heights(table, columns);
  dem::ProfileFrames frames;
  frames.from_rest = import.from_rest;
  frames.bin_width = (z.back() - z.front()) / static_cast<double>(z.size() - 1);
  frames.z_begin = z.front() - 0.5 * frames.bin_width - import.base_top;
  const bool history = table.blocks.size() > 1;
  double begin = history ? 2.0 * table.blocks[0].time - table.blocks[1].time : 0.0;
  begin *= import.time_step;
  for (const TableBlock& block : table.blocks) {
    require_same_heights(table, columns, block, z);
    dem::ProfileFrame frame;
    frame.begin = begin;
    frame.end = history ? import.time_step * block.time : 0.0;
    frame.samples = 1;
    if (history && frame.end <= frame.begin) {
      table.fail({block.rows.front().line, 1, 1}, "time does not rise from block to block");
    }
    for (const TableRow& row : block.rows) frame.bins.push_back(moments_of(import, columns, row));
    add_spread(frame.bins, frames.bin_width);
    add_totals(frame, frames);
    begin = frame.end;
    frames.frames.push_back(std::move(frame));
  }
  return frames;
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
  return path.extension() == ".toml" ? import_run(read_import_input(path)) : read_run_record(path);
}

}  // namespace grainlaw::io
