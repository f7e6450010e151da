#pragma once

#include <string>

#include "apps/summary.h"
#include "continuum/well_posedness.h"

namespace grainlaw {

/// "I 0.0261 to 2.45", "no I", "every I".
std::string interval_text(const std::vector<continuum::Range>& intervals);

/// "p* 0.01, Bo 1".
std::string confinement_text(double softness, double bond_number);

/// Where a two- or three-dimensional code may use this law: the intervals of I.
void say_certificate(Summary& summary, const continuum::RheologyTable& table);

/// The margin of a predicted flow.
void say_certificate(Summary& summary,
                     const continuum::RheologyTable& table,
                     const continuum::Profile& profile,
                     const continuum::GrainProperties& grains);

}  // namespace grainlaw
