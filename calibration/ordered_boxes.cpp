#include "calibration/ordered_boxes.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "calibration/observations.h"

namespace grainlaw::calibration {
namespace {

constexpr double alike = 1.05;
constexpr std::size_t fewest = 5;
constexpr double apart = 6.0;

bool close(const dem::Estimate& one, const dem::Estimate& other) {
  return std::max(one.value, other.value) <= alike * std::min(one.value, other.value);
}

bool same_state(const StatePoint& one, const StatePoint& other) {
  return close(one.inertial_number, other.inertial_number) && close(one.softness, other.softness) &&
         close(one.bond_number, other.bond_number);
}

/// Middle of a measured number over points, and its spread.
struct Spread {
  double middle = 0.0;
  double size = 0.0;

  Spread(const std::vector<StatePoint*>& points, dem::Estimate StatePoint::*number) {
    std::vector<double> values, distances, errors;
    for (const StatePoint* point : points) {
      values.push_back((point->*number).value);
      errors.push_back((point->*number).error);
    }
    middle = median(values);
    for (const double value : values) distances.push_back(std::abs(value - middle));
    size = std::max(1.4826 * median(distances), median(errors));
  }
  double operator()(double value) const { return (value - middle) / size; }
};

std::string sentence(const StatePoint& point, const Spread& friction, std::size_t seeds) {
  std::ostringstream text;
  text.precision(3);
  text << "ordered: mu " << point.friction.value << " and phi " << point.volume_fraction.value
       << ", less friction and denser than the other " << seeds - 1 << " runs of this state (mu "
       << friction.middle << ") by more than six of their spreads";
  return text.str();
}

}  // namespace

void mark_ordered(std::span<StatePoint> points) {
  std::vector<StatePoint*> open;
  for (StatePoint& point : points)
    if (point.unfit.empty()) open.push_back(&point);
  while (!open.empty()) {
    const StatePoint& first = *open.front();
    const auto others = std::stable_partition(
        open.begin(), open.end(), [&](const StatePoint* p) { return same_state(*p, first); });
    const std::vector<StatePoint*> same(open.begin(), others);
    open.erase(open.begin(), others);
    if (same.size() < fewest) continue;
    const Spread friction(same, &StatePoint::friction);
    const Spread fraction(same, &StatePoint::volume_fraction);
    for (StatePoint* point : same)
      if (friction(point->friction.value) < -apart &&
          fraction(point->volume_fraction.value) > apart)
        point->unfit = sentence(*point, friction, same.size());
  }
}

}  // namespace grainlaw::calibration
