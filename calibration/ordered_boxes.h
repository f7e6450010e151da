#pragma once

#include <span>

#include "calibration/material_fit.h"

namespace grainlaw::calibration {

/// Long shear of equal grains sometimes ends in order, which slides with less friction and packs
/// denser: another material than the disordered one of the law. Of five points or more at one state
/// (I and p* within 5 %, the same Bo within 5 %) those are marked unfit, with a sentence, whose mu
/// is below and whose phi is above the medians by more than six spreads of their kind (1.4826 times
/// the median distance from the median, at least the median standard error).
void mark_ordered(std::span<StatePoint> points);

}  // namespace grainlaw::calibration
