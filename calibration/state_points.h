#pragma once

#include <span>
#include <string>
#include <vector>

#include "calibration/law_selection.h"
#include "calibration/material_fit.h"

namespace grainlaw::calibration {

/// Which of the two laws.
enum class Quantity { friction, volume_fraction };

/// What a point says of it.
const dem::Estimate& measured(const StatePoint& point, Quantity quantity);

/// The points of one law.
struct PointSelection {
  std::vector<std::size_t> used;  ///< indices of the points
  std::vector<LawDatum> data;
  std::vector<std::string> left_out;  ///< sentences
};

/// Leaves out what is no number, what stands there twice and what the range does not let through.
/// Throws FitError when fewer than two different I are left.
PointSelection select_points(std::span<const StatePoint> points,
                             Quantity quantity,
                             const FitRange& range);

/// The points that a fit used, by the weights it gave them; those it weighed less are flagged.
PointSelection select_fitted(std::span<const StatePoint> points,
                             Quantity quantity,
                             const std::vector<double>& weights);

/// How many values of each variable the data have.
struct Levels {
  int inertial_number = 0;
  int softness = 0;
  int bond_number = 0;
  int cohesive_softness = 0;  ///< of p* where Bo > 0
};
Levels levels_of(const std::vector<LawDatum>& data);

/// The terms of a law that the data cannot know, with the reason.
std::vector<DroppedTerm> unknowable_friction(const FittableLaw& law,
                                             const Levels& levels,
                                             std::size_t data);
std::vector<DroppedTerm> unknowable_fraction(const FittableLaw& law,
                                             const Levels& levels,
                                             std::size_t data);

/// Weight each point kept, 0 where it was left out; points off the range are named in the summary.
std::vector<double> point_weights(std::span<const StatePoint> points,
                                  const PointSelection& selection,
                                  const SolvedLaw& solved,
                                  FitSummary& summary);

/// Name of a point, or its number.
std::string label(const StatePoint& point, std::size_t index);

}  // namespace grainlaw::calibration
