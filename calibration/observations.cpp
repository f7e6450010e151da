#include "calibration/observations.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <utility>

#include "calibration/fit_summary.h"
#include "dem/statistics.h"

namespace grainlaw::calibration {
namespace {

constexpr std::size_t fewest_rows = 4;

bool complete(const dem::LocalRow& row) {
  for (const double value : {row.z,
                             row.mass_above,
                             row.velocity.value,
                             row.shear_rate.value,
                             row.volume_fraction.value,
                             row.shear_stress.value,
                             row.normal_stress.value}) {
    if (!std::isfinite(value)) return false;
  }
  return row.normal_stress.value > 0.0;
}

/// "3 rows, z = 0.5 to 2.5 (reason)"; nothing for no rows.
void report(const dem::LocalData& data,
            const std::vector<std::size_t>& rows,
            const std::string& reason,
            std::vector<std::string>& left_out) {
  if (rows.empty()) return;
  std::ostringstream text;
  text << data.name << ": " << rows.size() << (rows.size() == 1 ? " row" : " rows")
       << " at z = " << data.rows[rows.front()].z;
  if (rows.size() > 1) text << " to " << data.rows[rows.back()].z;
  text << ", " << reason;
  left_out.push_back(text.str());
}

void require_steady(const dem::LocalData& data) {
  if (data.window.steady) return;
  throw FitError("run '" + data.name + "' is not steady (" +
                 (data.window.reason.empty() ? "no reason given" : data.window.reason) +
                 "): only steady flow obeys the force balance that the fit rests on; run it longer "
                 "or choose a tilt that flows steadily");
}

void require_enough(const dem::LocalData& data, const Observations& observations) {
  if (observations.rows.size() >= fewest_rows) return;
  std::ostringstream text;
  text << "run '" << data.name << "' has " << observations.rows.size() << " usable rows of "
       << data.rows.size() << ", at least " << fewest_rows
       << " are needed: use a deeper layer or smaller bins";
  for (const std::string& reason : observations.left_out) text << "; " << reason;
  throw FitError(text.str());
}

template <class Number>
double mean(const std::vector<dem::LocalRow>& rows,
            const std::vector<std::size_t>& chosen,
            Number number) {
  double sum = 0.0;
  for (const std::size_t k : chosen) sum += number(rows[k]);
  return sum / static_cast<double>(chosen.size());
}

void add(dem::LocalRow& sum, const dem::LocalRow& row) {
  sum.mass_above += row.mass_above;
  sum.velocity.value += row.velocity.value;
  sum.shear_rate.value += row.shear_rate.value;
  sum.volume_fraction.value += row.volume_fraction.value;
  sum.shear_stress.value += row.shear_stress.value;
  sum.normal_stress.value += row.normal_stress.value;
}

void divide(dem::LocalRow& sum, double count) {
  sum.mass_above /= count;
  sum.velocity.value /= count;
  sum.shear_rate.value /= count;
  sum.volume_fraction.value /= count;
  sum.shear_stress.value /= count;
  sum.normal_stress.value /= count;
  sum.friction.value = sum.shear_stress.value / sum.normal_stress.value;
}

dem::LocalRow zero_row(double z) {
  dem::LocalRow row;
  row.z = z;
  for (dem::Estimate* field : {&row.velocity,
                               &row.shear_rate,
                               &row.volume_fraction,
                               &row.shear_stress,
                               &row.normal_stress}) {
    field->value = 0.0;
  }
  return row;
}

/// The frames that the steady window holds entirely.
std::vector<dem::ProfileFrame> steady_frames(const dem::LocalData& data) {
  // A frame ends where the window ends: compare with the rounding of the clock.
  const double rounding = 1e-9 * std::max(1.0, std::abs(data.window.end));
  std::vector<dem::ProfileFrame> frames;
  for (const dem::ProfileFrame& frame : data.frames.frames) {
    const bool inside =
        frame.begin >= data.window.begin - rounding && frame.end <= data.window.end + rounding;
    if (inside) frames.push_back(frame);
  }
  return frames;
}

/// The same bins with other frames.
dem::ProfileFrames with_frames(const dem::ProfileFrames& like,
                               std::vector<dem::ProfileFrame> frames) {
  return {.z_begin = like.z_begin,
          .bin_width = like.bin_width,
          .frames = std::move(frames),
          .bins_per_row = like.bins_per_row,
          .periodic = like.periodic,
          .kernel = like.kernel};
}

dem::LocalRow empty_row(const dem::LocalRow& like) {
  dem::LocalRow row;
  row.z = like.z;
  row.mass_above = like.mass_above;
  return row;
}

/// The rows of `block` at the heights of the whole run; no values where the block has no such row.
std::vector<dem::LocalRow> align(const std::vector<dem::LocalRow>& block,
                                 const std::vector<dem::LocalRow>& whole,
                                 double row_width) {
  std::vector<dem::LocalRow> aligned;
  for (const dem::LocalRow& row : whole) {
    const auto found = std::find_if(block.begin(), block.end(), [&](const dem::LocalRow& other) {
      return std::abs(other.z - row.z) < 0.25 * row_width;
    });
    // Bins of the saltating layer may be empty for a block; such a row has no value there.
    aligned.push_back(found == block.end() ? empty_row(row) : *found);
  }
  return aligned;
}

}  // namespace

Observations select_rows(const dem::LocalData& data, const RowSelection& selection) {
  require_steady(data);
  std::vector<std::size_t> incomplete, base, dilute, bulk;
  std::vector<double> fractions;
  const double lowest = selection.above_base * data.conditions.grain_diameter;
  for (std::size_t k = 0; k < data.rows.size(); ++k) {
    if (!complete(data.rows[k])) {
      incomplete.push_back(k);
    } else if (data.rows[k].z < lowest) {
      base.push_back(k);
    } else {
      bulk.push_back(k);
      fractions.push_back(data.rows[k].volume_fraction.value);
    }
  }
  // The median: the few dilute rows below the surface do not move it.
  const double densest = median(fractions);
  Observations result;
  for (const std::size_t k : bulk) {
    const double fraction = data.rows[k].volume_fraction.value;
    (fraction < selection.dilute_fraction * densest ? dilute : result.rows).push_back(k);
  }
  report(data, incomplete, "a field is not a number or not positive", result.left_out);
  report(data, base, "too close to the rough base", result.left_out);
  report(data, dilute, "too dilute for the dense law (saltating layer)", result.left_out);
  require_enough(data, result);
  result.bulk_volume_fraction = mean(
      data.rows, result.rows, [](const dem::LocalRow& row) { return row.volume_fraction.value; });
  return result;
}

std::vector<std::vector<dem::LocalRow>> block_rows(const dem::LocalData& data) {
  const std::vector<dem::ProfileFrame> frames = steady_frames(data);
  if (frames.empty()) return {};
  const std::size_t count = dem::block_velocities(data).size();
  if (count < 2 || count > frames.size()) return {};
  std::vector<std::vector<dem::LocalRow>> blocks;
  for (std::size_t b = 0; b < count; ++b) {
    const auto first = frames.begin() + static_cast<std::ptrdiff_t>(b * frames.size() / count);
    const auto last = frames.begin() + static_cast<std::ptrdiff_t>((b + 1) * frames.size() / count);
    const dem::ProfileFrames part = with_frames(data.frames, {first, last});
    const dem::SteadyWindow window{true, part.frames.front().begin, part.frames.back().end, ""};
    blocks.push_back(
        align(dem::average(part, data.conditions, window), data.rows, data.frames.row_width()));
  }
  return blocks;
}

std::vector<std::vector<dem::LocalRow>> blocks_for_fit(const dem::LocalData& data) {
  constexpr std::size_t fewest_blocks = 4;
  std::vector<std::vector<dem::LocalRow>> blocks = block_rows(data);
  if (data.frames.frames.empty() || blocks.size() >= fewest_blocks) return blocks;
  throw FitError("run '" + data.name + "' has " + std::to_string(blocks.size()) +
                 " independent blocks in its steady window, at least " +
                 std::to_string(fewest_blocks) +
                 " are needed for standard errors: average over a longer time");
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<dem::LocalRow> mean_without(const std::vector<std::vector<dem::LocalRow>>& blocks,
                                        std::size_t left_out) {
  std::vector<dem::LocalRow> means;
  for (const dem::LocalRow& row : blocks.front()) means.push_back(zero_row(row.z));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (std::size_t k = 0; b != left_out && k < means.size(); ++k) add(means[k], blocks[b][k]);
  }
  for (dem::LocalRow& row : means) divide(row, static_cast<double>(blocks.size() - 1));
  return means;
}

double jackknife_error(const std::vector<double>& without) {
  const auto n = static_cast<double>(without.size());
  const double centre = std::accumulate(without.begin(), without.end(), 0.0) / n;
  double sum = 0.0;
  for (const double value : without) sum += (value - centre) * (value - centre);
  constexpr double one_sigma = 0.841345;  // of a normal distribution, one-sided
  const double few_blocks = dem::student_quantile(one_sigma, static_cast<int>(without.size()) - 1);
  return few_blocks * std::sqrt((n - 1.0) / n * sum);
}

void MassColumn::add(double z, double mass) {
  z_.push_back(z);
  mass_.push_back(mass);
}

MassColumn::MassColumn(const std::vector<dem::LocalRow>& rows, double grain_density) {
  std::vector<const dem::LocalRow*> known;
  for (const dem::LocalRow& row : rows) {
    if (std::isfinite(row.mass_above) && row.volume_fraction.value > 0.0) known.push_back(&row);
  }
  if (known.size() < 2) throw FitError("a mass column needs at least two rows with grains in them");
  const auto half_bin = [&](std::size_t k, double width) {
    return 0.5 * width * grain_density * known[k]->volume_fraction.value;
  };
  const double first = known[1]->z - known[0]->z;
  add(known[0]->z - 0.5 * first, known[0]->mass_above + half_bin(0, first));
  for (std::size_t k = 0; k + 1 < known.size(); ++k) {
    const double width = known[k + 1]->z - known[k]->z;
    const double from_below = known[k]->mass_above - half_bin(k, width);
    const double from_above = known[k + 1]->mass_above + half_bin(k + 1, width);
    add(known[k]->z, known[k]->mass_above);
    add(known[k]->z + 0.5 * width, 0.5 * (from_below + from_above));
  }
  add(known.back()->z, known.back()->mass_above);
}

double MassColumn::height(double mass_above) const {
  std::size_t k = 0;
  while (k + 2 < z_.size() && mass_[k + 1] > mass_above) ++k;
  return z_[k] + (z_[k + 1] - z_[k]) * (mass_above - mass_[k]) / (mass_[k + 1] - mass_[k]);
}

double MassColumn::mass_above(double z) const {
  std::size_t k = 0;
  while (k + 2 < z_.size() && z_[k + 1] < z) ++k;
  return mass_[k] + (mass_[k + 1] - mass_[k]) * (z - z_[k]) / (z_[k + 1] - z_[k]);
}

std::vector<double> weight_errors(const std::vector<dem::Estimate>& estimates) {
  std::vector<double> errors, positive;
  double largest = 0.0;
  for (const dem::Estimate& estimate : estimates) {
    const double error = std::isfinite(estimate.error) ? estimate.error : 0.0;
    errors.push_back(error);
    if (error > 0.0) positive.push_back(error);
    largest = std::max(largest, std::abs(estimate.value));
  }
  const double floor = positive.empty() ? 1e-6 * largest : 0.1 * median(positive);
  for (double& error : errors) error = std::max(error, floor);
  return errors;
}

std::vector<double> weight_errors(const std::vector<dem::LocalRow>& rows,
                                  const std::vector<std::size_t>& chosen,
                                  dem::Estimate dem::LocalRow::*field) {
  std::vector<dem::Estimate> estimates;
  estimates.reserve(chosen.size());
  for (const std::size_t k : chosen) estimates.push_back(rows[k].*field);
  return weight_errors(estimates);
}

std::optional<continuum::Range> range(const dem::LocalData& data,
                                      const Observations& observations,
                                      dem::Estimate dem::LocalRow::*field) {
  std::optional<continuum::Range> result;
  for (const std::size_t k : observations.rows) {
    const double value = (data.rows[k].*field).value;
    if (!std::isfinite(value)) continue;
    if (!result) result = continuum::Range{value, value};
    result->lower = std::min(result->lower, value);
    result->upper = std::max(result->upper, value);
  }
  return result;
}

}  // namespace grainlaw::calibration
