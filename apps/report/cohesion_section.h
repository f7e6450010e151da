#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/report/figure.h"
#include "apps/report/html.h"
#include "apps/report/report.h"

namespace grainlaw::report {

/// Yield stress, material cohesion and plug of chutes of cohesive grains, as tables; part of the
/// section of the series.
Html cohesion_tables(const calibration::CohesionSeries& cohesion);

/// tau_c and Xi over the strength of the attraction; of a law as well, where one is given.
std::vector<Figure> cohesion_figures(const SeriesReport& series);
std::map<std::string, Csv> cohesion_data(const SeriesReport& series);

}  // namespace grainlaw::report
