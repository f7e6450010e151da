#pragma once

#include <string>
#include <vector>

#include "apps/io/import_input.h"
#include "apps/io/local_data_hdf5.h"

namespace grainlaw::io {

/// What the checks need beside the data.
struct CheckedProfile {
  double mass_of_rows = 0.0;     ///< per unit area, sum over the rows
  bool has_history = false;      ///< blocks of time, not averages only
  bool has_kinetic_part = true;  ///< in the stress
  std::string errors;            ///< where the standard errors come from, in words
};

/// The checks of imported data, each a sentence: mass, weight, friction, steadiness, stress,
/// errors. Weight and friction hold when they are off by no more than 3 standard errors or 2 %, by
/// which right programs differ in a measured stress (data/reference/lammps, section 3).
std::vector<ImportCheck> check_import(const Import& import,
                                      const dem::LocalData& data,
                                      const CheckedProfile& profile);

}  // namespace grainlaw::io
