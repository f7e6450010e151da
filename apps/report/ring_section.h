#pragma once

#include <string>

#include "apps/report/figure.h"
#include "apps/report/html.h"
#include "apps/report/report.h"

namespace grainlaw::report {

// What a page shows of a ring cell with a split bottom; flow.ring is there.

/// The laws beside the measured rotation, and the error functions of every height.
Html ring_part(const Report& report, const FlowComparison& flow);

/// Rotation at the lowest and the highest fitted height, centre and width of the band over height.
void add_ring_figures(const Report& report,
                      const FlowComparison& flow,
                      const std::string& base,
                      FigureGroup& group);

}  // namespace grainlaw::report
