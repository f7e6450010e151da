#pragma once

#include <span>

#include "apps/io/local_data_hdf5.h"
#include "apps/report/report.h"

namespace grainlaw {

/// A table and what is known of the runs it was fitted to.
struct ComparedTable {
  std::string name;  ///< of its file
  continuum::RheologyTable table;
};

/// The run is one of those the table was fitted to: same digest where the table states digests,
/// else same name.
bool was_fitted(const continuum::RheologyTable& table, const io::RunRecord& record);

/// Runs of plane shear and body-force box.
bool is_band(const dem::LocalData& data);

/// Those and ring cells can be predicted with nonlocal fluidity.
bool has_nonlocal_flow(const dem::LocalData& data);

/// A of the nonlocal fluidity from the velocities of one band or ring cell. Throws
/// calibration::FitError.
report::NonlocalAmplitude fit_nonlocal(const io::RunRecord& record,
                                       const continuum::RheologyTable& table);

/// A run of simple shear, plane shear, body-force box or split-bottom cell beside every table.
/// What cannot be compared is a sentence in its notes. Throws io::InputError for a scene that
/// cannot be read again.
report::FlowComparison compare_flow(const io::RunRecord& record,
                                    std::span<const ComparedTable> tables,
                                    const std::optional<report::NonlocalAmplitude>& nonlocal);

}  // namespace grainlaw
