#pragma once

#include <cstddef>
#include <vector>

#include "apps/report/report.h"

namespace grainlaw {

/// The numbers by which a chute judges a table: velocity, with what its error is made of.
report::Score score_of(const report::RunComparison& run);

/// Those of its start, tilt steps and arrest: velocity over all moments, time to steady, stopping
/// time.
std::vector<report::Score> in_time_scores(const report::RunComparison& run);

/// Those by which another flow judges the table of an index: mu and phi of the law at the measured
/// states (rms over the rows or heights inside the data of the table, signed for a single state),
/// and of a band the velocity.
std::vector<report::Score> scores_of(const report::FlowComparison& flow, std::size_t table);

}  // namespace grainlaw
