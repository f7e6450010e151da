#pragma once

#include "apps/io/local_data_hdf5.h"
#include "calibration/ring_band.h"
#include "continuum/ring_flow.h"
#include "continuum/shear_band.h"

namespace grainlaw {

/// The scene a run was made from, read again from the text in its file. Throws io::InputError.
dem::Scene scene_of(const io::RunRecord& record);

/// The grains of a run as the continuum solvers see them.
continuum::GrainProperties grains_of(const dem::ChuteConditions& conditions);

/// Plane shear or body-force box of a run: mass per area from the number and mean mass of its
/// grains and the periods; load, gravity, speed, pressure and amplitude from the scene. A plane
/// shear of given gap has no load: the normal stress measured at its uppermost dense row takes its
/// place. Throws io::InputError for another geometry.
continuum::ShearBandCase band_case(const dem::Scene& scene, const dem::LocalData& data);

/// Split-bottom cell of a run; the continuum solvers see it filled up to the measured surface.
calibration::RingCell ring_cell(const dem::Scene& scene);
continuum::RingFlowCase ring_flow_case(const dem::Scene& scene,
                                       const dem::LocalData& data,
                                       const calibration::RingBand& measured);

}  // namespace grainlaw
