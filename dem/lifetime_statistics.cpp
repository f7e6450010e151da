#include "dem/lifetime_statistics.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace grainlaw::dem {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void add_scaled(LifetimeTally& sum, const LifetimeTally& tally, double factor) {
  sum.begun += factor * tally.begun;
  sum.unknown += factor * tally.unknown;
  for (std::size_t k = 0; k < sum.bins.size(); ++k) {
    LifetimeCounts& to = sum.bins[k];
    const LifetimeCounts& from = tally.bins[k];
    to.ended += factor * from.ended;
    to.entered += factor * from.entered;
    to.lifetime += factor * from.lifetime;
    to.touches += factor * from.touches;
    to.slides += factor * from.slides;
    to.shear += factor * from.shear;
    to.normal += factor * from.normal;
  }
}

/// Some blocks added up.
struct Total {
  double time = 0.0;
  double samples = 0.0;
  double grains = 0.0;
  LifetimeTally tally;

  void add(const LifetimeBlock& block, std::size_t distance, double factor) {
    time += factor * (block.end - block.begin);
    samples += factor * block.samples;
    grains += factor * block.grains;
    add_scaled(tally, block.distances[distance], factor);
  }
};

/// Probability to end in every bin; what is left over never was seen to end.
std::vector<double> probabilities(const LifetimeTally& tally) {
  std::vector<double> result(tally.bins.size(), 0.0);
  double at_risk = tally.begun;
  double survivors = 1.0;
  for (std::size_t k = 0; k < result.size(); ++k) {
    const LifetimeCounts& bin = tally.bins[k];
    const double exposed = at_risk + 0.5 * bin.entered;
    if (bin.ended > 0.0 && exposed > 0.0) {
      result[k] = survivors * std::min(1.0, bin.ended / exposed);
      survivors -= result[k];
    }
    at_risk += bin.entered - bin.ended;
  }
  return result;
}

double mean_age(const LifetimeCounts& bin) {
  return bin.lifetime / bin.ended;
}

/// The mean of those that end; what outlives all of them counts with the age of the last.
double mean_lifetime(const LifetimeTally& tally, const std::vector<double>& probability) {
  double sum = 0.0, left = 1.0, oldest = nan;
  for (std::size_t k = 0; k < probability.size(); ++k) {
    if (probability[k] == 0.0) continue;
    oldest = mean_age(tally.bins[k]);
    sum += probability[k] * oldest;
    left -= probability[k];
  }
  return sum + std::max(0.0, left) * oldest;
}

std::size_t most_probable(const LifetimeAxis& axis, const std::vector<double>& probability) {
  const auto density = [&](std::size_t k) {
    return probability[k] / (axis.end(k) - axis.begin(k));
  };
  std::size_t mode = 0;
  for (std::size_t k = 1; k < probability.size(); ++k) {
    if (density(k) > density(mode)) mode = k;
  }
  return mode;
}

/// A stretch of bins with enough contacts for a density, and where that holds.
struct TailPoint {
  double age = 0.0;      ///< half way from the mean of its contacts to its middle: there an
                         ///< exponential has its mean density, to second order [time]
  double density = 0.0;  ///< [1/time]
};

/// From the longest lives down.
std::vector<TailPoint> tail(const LifetimeAxis& axis,
                            const LifetimeTally& tally,
                            const std::vector<double>& probability) {
  // A tenth of error. With 25, neighbours scatter by more than the density falls between them, and
  // the last one above a level lies too far out.
  constexpr double enough = 100.0;
  std::vector<TailPoint> points;
  double ended = 0.0, lifetime = 0.0, share = 0.0;
  std::size_t end = probability.size();
  while (end > 0 && tally.bins[end - 1].ended <= 0.0) --end;
  for (std::size_t k = end; k-- > 0;) {
    ended += tally.bins[k].ended;
    lifetime += tally.bins[k].lifetime;
    share += probability[k];
    if (ended < enough) continue;
    const double from = axis.begin(k), to = axis.end(end - 1);
    points.push_back({0.5 * (lifetime / ended + 0.5 * (from + to)), share / (to - from)});
    ended = lifetime = share = 0.0;
    end = k;
  }
  return points;
}

/// The longest age at which the density [1/time] has the level, between two points as an
/// exponential; NaN where it lies beyond what was seen.
double age_at_density(const std::vector<TailPoint>& points, double level) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (points[k].density < level) continue;
    if (k == 0) return nan;
    const TailPoint& low = points[k - 1];
    const TailPoint& high = points[k];
    const double share = std::log(high.density / level) / std::log(high.density / low.density);
    return high.age + share * (low.age - high.age);
  }
  return nan;
}

/// Sums over the contacts on both sides of an age.
struct Split {
  LifetimeCounts binary, lasting;
};

Split split_at(const LifetimeTally& tally, std::size_t first_long) {
  Split split;
  for (std::size_t k = 0; k < tally.bins.size(); ++k) {
    LifetimeCounts& to = k < first_long ? split.binary : split.lasting;
    const LifetimeCounts& bin = tally.bins[k];
    to.touches += bin.touches;
    to.slides += bin.slides;
    to.shear += bin.shear;
    to.normal += bin.normal;
  }
  return split;
}

/// Places of the numbers that get an error.
namespace at {
enum Place : std::size_t {
  mean,
  mode,
  rate,
  long_lifetime,  // three
  long_share = long_lifetime + LifetimeDistribution::levels.size(),
  long_shear,
  long_normal,
  long_sliding,
  short_sliding,
  density,  // of every bin
};
}

std::vector<double> measures(const LifetimeAxis& axis,
                             const Total& total,
                             std::size_t first_long,
                             double shear_rate) {
  const LifetimeTally& tally = total.tally;
  const std::vector<double> probability = probabilities(tally);
  const Split split = split_at(tally, first_long);
  const auto long_part = [&](double LifetimeCounts::*part) {
    return split.lasting.*part / (split.lasting.*part + split.binary.*part);
  };
  const auto from = probability.begin() + static_cast<std::ptrdiff_t>(first_long);
  std::vector<double> m(at::density + probability.size());
  m[at::mean] = mean_lifetime(tally, probability);
  m[at::mode] = mean_age(tally.bins[most_probable(axis, probability)]);
  m[at::rate] = 2.0 * tally.begun / (total.grains / total.samples * total.time);
  const auto points = tail(axis, tally, probability);
  for (std::size_t k = 0; k < LifetimeDistribution::levels.size(); ++k) {
    m[at::long_lifetime + k] =
        shear_rate * age_at_density(points, shear_rate * LifetimeDistribution::levels[k]);
  }
  m[at::long_share] = 1.0 - std::accumulate(probability.begin(), from, 0.0);
  m[at::long_shear] = long_part(&LifetimeCounts::shear);
  m[at::long_normal] = long_part(&LifetimeCounts::normal);
  m[at::long_sliding] = split.lasting.slides / split.lasting.touches;
  m[at::short_sliding] = split.binary.slides / split.binary.touches;
  for (std::size_t k = 0; k < probability.size(); ++k) {
    m[at::density + k] = probability[k] / (shear_rate * (axis.end(k) - axis.begin(k)));
  }
  return m;
}

/// Standard errors of all measures: what they become when one group of blocks is left out.
template <class Measures>
std::vector<double> jackknife(std::span<const LifetimeBlock> blocks,
                              std::size_t distance,
                              const Total& all,
                              std::size_t count,
                              Measures&& measured) {
  constexpr std::size_t most_groups = 20, least_groups = 4;
  const std::size_t groups = std::min(most_groups, blocks.size());
  if (groups < least_groups) return std::vector<double>(count, nan);
  std::vector<double> sum(count, 0.0), squares(count, 0.0);
  for (std::size_t g = 0; g < groups; ++g) {
    Total rest = all;
    for (std::size_t b = g * blocks.size() / groups; b < (g + 1) * blocks.size() / groups; ++b) {
      rest.add(blocks[b], distance, -1.0);
    }
    const std::vector<double> m = measured(rest);
    for (std::size_t k = 0; k < count; ++k) {
      const double before = sum[k] / static_cast<double>(std::max<std::size_t>(1, g));
      sum[k] += m[k];
      // Welford: without the cancellation of a mean square less a squared mean
      squares[k] += (m[k] - before) * (m[k] - sum[k] / static_cast<double>(g + 1));
    }
  }
  const auto n = static_cast<double>(groups);
  for (double& s : squares) s = std::sqrt((n - 1.0) / n * s);
  return squares;
}

double contacts_beyond(const LifetimeAxis& axis, const LifetimeTally& tally, double age) {
  if (!std::isfinite(age)) return 0.0;
  double sum = 0.0;
  for (std::size_t k = axis.bin(age) + 1; k < tally.bins.size(); ++k) sum += tally.bins[k].ended;
  return sum;
}

std::vector<LifetimeRow> rows(const LifetimeAxis& axis,
                              const LifetimeTally& tally,
                              const std::vector<double>& value,
                              const std::vector<double>& error) {
  double shear = 0.0, normal = 0.0;
  std::size_t first = tally.bins.size(), last = 0;
  for (std::size_t k = 0; k < tally.bins.size(); ++k) {
    shear += tally.bins[k].shear;
    normal += tally.bins[k].normal;
    if (tally.bins[k].ended <= 0.0) continue;
    first = std::min(first, k);
    last = k;
  }
  std::vector<LifetimeRow> result;
  for (std::size_t k = first; k <= last && k < tally.bins.size(); ++k) {
    const LifetimeCounts& bin = tally.bins[k];
    result.push_back({.begin = axis.begin(k),
                      .end = axis.end(k),
                      .contacts = bin.ended,
                      .density = {value[at::density + k], error[at::density + k]},
                      .shear_share = bin.shear / shear,
                      .normal_share = bin.normal / normal});
  }
  return result;
}

}  // namespace

std::size_t LifetimeAxis::bin(double age) const {
  const double octaves = std::log2(age / contact_time) + octaves_below;
  if (!(octaves > 0.0)) return 0;
  return static_cast<std::size_t>(std::min(octaves * per_octave, static_cast<double>(bins - 1)));
}

LifetimeDistribution lifetime_distribution(const LifetimeAxis& axis,
                                           std::span<const LifetimeBlock> blocks,
                                           std::size_t distance,
                                           double shear_rate) {
  LifetimeDistribution result;
  Total all;
  for (const LifetimeBlock& block : blocks) all.add(block, distance, 1.0);
  const LifetimeTally& tally = all.tally;
  for (const LifetimeCounts& bin : tally.bins) result.contacts += bin.ended;
  result.unknown = tally.unknown;
  if (!blocks.empty()) result.unfinished = blocks.back().distances[distance].unfinished;
  if (result.contacts == 0.0) return result;

  const std::vector<double> probability = probabilities(tally);
  const std::size_t first_long =
      std::min(most_probable(axis, probability) + LifetimeAxis::per_octave, LifetimeAxis::bins);
  const auto measured = [&](const Total& total) {
    return measures(axis, total, first_long, shear_rate);
  };
  const std::vector<double> value = measured(all);
  const std::vector<double> error = jackknife(blocks, distance, all, value.size(), measured);
  const auto estimate = [&](std::size_t k) { return Estimate{value[k], error[k]}; };
  result.survivors =
      std::max(0.0, 1.0 - std::accumulate(probability.begin(), probability.end(), 0.0));
  result.mean = estimate(at::mean);
  result.mode = estimate(at::mode);
  result.collision_rate = estimate(at::rate);
  for (std::size_t k = 0; k < result.levels.size(); ++k) {
    result.long_lifetime[k] = estimate(at::long_lifetime + k);
    result.beyond[k] = contacts_beyond(axis, tally, result.long_lifetime[k].value / shear_rate);
  }
  result.split = axis.begin(first_long);
  result.long_share = estimate(at::long_share);
  result.long_shear = estimate(at::long_shear);
  result.long_normal = estimate(at::long_normal);
  result.long_sliding = estimate(at::long_sliding);
  result.short_sliding = estimate(at::short_sliding);
  result.rows = rows(axis, tally, value, error);
  return result;
}

}  // namespace grainlaw::dem
