#pragma once

#include "apps/report/figure.h"
#include "apps/report/html.h"
#include "apps/report/report.h"

namespace grainlaw::report {

/// Yield stress, material cohesion and plug of chutes of cohesive grains, as tables; part of the
/// section of the series.
Html cohesion_tables(const calibration::CohesionSeries& cohesion);

/// tau_c over the strength of the attraction.
FigureGroup cohesion_figures(const calibration::CohesionSeries& cohesion);

}  // namespace grainlaw::report
