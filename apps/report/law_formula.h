#pragma once

#include "apps/report/html.h"
#include "continuum/rheology.h"

namespace grainlaw::report {

/// mu(I, p*, Bo) = ... with the terms that the law has.
Html friction_formula(const continuum::MuPhi& law);

/// phi = ..., likewise.
Html fraction_formula(const continuum::MuPhi& law);

}  // namespace grainlaw::report
