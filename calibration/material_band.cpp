#include "calibration/material_band.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "calibration/box_points.h"
#include "calibration/refit.h"
#include "dem/statistics.h"

namespace grainlaw::calibration {
namespace {

/// A run with fitted points.
struct Source {
  const dem::LocalData* run = nullptr;
  std::span<const dem::ProfileFrame> frames;
  std::vector<std::size_t> points;  ///< indices
  std::size_t block = 1;            ///< [frames]
};

bool fitted(const MaterialFit& fit, std::size_t i) {
  return fit.friction_weight[i] > 0.0 || fit.fraction_weight[i] > 0.0;
}

/// Blocks as long as the slowest of mu and phi of the points takes to forget.
std::size_t block_length(const Source& source, std::span<const StatePoint> points) {
  const dem::LocalData& run = *source.run;
  std::vector<std::vector<double>> series(2 * source.points.size());
  for (const dem::ProfileFrame& frame : source.frames) {
    const auto fields = dem::coarse_grain(
        dem::mean_moments({&frame, 1}), run.frames, run.frames.kernel, run.conditions);
    for (std::size_t k = 0; k < source.points.size(); ++k) {
      const std::size_t row = field_row_at(run.frames, points[source.points[k]].place);
      series[2 * k].push_back(fields[row].friction);
      series[2 * k + 1].push_back(fields[row].volume_fraction);
    }
  }
  std::size_t longest = 1;
  for (const std::vector<double>& one : series) {
    longest = std::max(longest, dem::block_average(one).block_length);
  }
  return longest;
}

std::vector<Source> sources_of(std::span<const dem::LocalData> runs,
                               std::span<const StatePoint> points,
                               const MaterialFit& fit) {
  std::vector<Source> sources;
  std::size_t found = 0, wanted = 0;
  for (const dem::LocalData& run : runs) {
    Source source{.run = &run, .frames = dem::frames_inside(run.frames, run.window), .points = {}};
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].run == run.name && fitted(fit, i)) source.points.push_back(i);
    }
    if (source.points.empty() || source.frames.empty()) continue;
    source.block = block_length(source, points);
    found += source.points.size();
    sources.push_back(std::move(source));
  }
  for (std::size_t i = 0; i < points.size(); ++i) wanted += fitted(fit, i) ? 1 : 0;
  if (found < wanted)
    throw FitError("there are fitted points without frames to resample in blocks");
  return sources;
}

/// The points of one run from a resampled series of its frames.
void resample(const Source& source,
              std::uint64_t seed,
              std::vector<MeasuredState>& states,
              std::span<const StatePoint> points) {
  std::vector<dem::ProfileFrame> frames;
  for (const std::size_t i : moving_blocks(source.frames.size(), source.block, seed)) {
    frames.push_back(source.frames[i]);
  }
  const dem::LocalData& run = *source.run;
  const auto fields =
      dem::coarse_grain(dem::mean_moments(frames), run.frames, run.frames.kernel, run.conditions);
  for (const std::size_t i : source.points) {
    states[i] = measured_state(fields[field_row_at(run.frames, points[i].place)], run.conditions);
  }
}

/// One law: its fit, and its curve in every replicate.
class LawCurves {
 public:
  LawCurves(std::span<const StatePoint> points,
            const MaterialFit& fit,
            Quantity quantity,
            std::span<const State> states)
      : chosen_(chosen_law(fit, quantity)),
        selection_(select_fitted(points, quantity, weights_of(fit, quantity))),
        solved_(solve_law(chosen_.law, selection_.data, chosen_.active)),
        states_(states),
        curves_(states.size()) {}

  void add(const std::vector<MeasuredState>& resampled) {
    std::vector<LawDatum> data = selection_.data;
    for (std::size_t k = 0; k < data.size(); ++k) {
      const MeasuredState& measured = resampled[selection_.used[k]];
      data[k].state = measured.state;
      data[k].y =
          chosen_.quantity == Quantity::friction ? measured.friction : measured.volume_fraction;
    }
    try {
      const Slots<double> slots =
          solve_weighted(chosen_.law, data, chosen_.active, solved_.errors, solved_.slots);
      for (std::size_t i = 0; i < states_.size(); ++i) {
        curves_[i].push_back(chosen_.law.value(slots, states_[i]));
      }
      ++replicates_;
    } catch (const FitError&) {
      ++failed_;
    }
  }

  BootstrapBand band(double probability) const {
    if (replicates_ < 2) throw FitError("no resampled set of runs could be fitted");
    BootstrapBand band{.lower = {}, .upper = {}, .replicates = replicates_, .failed = failed_};
    const double wider = std::sqrt(solved_.scatter);
    const double tail = 0.5 * (1.0 - probability);
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const double centre = chosen_.law.value(solved_.slots, states_[i]);
      band.lower.push_back(centre + wider * (quantile(curves_[i], tail) - centre));
      band.upper.push_back(centre + wider * (quantile(curves_[i], 1.0 - tail) - centre));
    }
    return band;
  }

 private:
  ChosenLaw chosen_;
  PointSelection selection_;
  SolvedLaw solved_;
  std::span<const State> states_;
  std::vector<std::vector<double>> curves_;
  int replicates_ = 0;
  int failed_ = 0;
};

}  // namespace

MaterialBand material_band(std::span<const dem::LocalData> runs,
                           std::span<const StatePoint> points,
                           const MaterialFit& fit,
                           std::span<const State> states,
                           const BootstrapOptions& options) {
  const std::vector<Source> sources = sources_of(runs, points, fit);
  LawCurves friction(points, fit, Quantity::friction, states);
  LawCurves fraction(points, fit, Quantity::volume_fraction, states);
  std::mt19937_64 random(options.seed);
  std::vector<MeasuredState> resampled(points.size());
  for (int r = 0; r < options.replicates; ++r) {
    for (const Source& source : sources) resample(source, random(), resampled, points);
    friction.add(resampled);
    fraction.add(resampled);
  }
  return {.friction = friction.band(options.probability),
          .volume_fraction = fraction.band(options.probability)};
}

}  // namespace grainlaw::calibration
