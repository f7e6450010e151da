#include "calibration/ring_band.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/fit_summary.h"
#include "calibration/least_squares.h"
#include "calibration/observations.h"

namespace grainlaw::calibration {
namespace {

using dem::RingField;
using dem::RingFields;
using dem::RingGrid;

double sum_of_fractions(const RingFields& fields, std::size_t row, std::size_t& cells) {
  double sum = 0.0;
  cells = 0;
  for (std::size_t i = 0; i < fields.grid.columns; ++i) {
    const double phi = fields.values[fields.grid.index(i, row)].volume_fraction;
    if (!std::isfinite(phi)) continue;
    sum += phi;
    ++cells;
  }
  return sum;
}

/// Mean phi of every height, 0 where hardly any grain is.
std::vector<double> mean_fractions(const RingFields& fields) {
  std::vector<double> means;
  for (std::size_t k = 0; k < fields.grid.rows; ++k) {
    std::size_t cells = 0;
    const double sum = sum_of_fractions(fields, k, cells);
    means.push_back(cells > 0 ? sum / static_cast<double>(cells) : 0.0);
  }
  return means;
}

/// Half the middle phi of the heights that are filled at all, however far the grid reaches.
double half_of_bulk(const std::vector<double>& fractions) {
  constexpr double filled = 0.2;
  std::vector<double> bulk;
  for (const double phi : fractions) {
    if (phi > filled) bulk.push_back(phi);
  }
  return 0.5 * median(bulk);
}

/// The highest crossing of half the bulk density, on a line between two heights.
double surface(const RingGrid& grid, const std::vector<double>& fractions, double half) {
  for (std::size_t k = grid.rows; k-- > 1;) {
    if (fractions[k - 1] < half) continue;
    if (fractions[k] >= half) return grid.height(k);
    const double share = (fractions[k - 1] - half) / (fractions[k - 1] - fractions[k]);
    return grid.height(k - 1) + share * grid.width;
  }
  return grid.z_begin;
}

std::vector<RotationShare> shares_at(const RingFields& fields,
                                     std::size_t row,
                                     const RingCell& cell,
                                     double half_bulk) {
  const double reach = fields.grid.kernel.reach();
  std::vector<RotationShare> shares;
  std::vector<dem::Estimate> values;
  for (std::size_t i = 0; i < fields.grid.columns; ++i) {
    const double r = fields.grid.radius(i);
    const std::size_t k = fields.grid.index(i, row);
    const RingField& field = fields.values[k];
    if (r < cell.inner_radius + reach || r > cell.outer_radius - reach) continue;
    if (!(field.volume_fraction > half_bulk) || !std::isfinite(field.velocity)) continue;
    const double scale = 1.0 / (r * cell.rotation_rate);
    shares.push_back({.radius = r, .value = scale * field.velocity});
    values.push_back({shares.back().value, scale * fields.errors[k].velocity});
  }
  const std::vector<double> errors = weight_errors(values);
  for (std::size_t i = 0; i < shares.size(); ++i) shares[i].error = errors[i];
  return shares;
}

/// 1/2 + 1/2 erf(x), x = (r - R_c) / W', with its derivatives by R_c and W.
void error_function(const std::vector<RotationShare>& shares,
                    double spread_squared,
                    std::span<const double> x,
                    std::span<double> r,
                    std::span<double> jacobian) {
  const double width = std::hypot(x[1], std::sqrt(2.0 * spread_squared));
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double at = (shares[i].radius - x[0]) / width;
    const double weight = 1.0 / shares[i].error;
    r[i] = weight * (0.5 + 0.5 * std::erf(at) - shares[i].value);
    if (jacobian.empty()) continue;
    const double slope = weight * std::exp(-at * at) / std::sqrt(std::numbers::pi) / width;
    jacobian[2 * i] = -slope;
    jacobian[2 * i + 1] = -slope * at * x[1] / width;
  }
}

double spread_squared(const RingGrid& grid) {
  return grid.kernel.variance() + grid.width * grid.width / 12.0;
}

/// Cells that share their grains.
double cells_together(const RingGrid& grid) {
  return std::max(1.0, 2.0 * grid.kernel.width / grid.width);
}

struct ShapeFit {
  Minimum minimum;
  FitSummary summary;
};

ShapeFit fit_shape(const std::vector<RotationShare>& shares,
                   double spread,
                   const BandShape& start) {
  const LeastSquaresProblem problem{
      .unknowns = {{"R_c", start.centre}, {"W", start.width, 0.0}},
      .residuals = static_cast<int>(shares.size()),
      .evaluate = [&](std::span<const double> x, std::span<double> r, std::span<double> jacobian) {
        error_function(shares, spread, x, r, jacobian);
      }};
  ShapeFit fit{.minimum = minimise(problem), .summary = {}};
  require_converged(fit.minimum, "the error function of a ring cell");
  fit.summary = describe({"R_c", "W"}, fit.minimum, uncertainty(problem, fit.minimum));
  return fit;
}

void fit_shares(const RingGrid& grid, const RingCell& cell, double first_width, RingBandRow& row) {
  const ShapeFit fit =
      fit_shape(row.shares, spread_squared(grid), {cell.split_radius, first_width});
  const double together = cells_together(grid);
  const double freedom = static_cast<double>(row.shares.size()) - 2.0 * together;
  row.chi_squared = fit.minimum.chi_squared / freedom;
  const double factor = std::sqrt(together * std::max(1.0, row.chi_squared));
  row.centre = {fit.summary["R_c"].value, factor * fit.summary["R_c"].error};
  row.width = {fit.summary["W"].value, factor * fit.summary["W"].error};
  row.fitted_shear_rate =
      row.centre.value * cell.rotation_rate / (row.width.value * std::sqrt(std::numbers::pi));
}

/// Weighted mean of a field and of its errors, which neighbours share.
class Mean {
 public:
  Mean(const RingFields& fields, const std::vector<std::size_t>& cells)
      : fields_(fields), cells_(cells) {}

  dem::Estimate operator()(double RingField::*field) const {
    double value = 0.0, error = 0.0, weights = 0.0;
    for (const std::size_t k : cells_) {
      const double weight = fields_.values[k].shear_rate;
      value += weight * fields_.values[k].*field;
      error += weight * fields_.errors[k].*field;
      weights += weight;
    }
    return {value / weights, error / weights};
  }

 private:
  const RingFields& fields_;
  const std::vector<std::size_t>& cells_;
};

/// Cells of the centre of the band: a stretch around the one of the largest shear rate near R_c.
std::vector<std::size_t> centre_cells(const RingFields& fields,
                                      std::size_t row,
                                      const RingBandRow& band) {
  const RingGrid& grid = fields.grid;
  const auto near = [&](std::size_t i) {
    const std::size_t k = grid.index(i, row);
    return std::abs(grid.radius(i) - band.centre.value) < band.width.value + grid.width &&
           std::isfinite(fields.values[k].shear_rate) && std::isfinite(fields.values[k].friction);
  };
  double largest = 0.0;
  for (std::size_t i = 0; i < grid.columns; ++i) {
    if (near(i)) largest = std::max(largest, fields.values[grid.index(i, row)].shear_rate);
  }
  std::vector<std::size_t> cells;
  for (std::size_t i = 0; i < grid.columns; ++i) {
    const std::size_t k = grid.index(i, row);
    if (near(i) && fields.values[k].shear_rate >= band_centre_cut * largest) cells.push_back(k);
  }
  return cells;
}

void add_state(const RingFields& fields,
               std::size_t height,
               const dem::ChuteConditions& conditions,
               RingBandRow& row) {
  const std::vector<std::size_t> cells = centre_cells(fields, height, row);
  if (cells.empty()) return;
  const Mean mean(fields, cells);
  const dem::Estimate pressure = mean(&RingField::pressure);
  const double d = conditions.grain_diameter;
  const double bond_number = conditions.attraction / (pressure.value * d * d);
  row.state.inertial_number = mean(&RingField::inertial_number);
  row.state.softness = mean(&RingField::softness);
  row.state.bond_number = {bond_number, bond_number * pressure.error / pressure.value};
  row.state.friction = mean(&RingField::friction);
  row.state.volume_fraction = mean(&RingField::volume_fraction);
  row.shear_rate = mean(&RingField::shear_rate).value;
}

}  // namespace

BandShape band_shape(const std::vector<RotationShare>& shares, const BandShape& start) {
  const ShapeFit fit = fit_shape(shares, 0.0, start);
  return {fit.summary["R_c"].value, fit.summary["W"].value};
}

RingBand ring_band(const RingFields& fields,
                   const RingCell& cell,
                   const dem::ChuteConditions& conditions) {
  const RingGrid& grid = fields.grid;
  RingBand band;
  if (fields.values.empty()) throw FitError("a ring cell without averages over radius and height");
  const std::vector<double> fractions = mean_fractions(fields);
  const double half_bulk = half_of_bulk(fractions);
  band.height = surface(grid, fractions, half_bulk);
  band.cells_together = cells_together(grid);
  const double d = conditions.grain_diameter;
  const double first_width = d * std::cbrt(band.height / d * band.height / d);
  const double reach = grid.kernel.reach();
  for (std::size_t k = 0; k < grid.rows; ++k) {
    RingBandRow row{.z = grid.height(k), .centre = {}, .width = {}, .shares = {}, .state = {}};
    if (row.z < reach || row.z > band.height - reach) continue;
    row.shares = shares_at(fields, k, cell, half_bulk);
    try {
      if (static_cast<double>(row.shares.size()) <= 2.0 * band.cells_together)
        throw FitError("too few cells with grains");
      fit_shares(grid, cell, first_width, row);
    } catch (const FitError& error) {
      band.notes.push_back("z = " + std::to_string(row.z / d) + " d: " + error.what());
      continue;
    }
    add_state(fields, k, conditions, row);
    band.rows.push_back(std::move(row));
  }
  if (band.rows.empty()) throw FitError("no height of the ring cell shows a band");
  return band;
}

}  // namespace grainlaw::calibration
