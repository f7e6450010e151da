#include "apps/io/local_data_hdf5.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <ctime>
#include <functional>
#include <limits>
#include <thread>

#include "apps/io/hdf5_columns.h"
#include "apps/io/hdf5_file.h"
#include "apps/io/lifetimes_hdf5.h"
#include "apps/io/profile_hdf5.h"
#include "apps/io/ring_hdf5.h"
#include "apps/io/rows_hdf5.h"
#include "apps/io/safe_write.h"
#include "apps/io/sealed_file.h"
#include "dem/reduced_data.h"

namespace grainlaw::io {
namespace {

using namespace dem;

constexpr std::string_view kind = "local data";
constexpr int format = 3;

constexpr auto condition_fields = std::to_array<Field<ChuteConditions>>({
    {"inclination", &ChuteConditions::inclination},
    {"gravity", &ChuteConditions::gravity, dimension::acceleration},
    {"grain_diameter", &ChuteConditions::grain_diameter, dimension::length},
    {"grain_density", &ChuteConditions::grain_density, dimension::density},
    {"stiffness", &ChuteConditions::stiffness, dimension::stiffness},
    {"contact_friction", &ChuteConditions::contact_friction},
    {"attraction", &ChuteConditions::attraction, dimension::force},
    {"mass_per_area", &ChuteConditions::mass_per_area, dimension::mass_per_area},
    {"shear_rate", &ChuteConditions::shear_rate, dimension::rate},
});

constexpr auto window_fields = std::to_array<Field<SteadyWindow>>({
    {"begin", &SteadyWindow::begin, dimension::time},
    {"end", &SteadyWindow::end, dimension::time},
});

constexpr auto summary_fields = std::to_array<Field<RunSummary>>({
    {"time_step", &RunSummary::time_step, dimension::time},
    {"contact_time", &RunSummary::contact_time, dimension::time},
    {"restitution", &RunSummary::restitution},
    {"largest_overlap", &RunSummary::largest_overlap},
    {"deep_overlap_share", &RunSummary::deep_overlap_share},
    {"energy_residual", &RunSummary::energy_residual},
    {"coordination", &RunSummary::coordination},
});

constexpr auto run_fields = std::to_array<Field<RunSummary>>({
    // they differ between equal runs: group /run
    {"wall_seconds", &RunSummary::wall_seconds},
    {"startup_wall_seconds", &RunSummary::startup_wall_seconds},
});

template <class T, class Fields>
void write_fields(Hdf5Writer& out, const std::string& group, const T& from, const Fields& fields) {
  for (const auto& field : fields) {
    out.attribute(group, field.name, from.*field.member);
    out.attribute(group, std::string(field.name) + "_unit", symbol(field.dimension));
  }
}

template <class T, class Fields>
void read_fields(const Hdf5Reader& in, const std::string& group, T& to, const Fields& fields) {
  for (const auto& field : fields) to.*field.member = in.number(group, field.name);
}

void write_provenance(Hdf5Writer& out, const RunRecord& record) {
  out.attribute("/", "program", "grainlaw");
  out.attribute("/", "version", record.version);
  out.attribute("/", "name", record.data.name);
  out.attribute("/", "seed", std::bit_cast<std::int64_t>(record.seed));
  out.attribute("/", "units", grain_units().symbols());
  out.group("scene_units");  // one unit of this file in the units of the scene
  out.attribute("scene_units", "set", record.units.name);
  out.attribute("scene_units", "length", record.units.length);
  out.attribute("scene_units", "mass", record.units.mass);
  out.attribute("scene_units", "time", record.units.time);
  out.dataset("scene", record.scene_text);
}

void read_provenance(const Hdf5Reader& in, RunRecord& record) {
  record.version = in.text("/", "version");
  record.data.name = in.text("/", "name");
  record.seed = std::bit_cast<std::uint64_t>(in.integer("/", "seed"));
  record.units = {in.text("scene_units", "set"),
                  in.number("scene_units", "length"),
                  in.number("scene_units", "mass"),
                  in.number("scene_units", "time")};
  record.scene_text = in.text("scene");
}

void write_conditions(Hdf5Writer& out, const ChuteConditions& conditions) {
  out.group("conditions");
  write_fields(out, "conditions", conditions, condition_fields);
  out.attribute("conditions", "geometry", conditions.geometry);
  out.attribute("conditions", "base", conditions.base);
  if (conditions.tilts.empty()) return;
  write_column(out, "conditions/tilt_times", conditions.tilts, dimension::time, &TiltStep::time);
  write_column(out, "conditions/tilts", conditions.tilts, {}, &TiltStep::inclination);
}

ChuteConditions read_conditions(const Hdf5Reader& in) {
  ChuteConditions conditions;
  read_fields(in, "conditions", conditions, condition_fields);
  conditions.geometry = in.text("conditions", "geometry");
  conditions.base = in.text("conditions", "base");
  if (!in.has("conditions/tilt_times")) return conditions;
  conditions.tilts.resize(length_of(in, "conditions/tilt_times"));
  read_column(in, "conditions/tilt_times", conditions.tilts, &TiltStep::time);
  read_column(in, "conditions/tilts", conditions.tilts, &TiltStep::inclination);
  return conditions;
}

void write_window(Hdf5Writer& out, const SteadyWindow& window) {
  out.group("window");
  write_fields(out, "window", window, window_fields);
  out.attribute("window", "steady", std::int64_t{window.steady});
  out.attribute("window", "reason", window.reason);
  if (!window.arrested_at) return;
  out.group("window/arrest");
  out.attribute("window/arrest", "time", *window.arrested_at);
}

SteadyWindow read_window(const Hdf5Reader& in) {
  SteadyWindow window;
  read_fields(in, "window", window, window_fields);
  window.steady = in.integer("window", "steady") != 0;
  window.reason = in.text("window", "reason");
  if (in.has("window/arrest")) window.arrested_at = in.number("window/arrest", "time");
  return window;
}

void write_data(Hdf5Writer& out, const LocalData& data, Precision precision) {
  write_conditions(out, data.conditions);
  write_window(out, data.window);
  write_rows(out, data);
  write_scales(out, data);
  write_frames(out, data.frames, precision);
  write_widths(out, data);
  out.group("summary");
  write_fields(out, "summary", data.summary, summary_fields);
  out.attribute("summary", "steps", std::int64_t{data.summary.steps});
  out.attribute("summary", "flowing_grains", std::int64_t{data.summary.flowing_grains});
  out.attribute("summary", "base_grains", std::int64_t{data.summary.base_grains});
  if (data.ring) write_ring(out, *data.ring);
  if (data.lifetimes) write_lifetimes(out, *data.lifetimes);
}

void read_data(const Hdf5Reader& in, LocalData& data) {
  data.conditions = read_conditions(in);
  data.window = read_window(in);
  data.frames = read_frames(in);
  const bool friction = slides(data.frames);
  data.rows = read_rows(in, friction);
  data.fields = read_widths(in, friction);
  read_fields(in, "summary", data.summary, summary_fields);
  data.summary.steps = static_cast<long>(in.integer("summary", "steps"));
  data.summary.flowing_grains = static_cast<int>(in.integer("summary", "flowing_grains"));
  data.summary.base_grains = static_cast<int>(in.integer("summary", "base_grains"));
  if (has_ring(in)) data.ring = read_ring(in);
  if (has_lifetimes(in)) data.lifetimes = read_lifetimes(in);
}

/// Only in imported data.
void write_import(Hdf5Writer& out, const RunRecord& record) {
  if (record.imported_from.empty()) return;
  out.group("import");
  out.attribute("import", "program", record.imported_from);
  out.attribute("import", "from_rest", std::int64_t{record.data.frames.from_rest});
  for (const ImportCheck& check : record.checks) {
    const std::string group = "import/" + check.name;
    out.group(group);
    out.attribute(group, "outcome", std::string(name(check.outcome)));
    out.attribute(group, "text", check.text);
  }
}

CheckOutcome outcome_named(std::string_view word) {
  for (const auto outcome :
       {CheckOutcome::passed, CheckOutcome::failed, CheckOutcome::not_possible}) {
    if (word == name(outcome)) return outcome;
  }
  throw ReadError(fmt::format("unknown outcome '{}' of a check", word));
}

void read_import(const Hdf5Reader& in, RunRecord& record) {
  if (!in.has("import")) return;
  record.imported_from = in.text("import", "program");
  record.data.frames.from_rest = in.integer("import", "from_rest") != 0;
  for (const char* check : {"mass", "weight", "friction", "steadiness", "stress", "errors"}) {
    const std::string group = std::string("import/") + check;
    record.checks.push_back(
        {check, outcome_named(in.text(group, "outcome")), in.text(group, "text")});
  }
}

void write_run(Hdf5Writer& out, const RunRecord& record) {
  out.group("run");
  for (const auto& field : run_fields) {
    out.attribute("run", field.name, record.data.summary.*field.member);
  }
  out.attribute("run", "host", record.host);
  out.attribute("run", "date", record.date);
  out.attribute("run", "cores", std::int64_t{record.cores});
}

void read_run(const Hdf5Reader& in, RunRecord& record) {
  read_fields(in, "run", record.data.summary, run_fields);
  record.host = in.text("run", "host");
  record.date = in.text("run", "date");
  record.cores = static_cast<int>(in.integer("run", "cores"));
}

void write_reproducible(Hdf5Writer& out, const RunRecord& record) {
  const bool is_reduced = !record.reduced_from.empty();
  write_provenance(out, record);
  write_data(out, record.data, is_reduced ? Precision::single : Precision::full);
  write_import(out, record);
  if (!is_reduced) return;
  out.group("reduced");
  out.attribute("reduced", "from", record.reduced_from);
}

std::string everything(const RunRecord& record) {
  Hdf5Writer out;
  write_reproducible(out, record);
  write_run(out, record);
  return out.bytes();
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

void write(RunRecord& record, const std::filesystem::path& path) {
  record.host = host_name();
  record.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  record.cores = static_cast<int>(std::thread::hardware_concurrency());
  safe_write(path, seal(kind, format, everything(record)));
}

}  // namespace

std::string_view name(CheckOutcome outcome) {
  constexpr std::array<std::string_view, 3> names{"passed", "failed", "not possible"};
  return names[static_cast<std::size_t>(outcome)];
}

void write_local_data(const LocalData& data,
                      const SceneFile& scene,
                      const std::filesystem::path& path) {
  RunRecord record;
  record.data = data;
  record.scene_text = scene.text;
  record.units = scene.units;
  record.seed = scene.scene.seed;
  record.version = GRAINLAW_VERSION;
  write(record, path);
}

void write_imported_data(const RunRecord& record, const std::filesystem::path& path) {
  RunRecord copy = record;
  write(copy, path);
}

void write_reduced_data(const RunRecord& record, const std::filesystem::path& path) {
  RunRecord copy = record;
  copy.reduced_from = digest(record);
  copy.data = reduced(record.data);
  safe_write(path, seal(kind, format, everything(copy)));
}

RunRecord read_run_record(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  const Hdf5Reader in(unseal(kind, format, bytes, path), path.string());
  RunRecord record;
  read_provenance(in, record);
  read_data(in, record.data);
  read_import(in, record);
  read_run(in, record);
  if (in.has("reduced")) record.reduced_from = in.text("reduced", "from");
  return record;
}

LocalData read_local_data(const std::filesystem::path& path) {
  return read_run_record(path).data;
}

std::string digest(const std::filesystem::path& path) {
  return digest(read_run_record(path));
}

std::string digest(const RunRecord& record) {
  if (!record.reduced_from.empty()) return record.reduced_from;
  Hdf5Writer out;
  write_reproducible(out, record);
  return fmt::format("{:016x}", checksum(out.bytes()));
}

}  // namespace grainlaw::io
