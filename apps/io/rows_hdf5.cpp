#include "apps/io/rows_hdf5.h"

#include <array>
#include <cmath>
#include <string>

#include "apps/io/hdf5_columns.h"
#include "apps/io/profile_hdf5.h"
#include "dem/time_scales.h"

namespace grainlaw::io {

using namespace dem;

namespace {

constexpr Dimension power{1, 2, -3};

constexpr auto row_fields = std::to_array<Field<LocalRow>>({
    {"z", &LocalRow::z, dimension::length},
    {"mass_above", &LocalRow::mass_above, dimension::mass_per_area},
    {"effective_samples", &LocalRow::effective_samples},
});

constexpr auto estimate_fields = std::to_array<Field<LocalRow, Estimate>>({
    {"velocity", &LocalRow::velocity, dimension::velocity},
    {"shear_rate", &LocalRow::shear_rate, dimension::rate},
    {"volume_fraction", &LocalRow::volume_fraction},
    {"shear_stress", &LocalRow::shear_stress, dimension::stress},
    {"normal_stress", &LocalRow::normal_stress, dimension::stress},
    {"pressure_trace", &LocalRow::pressure, dimension::stress},
    {"temperature", &LocalRow::temperature, dimension::temperature},
    {"inertial_number", &LocalRow::inertial_number},
    {"softness", &LocalRow::softness},
    {"friction", &LocalRow::friction},
    {"coordination", &LocalRow::coordination},
    {"dissipation_per_contact", &LocalRow::dissipation, power},
});
/// Files of before have none of these: not a number.
constexpr auto number_fields = std::to_array<Field<LocalRow, Estimate>>({
    {"scaled_temperature", &LocalRow::scaled_temperature},
    {"inertial_number_bulk", &LocalRow::bulk_inertial_number},
});
/// What only grains that attract each other have.
constexpr auto cohesion_fields = std::to_array<Field<LocalRow, Estimate>>({
    {"bond_number", &LocalRow::bond_number},
});
/// What only grains with friction have.
constexpr auto sliding_fields = std::to_array<Field<LocalRow, Estimate>>({
    {"sliding_share", &LocalRow::sliding_share},
});

template <class Fields>
void write_estimates(Hdf5Writer& out, const std::vector<LocalRow>& rows, const Fields& fields) {
  for (const auto& field : fields) {
    const std::string path = std::string("rows/") + field.name;
    write_column(out, path, rows, field.dimension, [&field](const LocalRow& row) {
      return (row.*field.member).value;
    });
    write_column(out, path + "_error", rows, field.dimension, [&field](const LocalRow& row) {
      return (row.*field.member).error;
    });
    write_column(out, path + "_effective_samples", rows, {}, [&field](const LocalRow& row) {
      return (row.*field.member).effective_samples;
    });
    out.attribute(path, "convergence", std::string(name(worst_convergence(rows, field.member))));
  }
}

template <class Fields>
void read_estimates(const Hdf5Reader& in, std::vector<LocalRow>& rows, const Fields& fields) {
  for (const auto& field : fields) {
    const std::string path = std::string("rows/") + field.name;
    read_column(
        in, path, rows, [&field](LocalRow& row) -> double& { return (row.*field.member).value; });
    read_column(in, path + "_error", rows, [&field](LocalRow& row) -> double& {
      return (row.*field.member).error;
    });
    read_column(in, path + "_effective_samples", rows, [&field](LocalRow& row) -> double& {
      return (row.*field.member).effective_samples;
    });
  }
}

/// A column that is the power of one field of a row: its error to first order.
struct ScaleColumn {
  const char* name;
  double TimeScales::*scale;
  Estimate LocalRow::*field;
  double power;
};
constexpr auto scale_columns = std::to_array<ScaleColumn>({
    {"shear_time", &TimeScales::shear, &LocalRow::shear_rate, -1.0},
    {"pressure_time", &TimeScales::pressure, &LocalRow::normal_stress, -0.5},
    {"temperature_time", &TimeScales::temperature, &LocalRow::temperature, -0.5},
});

/// Strain rates are half the shear rates: so is I with them.
struct StrainColumn {
  const char* name;
  Estimate LocalRow::*inertial_number;
};
constexpr auto strain_columns = std::to_array<StrainColumn>({
    {"inertial_number_strain", &LocalRow::inertial_number},
    {"inertial_number_strain_bulk", &LocalRow::bulk_inertial_number},
});

template <class Value, class Error>
void write_pair(Hdf5Writer& out,
                const std::string& path,
                const std::vector<LocalRow>& rows,
                Dimension dimension,
                Value value,
                Error error) {
  write_column(out, path, rows, dimension, value);
  write_column(out, path + "_error", rows, dimension, error);
}

}  // namespace

void write_rows(Hdf5Writer& out, const LocalData& data) {
  const std::vector<LocalRow>& rows = data.rows;
  out.group("rows");
  for (const auto& field : row_fields) {
    write_column(out, std::string("rows/") + field.name, rows, field.dimension, field.member);
  }
  write_estimates(out, rows, estimate_fields);
  write_estimates(out, rows, number_fields);
  if (data.conditions.attraction > 0.0) write_estimates(out, rows, cohesion_fields);
  if (slides(data.frames)) write_estimates(out, rows, sliding_fields);
}

void write_scales(Hdf5Writer& out, const LocalData& data) {
  out.group("scales");
  const auto scale_of = [&](const LocalRow& row) { return time_scales(data.conditions, row); };
  const TimeScales of_grains = scale_of({});
  const auto attribute = [&](const char* name, double scale) {
    if (!std::isfinite(scale)) return;  // no such mechanism
    out.attribute("scales", name, scale);
    out.attribute("scales", std::string(name) + "_unit", symbol(dimension::time));
  };
  attribute("contact_time", of_grains.contact);
  attribute("cohesion_time", of_grains.cohesion);
  attribute("gravity_time", of_grains.gravity);
  for (const ScaleColumn& c : scale_columns) {
    const auto value = [&](const LocalRow& row) { return scale_of(row).*c.scale; };
    const auto error = [&](const LocalRow& row) {
      const Estimate& field = row.*c.field;
      return std::abs(c.power * value(row) * field.error / field.value);
    };
    write_pair(out, std::string("scales/") + c.name, data.rows, dimension::time, value, error);
  }
  for (const StrainColumn& c : strain_columns) {
    const double half = conversion(InertialNumber::strain_grain, 1.0);
    const auto value = [&](const LocalRow& row) { return half * (row.*c.inertial_number).value; };
    const auto error = [&](const LocalRow& row) { return half * (row.*c.inertial_number).error; };
    write_pair(out, std::string("scales/") + c.name, data.rows, {}, value, error);
  }
}

std::vector<LocalRow> read_rows(const Hdf5Reader& in, bool slides) {
  std::vector<LocalRow> rows(length_of(in, "rows/z"));
  for (const auto& field : row_fields) {
    read_column(in, std::string("rows/") + field.name, rows, field.member);
  }
  read_estimates(in, rows, estimate_fields);
  if (in.has("rows/scaled_temperature")) read_estimates(in, rows, number_fields);
  if (in.has("rows/bond_number")) read_estimates(in, rows, cohesion_fields);
  if (slides) read_estimates(in, rows, sliding_fields);
  return rows;
}

}  // namespace grainlaw::io
