#include "apps/seed_scatter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string_view>

#include "calibration/observations.h"

namespace grainlaw {
namespace {

using calibration::FlowPoint;

/// Mean of independent runs by their shares, which sum to 1, with its error.
dem::Estimate mean(const std::vector<dem::Estimate>& values, const std::vector<double>& shares) {
  double sum = 0.0, variance = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    sum += shares[k] * values[k].value;
    variance += std::pow(shares[k] * values[k].error, 2);
  }
  return {sum, std::sqrt(variance)};
}

/// The same of runs that count alike.
dem::Estimate mean(const std::vector<dem::Estimate>& values) {
  return mean(values, std::vector(values.size(), 1.0 / static_cast<double>(values.size())));
}

/// Standard deviation of the values, by n - 1.
double scatter(const std::vector<dem::Estimate>& values) {
  const double centre = mean(values).value;
  double sum = 0.0;
  for (const dem::Estimate& value : values) sum += std::pow(value.value - centre, 2);
  return std::sqrt(sum / (static_cast<double>(values.size()) - 1.0));
}

/// Every run by the time it was averaged over: the error of its time mean falls with its root.
FlowPoint mean_point(const std::vector<FlowPoint>& points,
                     std::vector<double> times,
                     const std::string& condition) {
  if (points.size() == 1) return points.front();
  const double total = std::accumulate(times.begin(), times.end(), 0.0);
  for (double& time : times) time /= total;
  FlowPoint result = points.front();
  result.name = condition;
  for (const auto field : {&FlowPoint::friction,
                           &FlowPoint::inertial_number,
                           &FlowPoint::volume_fraction,
                           &FlowPoint::no_slip_height,
                           &FlowPoint::mass_below}) {
    std::vector<dem::Estimate> values;
    for (const FlowPoint& point : points) values.push_back(point.*field);
    result.*field = mean(values, times);
  }
  for (auto point = points.begin() + 1; point != points.end(); ++point) {
    result.softness_lower = std::min(result.softness_lower, point->softness_lower);
    result.softness_upper = std::max(result.softness_upper, point->softness_upper);
    result.blocks += point->blocks;
    result.left_out.insert(result.left_out.end(), point->left_out.begin(), point->left_out.end());
    result.notes.insert(result.notes.end(), point->notes.begin(), point->notes.end());
  }
  return result;
}

/// What is told of a run, by name.
using Numbers = std::vector<std::pair<std::string_view, dem::Estimate>>;

Numbers numbers_of(const dem::LocalData& run) {
  if (run.conditions.geometry == "simple_shear") {
    const dem::LocalRow& row = run.rows[run.rows.size() / 2];
    return {{"mu", row.friction}, {"phi", row.volume_fraction}};
  }
  const FlowPoint point = calibration::flow_point(run);
  return {{"I", point.inertial_number},
          {"phi", point.volume_fraction},
          {"no-slip height [d]", point.no_slip_height}};
}

/// The numbers of every usable run, by condition and in the order of the runs.
std::map<std::string, std::vector<Numbers>> numbers_by_condition(const CampaignData& data) {
  std::map<std::string, std::vector<Numbers>> all;
  for (const MeasuredRun& run : data.runs) {
    if (!run.data.window.steady || run.data.rows.empty()) continue;
    try {
      all[run.condition].push_back(numbers_of(run.data));
    } catch (const calibration::FitError&) {  // said where it is compared
    }
  }
  return all;
}

}  // namespace

std::vector<FlowPoint> mean_points(const CampaignData& data) {
  struct Group {
    std::string condition;
    std::vector<FlowPoint> points;
    std::vector<double> times;
  };
  std::vector<Group> groups;
  for (const MeasuredRun& run : data.runs) {
    if (!run.fitted) continue;
    auto group = std::ranges::find(groups, run.condition, &Group::condition);
    if (group == groups.end()) group = groups.insert(group, {run.condition, {}, {}});
    group->points.push_back(calibration::flow_point(run.data));
    group->times.push_back(run.data.window.end - run.data.window.begin);
  }
  std::vector<FlowPoint> means;
  for (const Group& group : groups) {
    means.push_back(mean_point(group.points, group.times, group.condition));
  }
  return means;
}

std::vector<report::SeedScatter> seed_scatter(const CampaignData& data) {
  std::vector<report::SeedScatter> result;
  for (const auto& [condition, runs] : numbers_by_condition(data)) {
    if (runs.size() < 2) continue;
    for (std::size_t k = 0; k < runs.front().size(); ++k) {
      std::vector<dem::Estimate> values;
      for (const Numbers& numbers : runs) values.push_back(numbers[k].second);
      result.push_back({.condition = condition,
                        .quantity = std::string(runs.front()[k].first),
                        .seeds = static_cast<int>(values.size()),
                        .mean = mean(values),
                        .scatter = scatter(values)});
    }
  }
  return result;
}

}  // namespace grainlaw
