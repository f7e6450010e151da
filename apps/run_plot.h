#pragma once

#include <filesystem>

#include "dem/local_data.h"

namespace grainlaw {

/// Throws io::InputError when no picture can be drawn there: a name that ends in neither .svg nor
/// .png, no gnuplot, or one that cannot draw such pictures.
void require_plottable(const std::filesystem::path& picture);

/// Draws velocity, volume fraction and friction of the window against height (in a ring cell
/// against the radius) with their standard errors; of a box that is the same everywhere its
/// volume fraction, friction and temperature over strain. Throws io::FileError, also where there is
/// nothing to draw.
void plot(const dem::LocalData& data, const std::filesystem::path& picture);

}  // namespace grainlaw
