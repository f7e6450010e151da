#pragma once

#include <span>
#include <vector>

#include "calibration/fittable_law.h"
#include "calibration/material_fit.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// The state of a run of homogeneous simple shear: I, p*, mu, phi of the whole box, averaged over
/// the steady window, with their block errors; Bo = f_a / (sigma_yy d^2) (Shi et al. 2020, eqs. 10
/// to 12). `unfit` says why it is no state of steady homogeneous flow: the run found no steady
/// state, or layers of the box differ from each other by more than their errors.
/// Throws FitError for a run of another geometry or without rows.
StatePoint box_point(const dem::LocalData& run);

/// States of a heterogeneous flow (plane shear, body-force box): one row per 2 w of the kernel, as
/// closer rows share their grains (rows of the same run still share its slow fluctuations). Rows
/// within 2 w of a wall, and those whose shear rate is below three standard errors (plug, creep,
/// the crest of the velocity), are left out. Empty with a sentence in `left_out` where none is
/// left.
struct ProfilePoints {
  std::vector<StatePoint> points;
  std::vector<std::string> left_out;
};
ProfilePoints profile_points(const dem::LocalData& run);

/// All of these of many runs, whatever their geometry; a chute has one I at all depths and is no
/// such run. Sentences on runs that give no point are appended to `left_out`; seeds that have
/// ordered are marked unfit (ordered_boxes.h).
std::vector<StatePoint> state_points(std::span<const dem::LocalData> runs,
                                     std::vector<std::string>& left_out);

/// What a row of fields says of a state: |I|, p*, Bo, |mu| and phi.
struct MeasuredState {
  State state;
  double friction = 0.0;
  double volume_fraction = 0.0;
};
MeasuredState measured_state(const dem::FieldRow& field, const dem::ChuteConditions& grains);

/// Which row of the fields of a run is at z (y in boxes).
std::size_t field_row_at(const dem::ProfileFrames& grid, double z);

/// The run with the first part of its steady window only, 0 < share <= 1, averaged anew.
/// Throws FitError where that leaves no frame.
dem::LocalData shortened(const dem::LocalData& run, double share);

}  // namespace grainlaw::calibration
