#include "calibration/contact_series.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "calibration/bagnold_fit.h"
#include "calibration/ratio_of_law.h"

namespace grainlaw::calibration {
namespace {

dem::Estimate scaled(const dem::Estimate& estimate, double factor) {
  return {factor * estimate.value, factor * estimate.error};
}

/// Index of the level P = 0.1 (Brewster eq. 13) among those at which long lifetimes are read.
constexpr std::size_t level_of_paper = 1;
static_assert(dem::LifetimeDistribution::levels[level_of_paper] == 0.1);

void add_lifetimes(const dem::LifetimeStatistics& statistics,
                   std::size_t distance,
                   double gravity_time,
                   ContactPoint& point) {
  const dem::LifetimeDistribution& lifetimes = statistics.distances[distance];
  const double gd = statistics.shear_rate;
  point.shear_rate = gd;
  point.mean = scaled(lifetimes.mean, gd);
  point.mode = scaled(lifetimes.mode, gd);
  point.long_lifetime = lifetimes.long_lifetime[level_of_paper];
  point.tail_sampled = lifetimes.tail_sampled(level_of_paper);
  point.collision_rate = scaled(lifetimes.collision_rate, gravity_time);
  const double z = lifetimes.collision_rate.value * lifetimes.mean.value;
  point.coordination = {
      z,
      z * std::hypot(lifetimes.collision_rate.error / lifetimes.collision_rate.value,
                     lifetimes.mean.error / lifetimes.mean.value)};
  point.contacts = lifetimes.contacts;
}

ContactPoint point_of(const SeriesRun& entry,
                      std::size_t distance,
                      const continuum::RheologyTable* table) {
  const dem::LocalData& run = *entry.run;
  if (!run.window.steady) throw FitError("is not steady: " + run.window.reason);
  const dem::ChuteConditions& grains = run.conditions;
  const double diameter = grains.grain_diameter;
  const double weight = grain_weight(grains);
  const BagnoldFit fit = fit_bagnold(run, {.cohesive = grains.attraction > 0.0});
  ContactPoint point{.name = run.name, .series = entry.series};
  point.stiffness = grains.stiffness * diameter / weight;
  point.attraction = grains.attraction / weight;
  if (table) point.ratio_of_law = ratio_of_law(run, *table);
  std::copy_n(fit.variants.front().ratios.begin(), point.ratio.size(), point.ratio.begin());
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  point.shear_rate = nan;
  for (dem::Estimate* lifetime : {&point.mean,
                                  &point.mode,
                                  &point.long_lifetime,
                                  &point.collision_rate,
                                  &point.coordination}) {
    *lifetime = {nan, nan};
  }
  if (run.lifetimes && distance < run.lifetimes->distances.size()) {
    add_lifetimes(*run.lifetimes, distance, std::sqrt(diameter / grains.gravity), point);
  }
  return point;
}

using Quantity = dem::Estimate (*)(const ContactPoint&);

template <std::size_t height>
dem::Estimate ratio_at(const ContactPoint& point) {
  return {point.ratio[height].value, point.ratio[height].error};
}

dem::Estimate mean_lifetime(const ContactPoint& point) {
  return scaled(point.mean, 1.0 / point.shear_rate);
}

dem::Estimate collision_rate(const ContactPoint& point) {
  return point.collision_rate;
}

std::optional<RatioLaw> law_of_stiffness(const std::vector<const ContactPoint*>& points,
                                         Quantity quantity,
                                         const std::string& what,
                                         const RatioRule& rule,
                                         ContactSeries& series) {
  std::vector<RatioPoint> pairs;
  for (const ContactPoint* point : points) {
    const dem::Estimate value = quantity(*point);
    if (!std::isnan(value.value)) pairs.push_back({point->name, point->stiffness, value});
  }
  try {
    return fit_ratio_power_law(pairs, rule);
  } catch (const FitError& error) {
    series.left_out.push_back(points.front()->series + ", " + what +
                              " against stiffness: " + error.what());
    return std::nullopt;
  }
}

void add_stiffness_laws(ContactSeries& series, const RatioRule& rule) {
  std::vector<std::string> names;
  for (const ContactPoint& point : series.points) {
    if (std::ranges::find(names, point.series) == names.end()) names.push_back(point.series);
  }
  for (const std::string& name : names) {
    std::vector<const ContactPoint*> points;
    std::vector<double> stiffnesses;
    for (const ContactPoint& point : series.points) {
      if (point.series != name) continue;
      points.push_back(&point);
      if (std::ranges::find(stiffnesses, point.stiffness) == stiffnesses.end()) {
        stiffnesses.push_back(point.stiffness);
      }
    }
    if (stiffnesses.size() < 3) continue;
    const auto law = [&](Quantity quantity, const std::string& what, const RatioRule& chosen) {
      return law_of_stiffness(points, quantity, what, chosen, series);
    };
    StiffnessLaws laws{.series = name};
    laws.ratio = {law(ratio_at<0>, "Xi at h/4", rule),
                  law(ratio_at<1>, "Xi at h/2", rule),
                  law(ratio_at<2>, "Xi at 3h/4", rule)};
    laws.collision_rate = law(collision_rate, "N_c", {});
    laws.mean_lifetime = law(mean_lifetime, "mean lifetime", {});
    series.stiffness.push_back(std::move(laws));
  }
}

void add_lifetime_law(ContactSeries& series, const RatioRule& rule) {
  std::vector<RatioPoint> pairs;
  for (const ContactPoint& point : series.points) {
    if (!point.has_lifetimes()) continue;
    if (!point.tail_sampled) {
      series.left_out.push_back(point.name + ": too few long contacts for gd tau_l");
      continue;
    }
    pairs.push_back({point.name, point.long_lifetime.value, ratio_at<1>(point)});
  }
  try {
    series.lifetime_law = fit_ratio_exponential(pairs, rule);
  } catch (const FitError& error) {
    series.left_out.push_back(std::string("Xi against gd tau_l: ") + error.what());
  }
}

/// Longer contacts should go with larger Xi, whichever property is changed, if lifetimes are scaled
/// with the shear rate (Brewster section IV); times that are not scaled, or the most probable one,
/// should not.
void add_correlations(ContactSeries& series) {
  struct Candidate {
    std::string with;
    double (*value)(const ContactPoint&);
  };
  const std::array candidates{
      Candidate{"gd tau_l", [](const ContactPoint& p) { return p.long_lifetime.value; }},
      Candidate{"tau_l",
                [](const ContactPoint& p) { return p.long_lifetime.value / p.shear_rate; }},
      Candidate{"gd t_mode", [](const ContactPoint& p) { return p.mode.value; }},
      Candidate{"gd t_mean", [](const ContactPoint& p) { return p.mean.value; }}};
  for (const Candidate& candidate : candidates) {
    std::vector<double> x;
    std::vector<double> xi;
    for (const ContactPoint& point : series.points) {
      if (!point.tail_sampled || !std::isfinite(point.ratio[1].value)) continue;
      x.push_back(candidate.value(point));
      xi.push_back(point.ratio[1].value);
    }
    series.correlations.push_back(
        {candidate.with, rank_correlation(x, xi), static_cast<int>(x.size())});
  }
}

/// 1 for the smallest; equal values share the mean of their ranks.
std::vector<double> ranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return values[k]; });
  std::vector<double> rank(values.size());
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    for (std::size_t k = begin; k < end; ++k) {
      rank[order[k]] = 0.5 * static_cast<double>(begin + 1 + end);
    }
    begin = end;
  }
  return rank;
}

}  // namespace

double grain_weight(const dem::ChuteConditions& grains) {
  return grains.grain_density * std::numbers::pi / 6.0 * std::pow(grains.grain_diameter, 3) *
         grains.gravity;
}

double rank_correlation(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size() || x.size() < 3) return std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> a = ranks(x);
  const std::vector<double> b = ranks(y);
  const double mean = 0.5 * (static_cast<double>(x.size()) + 1.0);
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ab += (a[k] - mean) * (b[k] - mean);
    aa += (a[k] - mean) * (a[k] - mean);
    bb += (b[k] - mean) * (b[k] - mean);
  }
  if (aa == 0.0 || bb == 0.0) return std::numeric_limits<double>::quiet_NaN();  // all alike
  return ab / std::sqrt(aa * bb);
}

ContactSeries contact_series(std::span<const SeriesRun> runs,
                             std::size_t distance,
                             const RatioRule& rule,
                             const continuum::RheologyTable* table) {
  ContactSeries series;
  for (const SeriesRun& entry : runs) {
    try {
      series.points.push_back(point_of(entry, distance, table));
    } catch (const FitError& error) {
      series.left_out.push_back(entry.run->name + ": " + error.what());
    }
  }
  add_stiffness_laws(series, rule);
  add_lifetime_law(series, rule);
  add_correlations(series);
  return series;
}

}  // namespace grainlaw::calibration
