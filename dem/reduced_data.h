#pragma once

#include "dem/local_data.h"

namespace grainlaw::dem {

/// The same local data with fewer frames, for files that are to be kept: rows, fields and whatever
/// else there is stay, and what is computed anew from the frames (blocks and covariances of fits)
/// stays within a small part of its standard errors.
///  - Frames are joined to at most 32 of equally many, give or take one, inside the steady window,
///    32 before it and 32 after it; where they have few bins to more, up to 2048 bins in all.
///  - Neighbouring bins are joined up to half the width of the kernel: two bins a row as a rule.
///  - Moments are rounded to single precision (6e-8 of their value).
LocalData reduced(LocalData data);

}  // namespace grainlaw::dem
