#pragma once

#include <vector>

#include "apps/io/campaign_scenes.h"
#include "apps/io/local_data_hdf5.h"

namespace grainlaw {

/// The planned run whose conditions a finished one was made under; seeds may differ, and so may
/// names. Null: there is none.
/// Chutes: same grains, base, mass and tilt (of other programs, which know no base of ours: grains
/// up to the rounding of files). Shear boxes: same contact laws and sizes, and I, p*, Bo as
/// measured within 5 % of the planned ones. Chutes of a series: the name too, as their contacts
/// may differ in what the conditions of a run do not hold.
const io::PlannedRun* planned_for(const io::RunRecord& record,
                                  const std::vector<io::PlannedRun>& planned,
                                  bool by_name = false);

}  // namespace grainlaw
