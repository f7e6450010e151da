#include "apps/io/import_input.h"

#include <array>
#include <numbers>

namespace grainlaw::io {
namespace {

constexpr Dimension per_volume{0, -3, 0};

/// A field that a column may hold, and the column it is by default.
struct ImportField {
  const char* name;
  const char* meaning;
  Dimension dimension;
  const char* csv = "";     ///< empty: no default
  const char* lammps = "";  ///< the same for fix ave/chunk
};
constexpr auto fields = std::to_array<ImportField>({
    {"time", "end of the stretch of time a row is the mean of", dimension::time},
    {"z", "height, centre of the bin", dimension::length, "z", "Coord1"},
    {"velocity", "mean v_x", dimension::velocity, "velocity", "vx"},
    {"velocity_z", "mean v_z", dimension::velocity, "", "vz"},
    {"volume_fraction", "phi", dimension::number, "volume_fraction"},
    {"density", "mass per volume of the bin", dimension::density, "", "density/mass"},
    {"number_density", "grains per volume of the bin", per_volume, "", "density/number"},
    {"shear_stress", "sigma_xz", dimension::stress, "shear_stress"},
    {"normal_stress", "sigma_zz", dimension::stress, "normal_stress"},
    {"shear_rate", "d v_x / d z; otherwise from the velocities", dimension::rate, "shear_rate"},
    {"temperature",
     "mean square velocity fluctuation per component",
     dimension::temperature,
     "temperature"},
    {"square_xx", "mean of v_x v_x over the grains", dimension::temperature},
    {"square_yy", "mean of v_y v_y", dimension::temperature},
    {"square_zz", "mean of v_z v_z", dimension::temperature},
    {"square_xz", "mean of v_x v_z", dimension::temperature},
    {"velocity_error", "standard error", dimension::velocity, "velocity_error"},
    {"volume_fraction_error", "standard error", dimension::number, "volume_fraction_error"},
    {"shear_stress_error", "standard error", dimension::stress, "shear_stress_error"},
    {"normal_stress_error", "standard error", dimension::stress, "normal_stress_error"},
    {"shear_rate_error", "standard error", dimension::rate, "shear_rate_error"},
    {"temperature_error", "standard error", dimension::temperature, "temperature_error"},
});

/// MercuryCG names its columns itself (StandardFields::writeNames); tensors are compression
/// positive, the force along the first index, the branch along the second.
const std::map<std::string, const char*, std::less<>> mercury_columns{{"z", "z"},
                                                                      {"density", "density"}};

const char* default_column(const ImportField& field, ImportFormat format) {
  if (format == ImportFormat::csv) return field.csv;
  if (format == ImportFormat::lammps_chunk) return field.lammps;
  const auto found = mercury_columns.find(field.name);
  return found == mercury_columns.end() ? "" : found->second;
}

void read_columns(InputFile& in, Import& import) {
  Section columns = in.optional_section(
      "columns", "Names of the columns in the data file; MercuryCG names them itself");
  Section factors = in.optional_section(
      "factors", "What numbers of a column are multiplied by to be in the units of this file");
  for (const ImportField& field : fields) {
    const Key key{field.name, field.meaning};
    const auto stated = columns.find<std::string>(key, "the same name or none");
    const auto factor = factors.find<double>({field.name, "of the column"}, "1");
    const std::string name = stated.value_or(default_column(field, import.format));
    if (name.empty()) continue;
    Dimension unit = field.dimension;
    if (unit == dimension::stress && import.stress == StressContent::per_grain) {
      unit = dimension::energy;  // stress times volume
    }
    import.columns[field.name] = {name, factor.value_or(1.0), unit, stated.has_value()};
  }
  if (columns.given() && import.format == ImportFormat::mercury_cg) {
    columns.problem("", "[columns] has no meaning with format = \"mercury_cg\": leave it out");
  }
}

void read_stress(Section& top, Import& import) {
  const bool lammps = import.format == ImportFormat::lammps_chunk;
  const bool mercury = import.format == ImportFormat::mercury_cg;
  const std::string stress = top.choice(
      {"stress",
       "what the stress columns hold: contact and kinetic part, the contact part, or the contact "
       "part times volume as a mean over the grains (LAMMPS compute stress/atom). Default: total; "
       "per_grain for lammps_chunk; contact for mercury_cg"},
      {"total", "contact", "per_grain"},
      lammps ? "per_grain" : (mercury ? "contact" : "total"));
  const std::string signs = top.choice(
      {"signs",
       "of the stresses, the flow along +x, z upwards: both positive, or a tensor with tension or "
       "compression positive. Default: positive; tension for lammps_chunk; compression for "
       "mercury_cg"},
      {"positive", "tension", "compression"},
      lammps ? "tension" : (mercury ? "compression" : "positive"));
  import.stress = stress == "total"     ? StressContent::total
                  : stress == "contact" ? StressContent::contact
                                        : StressContent::per_grain;
  import.signs = signs == "positive"  ? StressSigns::both_positive
                 : signs == "tension" ? StressSigns::tension
                                      : StressSigns::compression;
}

std::string read_top(InputFile& in, Import& import) {
  Section top = in.top();
  import.name = top.read_or<std::string>(
      {"name", "of the run"}, in.path().stem().string(), "name of the file");
  const std::string format = top.choice(
      {"format", "of the data file: CSV, LAMMPS fix ave/chunk, MercuryDPM's MercuryCG (.stat)"},
      {"csv", "lammps_chunk", "mercury_cg"});
  import.format = format == "csv"            ? ImportFormat::csv
                  : format == "lammps_chunk" ? ImportFormat::lammps_chunk
                                             : ImportFormat::mercury_cg;
  read_stress(top, import);
  return top.read<std::string>({"file", "the data file, relative to this file"});
}

void read_conditions(Section& section, Import& import) {
  dem::ChuteConditions& c = import.conditions;
  c.inclination = radians(section.read<double>(
      {"inclination", "tilt theta of the base", {"degrees"}, between(0.0, 90.0)}));
  c.gravity = 1.0;
  c.grain_diameter = 1.0;
  c.grain_density = 6.0 / std::numbers::pi;  // of a sphere of mass 1 and diameter 1
  c.stiffness = read_stiffness(section, import.units);
  c.contact_friction =
      section.read<double>({"contact_friction", "friction mu_p of contacts", {}, not_negative});
  const Key mass{"mass_per_area",
                 "flowing mass per unit area of the base",
                 import.units[dimension::mass_per_area],
                 positive};
  c.mass_per_area = section.find<double>(mass, "sum over the rows").value_or(0.0);
  c.base = section.read<std::string>(
      {"base", "the base in words: runs with the same words flow over the same base"});
  import.base_top = section.read<double>({"base_top",
                                          "height of the highest base-grain centre + d/2 in the "
                                          "data file: z = 0 of local data",
                                          import.units[dimension::length]});
}

void read_window(InputFile& in, Import& import) {
  Section window = in.optional_section("window", "Time, and what is steady");
  const Unit time = import.units[dimension::time];
  const bool lammps = import.format == ImportFormat::lammps_chunk;
  const Key step{"time_step", "of the run: fix ave/chunk counts steps", time, positive};
  const auto time_step = window.find<double>(step, "required for lammps_chunk");
  if (lammps && !time_step) window.report_missing(step);
  import.time_step = time_step.value_or(1.0 / time.size);
  if (!lammps && window.has("time_step")) {
    window.problem("time_step", "'time_step' has a meaning with format = \"lammps_chunk\" only");
  }
  import.steady = window.read_or<bool>(
      {"steady", "of averages without a history: is the flow they were taken of steady?"}, false);
  import.averaging_time =
      window
          .find<double>({"averaging_time", "least length of a steady window", time, positive},
                        "a quarter of the history")
          .value_or(0.0);
  import.from_rest =
      window.read_or<bool>({"from_rest", "the first block begins with the start from rest"}, false);
}

void read_source(InputFile& in, Import& import) {
  Section source = in.optional_section("source", "Where the data come from");
  import.program = source.read_or<std::string>({"program", "that made the data"}, "", "not said");
  import.wall_seconds =
      source.find<double>({"wall_seconds", "wall time of the run", {"s"}, positive}, "not known")
          .value_or(0.0);
  import.relative_error =
      source.find<double>({"relative_error",
                           "standard error of averages over the largest absolute value of the "
                           "field, where no column states it",
                           {},
                           between(0.0, 1.0)},
                          "averages without errors are refused");
}

std::string read_keys(InputFile& in, Import& import) {
  Section conditions = in.section("conditions", "The chute the data were taken of");
  import.units = read_units(in, conditions);
  const std::string file = read_top(in, import);
  read_conditions(conditions, import);
  read_window(in, import);
  read_columns(in, import);
  read_source(in, import);
  return file;
}

}  // namespace

Import read_import_input(const std::filesystem::path& path) {
  InputFile in = InputFile::open(path);
  Import import;
  const std::string file = read_keys(in, import);
  in.finish();
  import.file = path.parent_path() / file;
  import.text = in.text();
  if (!std::filesystem::is_regular_file(import.file)) {
    throw InputError(in.message("", "file", "cannot read " + import.file.string() + ": no file"));
  }
  return import;
}

std::string import_keys() {
  InputFile in = InputFile::listing();
  Import import;
  read_keys(in, import);
  return in.key_list();
}

}  // namespace grainlaw::io
