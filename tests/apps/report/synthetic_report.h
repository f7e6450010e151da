#pragma once

#include "apps/report/report.h"

namespace grainlaw::test {

/// A report as the main job makes it, from closed-form Bagnold profiles instead of DEM and solver:
/// three fitted tilts, one between them, one beyond, with noise of the size of its error bars, and
/// one tilt without a steady flow.
report::Report synthetic_report();

}  // namespace grainlaw::test
