#include "calibration/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <variant>

#include "calibration/mu_phi_fit.h"
#include "calibration/observations.h"

namespace grainlaw::calibration {
namespace {

std::vector<dem::ProfileFrame> steady_frames(const dem::LocalData& run) {
  const double rounding = 1e-9 * std::max(1.0, std::abs(run.window.end));
  std::vector<dem::ProfileFrame> frames;
  for (const dem::ProfileFrame& frame : run.frames.frames) {
    if (frame.begin < run.window.begin - rounding || frame.end > run.window.end + rounding)
      continue;
    frames.push_back(frame);
  }
  return frames;
}

/// mu(I) of one replicate.
std::vector<double> replicate(std::span<const dem::LocalData> runs,
                              const std::vector<double>& inertial_numbers,
                              const RowSelection& selection,
                              std::mt19937_64& random) {
  std::vector<dem::LocalData> resampled;
  for (const dem::LocalData& run : runs) resampled.push_back(resample(run, random()));
  const MuPhiFit fit = fit_mu_phi(resampled, selection);
  std::vector<double> curve;
  for (const double I : inertial_numbers) {
    curve.push_back(continuum::friction(std::get<continuum::MuPhi>(fit.table.law), I));
  }
  return curve;
}

}  // namespace

std::vector<std::size_t> moving_blocks(std::size_t length, std::size_t block, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::size_t size = std::clamp<std::size_t>(block, 1, length);
  std::vector<std::size_t> indices;
  while (indices.size() < length) {
    const std::size_t first = random() % (length - size + 1);
    for (std::size_t k = 0; k < size && indices.size() < length; ++k) indices.push_back(first + k);
  }
  return indices;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double at = share * (static_cast<double>(values.size()) - 1.0);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

dem::LocalData resample(const dem::LocalData& run, std::uint64_t seed) {
  const std::vector<dem::ProfileFrame> frames = steady_frames(run);
  const std::size_t blocks = dem::block_velocities(run).size();
  if (frames.empty() || blocks < 2) {
    throw FitError("run '" + run.name + "' has no frames to resample in blocks");
  }
  dem::LocalData result = run;
  result.frames.frames.clear();
  double time = run.window.begin;
  for (const std::size_t i : moving_blocks(frames.size(), frames.size() / blocks, seed)) {
    dem::ProfileFrame frame = frames[i];
    const double duration = frame.end - frame.begin;
    frame.begin = time;
    frame.end = time += duration;
    result.frames.frames.push_back(frame);
  }
  result.window.end = time;
  result.rows = dem::average(result.frames, result.conditions, result.window);
  return result;
}

BootstrapBand friction_band(std::span<const dem::LocalData> runs,
                            const std::vector<double>& inertial_numbers,
                            const BootstrapOptions& options,
                            const RowSelection& selection) {
  std::mt19937_64 random(options.seed);
  std::vector<std::vector<double>> curves(inertial_numbers.size());
  BootstrapBand band;
  for (int r = 0; r < options.replicates; ++r) {
    try {
      const std::vector<double> curve = replicate(runs, inertial_numbers, selection, random);
      for (std::size_t i = 0; i < curve.size(); ++i) curves[i].push_back(curve[i]);
      ++band.replicates;
    } catch (const FitError&) {
      ++band.failed;
    }
  }
  if (band.replicates < 2) throw FitError("no resampled set of runs could be fitted");
  const double tail = 0.5 * (1.0 - options.probability);
  for (const std::vector<double>& values : curves) {
    band.lower.push_back(quantile(values, tail));
    band.upper.push_back(quantile(values, 1.0 - tail));
  }
  return band;
}

}  // namespace grainlaw::calibration
