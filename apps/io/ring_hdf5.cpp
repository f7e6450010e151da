#include "apps/io/ring_hdf5.h"

#include <array>

#include "apps/io/hdf5_columns.h"
#include "apps/io/profile_hdf5.h"

namespace grainlaw::io {

using namespace dem;

namespace {

constexpr auto grid_fields = std::to_array<Field<RingGrid>>({
    {"wedge", &RingGrid::wedge},
    {"r_begin", &RingGrid::r_begin, dimension::length},
    {"z_begin", &RingGrid::z_begin, dimension::length},
    {"cell_width", &RingGrid::width, dimension::length},
});

constexpr auto ring_columns = std::to_array<Field<RingField>>({
    {"velocity", &RingField::velocity, dimension::velocity},
    {"angular_velocity", &RingField::angular_velocity, dimension::rate},
    {"shear_rate_r", &RingField::shear_rate_r, dimension::rate},
    {"shear_rate_z", &RingField::shear_rate_z, dimension::rate},
    {"shear_rate", &RingField::shear_rate, dimension::rate},
    {"volume_fraction", &RingField::volume_fraction},
    {"shear_stress_r", &RingField::shear_stress_r, dimension::stress},
    {"shear_stress_z", &RingField::shear_stress_z, dimension::stress},
    {"shear_stress", &RingField::shear_stress, dimension::stress},
    {"pressure_trace", &RingField::pressure, dimension::stress},
    {"normal_stress", &RingField::normal_stress, dimension::stress},
    {"friction", &RingField::friction},
    {"inertial_number", &RingField::inertial_number},
    {"softness", &RingField::softness},
    {"temperature", &RingField::temperature, dimension::temperature},
    {"coordination", &RingField::coordination},
});
static_assert(sizeof(RingField) / sizeof(double) == ring_columns.size(),
              "a new field needs a column");

void write_field(Hdf5Writer& out,
                 const std::string& path,
                 const std::vector<RingField>& cells,
                 const RingGrid& grid,
                 const Field<RingField>& field) {
  std::vector<double> values;
  values.reserve(cells.size());
  for (const RingField& cell : cells) values.push_back(cell.*field.member);
  // A window without frames has no fields.
  out.dataset(path, values, {cells.empty() ? 0 : grid.rows, grid.columns});
  out.attribute(path, "unit", symbol(field.dimension));
}

void read_field(const Hdf5Reader& in,
                const std::string& path,
                std::vector<RingField>& cells,
                const Shape& shape,
                const Field<RingField>& field) {
  const std::vector<double> values = in.numbers(path, shape);
  cells.resize(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) cells[k].*field.member = values[k];
}

/// Centres of cells along one axis.
void write_axis(Hdf5Writer& out, const std::string& path, const std::vector<double>& centres) {
  out.dataset(path, centres, {centres.size()});
  out.attribute(path, "unit", symbol(dimension::length));
}

void write_axes(Hdf5Writer& out, const RingGrid& grid) {
  std::vector<double> r, z;
  for (std::size_t i = 0; i < grid.columns; ++i) r.push_back(grid.radius(i));
  for (std::size_t k = 0; k < grid.rows; ++k) z.push_back(grid.height(k));
  write_axis(out, "grid/r", r);
  write_axis(out, "grid/z", z);
}

}  // namespace

void write_ring(Hdf5Writer& out, const RingFields& ring) {
  out.group("grid");
  for (const auto& field : grid_fields) {
    out.attribute("grid", field.name, ring.grid.*field.member);
    out.attribute("grid", std::string(field.name) + "_unit", symbol(field.dimension));
  }
  out.attribute("grid", "kernel", std::string(dem::name(ring.grid.kernel.shape)));
  out.attribute("grid", "kernel_width", ring.grid.kernel.width);
  write_axes(out, ring.grid);
  for (const auto& field : ring_columns) {
    const std::string path = std::string("grid/") + field.name;
    write_field(out, path, ring.values, ring.grid, field);
    write_field(out, path + "_error", ring.errors, ring.grid, field);
  }
}

bool has_ring(const Hdf5Reader& in) {
  return in.has("grid");
}

RingFields read_ring(const Hdf5Reader& in) {
  RingFields ring;
  RingGrid& grid = ring.grid;
  for (const auto& field : grid_fields) grid.*field.member = in.number("grid", field.name);
  grid.kernel = {read_kernel_shape(in, "grid"), in.number("grid", "kernel_width")};
  grid.columns = length_of(in, "grid/r");
  grid.rows = length_of(in, "grid/z");
  const Shape found = in.shape("grid/velocity");
  const bool empty = !found.empty() && found.front() == 0;
  const Shape shape{empty ? 0 : grid.rows, grid.columns};
  for (const auto& field : ring_columns) {
    const std::string path = std::string("grid/") + field.name;
    read_field(in, path, ring.values, shape, field);
    read_field(in, path + "_error", ring.errors, shape, field);
  }
  return ring;
}

}  // namespace grainlaw::io
