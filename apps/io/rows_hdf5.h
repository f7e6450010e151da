#pragma once

#include <vector>

#include "apps/io/hdf5_file.h"
#include "dem/local_data.h"

namespace grainlaw::io {

/// The rows of a run as datasets in /rows. Those of cohesion and of friction are there where the
/// grains have them.
void write_rows(Hdf5Writer& out, const dem::LocalData& data);

/// Throws ReadError. Files written before some numbers were kept have none of them: NaN.
std::vector<dem::LocalRow> read_rows(const Hdf5Reader& in, bool slides);

/// Time scales (Shi et al. 2020, eqs. 5-9) and further definitions of I, in /scales: they follow
/// from rows and conditions and are not read back.
void write_scales(Hdf5Writer& out, const dem::LocalData& data);

}  // namespace grainlaw::io
