#include "apps/io/import_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace grainlaw::io {
namespace {

using dem::BinMoments;

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
    bins[k].momentum_offset[0] = bins[k].mass_offset_squared * slope;
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

}  // namespace

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

}  // namespace grainlaw::io
