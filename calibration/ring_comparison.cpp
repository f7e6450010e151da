#include "calibration/ring_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainlaw::calibration {
namespace {

using continuum::RheologyTable;
using continuum::RingFlow;
using continuum::RingFlowCase;

/// For what follows from differences of solutions, in which most of the discretisation cancels: A
/// fitted to the dry cell of Shi et al. (2020) is 0.4436 with these cells and 0.4446 with halves.
constexpr continuum::RingFlowOptions wide_cells{.cell_width = 0.5};

/// Predicted share of every cell, height by height.
std::vector<double> shares_of(const RingFlow& flow, const RingBand& measured) {
  std::vector<double> shares;
  for (const RingBandRow& row : measured.rows)
    for (const RotationShare& share : row.shares)
      shares.push_back(flow.rotation_at(share.radius, row.z));
  return shares;
}

std::vector<RotationShare> cells_of(const RingBand& measured) {
  std::vector<RotationShare> cells;
  for (const RingBandRow& row : measured.rows)
    cells.insert(cells.end(), row.shares.begin(), row.shares.end());
  return cells;
}

/// Root of the mean of (r value)^2 over that of the measured velocities.
class RelativeNorm {
 public:
  explicit RelativeNorm(const std::vector<RotationShare>& cells) : cells_(cells) {
    for (const RotationShare& cell : cells) sum_ += std::pow(cell.radius * cell.value, 2);
  }
  template <class Value>
  double operator()(Value value) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < cells_.size(); ++i) sum += std::pow(cells_[i].radius * value(i), 2);
    return std::sqrt(sum / sum_);
  }

 private:
  const std::vector<RotationShare>& cells_;
  double sum_ = 0.0;
};

/// Variance of every predicted share by the covariance of the table; empty where it states none or
/// a step of a coefficient leaves the steady flows.
std::vector<double> law_variance(const RheologyTable& table,
                                 const RingFlowCase& ring,
                                 const RingBand& measured) {
  constexpr double step_in_errors = 0.1;  // shares are known to 1e-6 and move by percents
  if (!table.covariance) return {};
  const continuum::Covariance& covariance = *table.covariance;
  const std::size_t size = covariance.names.size();
  const std::vector<double> shares =
      shares_of(continuum::ring_flow(table, ring, wide_cells), measured);
  std::vector<std::vector<double>> change(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double error = std::sqrt(covariance(i, i));
    if (error == 0.0) continue;
    RheologyTable other = table;
    const std::string& name = covariance.names[i];
    set_coefficient(other, name, coefficient(table, name) + step_in_errors * error);
    other.covariance.reset();
    const RingFlow moved = continuum::ring_flow(other, ring, wide_cells);
    if (!continuum::flows(moved.answer.outcome)) return {};
    change[i] = shares_of(moved, measured);
    for (std::size_t k = 0; k < shares.size(); ++k)
      change[i][k] = (change[i][k] - shares[k]) / (step_in_errors * error);
  }
  std::vector<double> variance(shares.size(), 0.0);
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      if (change[i].empty() || change[j].empty()) continue;
      for (std::size_t k = 0; k < shares.size(); ++k)
        variance[k] += covariance(i, j) * change[i][k] * change[j][k];
    }
  }
  return variance;
}

std::vector<BandShape> shapes(const RingBand& measured, const std::vector<double>& predicted) {
  std::vector<BandShape> result;
  std::size_t first = 0;
  for (const RingBandRow& row : measured.rows) {
    std::vector<RotationShare> shares = row.shares;
    for (std::size_t i = 0; i < shares.size(); ++i) shares[i].value = predicted[first + i];
    first += shares.size();
    try {
      result.push_back(band_shape(shares, {row.centre.value, row.width.value}));
    } catch (const FitError&) {
      constexpr double nan = std::numeric_limits<double>::quiet_NaN();
      result.push_back({nan, nan});
    }
  }
  return result;
}

}  // namespace

RingComparison compare_ring(const RingBand& measured,
                            const RingFlow& predicted,
                            const RheologyTable& table,
                            const RingFlowCase& ring) {
  if (predicted.rotation.empty()) throw FitError("nothing to compare: " + predicted.answer.text);
  const std::vector<RotationShare> cells = cells_of(measured);
  const std::vector<double> shares = shares_of(predicted, measured);
  const RelativeNorm norm(cells);
  const auto difference = [&](std::size_t i) { return shares[i] - cells[i].value; };
  RingComparison result;
  result.velocity.value = norm(difference);
  double slope = 0.0, largest = 0.0, velocity = 0.0, in_errors = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double r = cells[i].radius;
    slope += std::pow(r * r * difference(i) * cells[i].error, 2);
    in_errors += std::pow(difference(i) / cells[i].error, 2);
    velocity = std::max(velocity, r * cells[i].value);
    if (r * std::abs(difference(i)) <= largest) continue;
    largest = r * std::abs(difference(i));
    result.velocity_maximum.error = r * cells[i].error;
  }
  double sum = 0.0;
  for (const RotationShare& cell : cells) sum += std::pow(cell.radius * cell.value, 2);
  result.velocity.error =
      measured.cells_together * std::sqrt(slope) / (result.velocity.value * sum);
  result.velocity_maximum.value = largest / velocity;
  result.velocity_maximum.error /= velocity;
  result.in_standard_errors = std::sqrt(in_errors / static_cast<double>(cells.size()));
  const std::vector<double> variance = law_variance(table, ring, measured);
  result.budget = {.total = result.velocity.value,
                   .statistics = norm([&](std::size_t i) { return cells[i].error; }),
                   .law = variance.empty() ? 0.0 : norm([&](std::size_t i) {
                     return std::sqrt(std::max(0.0, variance[i]));
                   }),
                   .numerics = predicted.discretisation_error};
  result.rows = shapes(measured, shares);
  return result;
}

NonlocalFit fit_nonlocal_amplitude(const RheologyTable& table,
                                   const RingFlowCase& ring,
                                   const RingBand& measured) {
  const auto apart = static_cast<std::size_t>(std::ceil(measured.cells_together));
  RingBand thinned = measured;
  thinned.rows.clear();
  for (std::size_t k = 0; k < measured.rows.size(); k += apart) {
    thinned.rows.push_back(measured.rows[k]);
    auto& shares = thinned.rows.back().shares;
    shares.clear();
    for (std::size_t i = 0; i < measured.rows[k].shares.size(); i += apart)
      shares.push_back(measured.rows[k].shares[i]);
  }
  std::vector<BandPoint> points;
  for (const RotationShare& cell : cells_of(thinned))
    points.push_back({.position = cell.radius,
                      .velocity = cell.radius * cell.value,
                      .error = cell.radius * cell.error});
  const auto velocities = [&](double amplitude) {
    RingFlowCase at = ring;
    at.nonlocal_amplitude = amplitude;
    const RingFlow flow = continuum::ring_flow(table, at, wide_cells);
    if (!continuum::flows(flow.answer.outcome)) return std::vector<double>{};
    std::vector<double> result = shares_of(flow, thinned);
    for (std::size_t i = 0; i < points.size(); ++i) result[i] *= points[i].position;
    return result;
  };
  return fit_nonlocal_amplitude(points, velocities, 1e-2);
}

}  // namespace grainlaw::calibration
