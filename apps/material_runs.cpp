#include "apps/material_runs.h"

#include <algorithm>
#include <cmath>

#include "calibration/box_points.h"

namespace grainlaw {
namespace {

using calibration::State;
using calibration::StatePoint;
using report::LawLine;

constexpr double alike = 1.1;  // values this close are one level
constexpr std::size_t line_points = 41;

bool fits(const StatePoint& point) {
  return point.unfit.empty() && std::isfinite(point.friction.value);
}

/// Points of one p*, or one pair of I and p*.
struct Level {
  double softness = 0.0;
  double inertial_number = 0.0;
  std::vector<const StatePoint*> points;
};

bool same(double one, double other) {
  return std::max(one, other) <= alike * std::min(one, other);
}

std::vector<Level> levels(std::vector<const StatePoint*> points, bool of_inertia_too) {
  std::sort(points.begin(), points.end(), [](const StatePoint* a, const StatePoint* b) {
    return a->softness.value < b->softness.value;
  });
  std::vector<Level> result;
  for (const StatePoint* point : points) {
    const double p = point->softness.value;
    const double I = point->inertial_number.value;
    const auto found = std::find_if(result.begin(), result.end(), [&](const Level& level) {
      return same(level.softness, p) && (!of_inertia_too || same(level.inertial_number, I));
    });
    if (found != result.end()) {
      found->points.push_back(point);
    } else {
      result.push_back({.softness = p, .inertial_number = I, .points = {point}});
    }
  }
  std::sort(result.begin(), result.end(), [](const Level& one, const Level& other) {
    return same(one.softness, other.softness) ? one.inertial_number < other.inertial_number
                                              : one.softness < other.softness;
  });
  return result;
}

/// Mean of a measured number over the points of a level.
double mean(const Level& level, dem::Estimate StatePoint::*number) {
  double sum = 0.0;
  for (const StatePoint* point : level.points) sum += (point->*number).value;
  return sum / static_cast<double>(level.points.size());
}

double largest(const Level& level, dem::Estimate StatePoint::*number) {
  double result = 0.0;
  for (const StatePoint* point : level.points) {
    result = std::max(result, (point->*number).value);
  }
  return result;
}

/// Lines of mu(I) and phi(I) at each p* of the cohesionless points, evenly spaced in ln I.
std::vector<LawLine> lines_against_inertia(const std::vector<StatePoint>& points) {
  std::vector<const StatePoint*> chosen;
  double low = 1e300, high = 0.0;
  for (const StatePoint& point : points) {
    const double I = point.inertial_number.value;
    if (!fits(point) || point.bond_number.value > 0.0 || !(I > 0.0)) continue;
    chosen.push_back(&point);
    low = std::min(low, I);
    high = std::max(high, I);
  }
  std::vector<LawLine> lines;
  for (const Level& level : levels(chosen, false)) {
    LawLine& line = lines.emplace_back();
    const double p = mean(level, &StatePoint::softness);
    for (std::size_t k = 0; k < line_points; ++k) {
      const double share = static_cast<double>(k) / (line_points - 1);
      line.states.push_back(
          {alike * high * std::pow(low / (alike * alike * high), 1.0 - share), p, 0.0});
    }
  }
  return lines;
}

/// Lines against Bo at each pair of I and p* that cohesive points have.
std::vector<LawLine> lines_against_cohesion(const std::vector<StatePoint>& points) {
  std::vector<const StatePoint*> chosen;
  for (const StatePoint& point : points) {
    if (fits(point) && point.bond_number.value > 0.0) chosen.push_back(&point);
  }
  std::vector<LawLine> lines;
  for (const Level& level : levels(chosen, true)) {
    LawLine& line = lines.emplace_back();
    const double step =
        largest(level, &StatePoint::bond_number) / static_cast<double>(line_points - 1);
    for (std::size_t k = 0; k < line_points; ++k) {
      line.states.push_back({mean(level, &StatePoint::inertial_number),
                             mean(level, &StatePoint::softness),
                             step * static_cast<double>(k)});
    }
  }
  return lines;
}

calibration::BootstrapBand part(const calibration::BootstrapBand& whole,
                                std::size_t first,
                                std::size_t count) {
  const auto cut = [&](const std::vector<double>& values) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));
  };
  return {.lower = cut(whole.lower),
          .upper = cut(whole.upper),
          .replicates = whole.replicates,
          .failed = whole.failed};
}

/// Bands of all lines at once: they share the replicates.
void add_bands(std::span<const dem::LocalData> runs, report::MaterialReport& material) {
  std::vector<State> states;
  for (const auto* lines : {&material.against_inertia, &material.against_cohesion}) {
    for (const LawLine& line : *lines) {
      states.insert(states.end(), line.states.begin(), line.states.end());
    }
  }
  try {
    const auto band = calibration::material_band(runs, material.points, material.fit, states);
    std::size_t first = 0;
    for (auto* lines : {&material.against_inertia, &material.against_cohesion}) {
      for (LawLine& line : *lines) {
        const std::size_t count = line.states.size();
        line.band = {part(band.friction, first, count), part(band.volume_fraction, first, count)};
        first += count;
      }
    }
  } catch (const calibration::FitError& error) {
    material.left_out.push_back(std::string("bootstrapped bands: ") + error.what());
  }
}

}  // namespace

report::MaterialReport study_material(std::span<const dem::LocalData> runs,
                                      const calibration::MaterialFitOptions& options) {
  report::MaterialReport material;
  material.points = calibration::state_points(runs, material.left_out);
  material.fit = calibration::fit_material(material.points, options);
  material.against_inertia = lines_against_inertia(material.points);
  material.against_cohesion = lines_against_cohesion(material.points);
  add_bands(runs, material);
  material.friction_information = friction_information(material.points, material.fit);
  material.fraction_information = fraction_information(material.points, material.fit);
  material.cost = calibration::cost_of_coefficients(runs, material.points, material.fit);
  return material;
}

}  // namespace grainlaw
