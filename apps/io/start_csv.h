#pragma once

#include <filesystem>
#include <vector>

#include "apps/io/units.h"
#include "dem/scene.h"

namespace grainlaw::io {

/// Reads the grains of a start: lines that begin with '#', then a line of names out of
/// x,y,z,vx,vy,vz,wx,wy,wz,diameter,frozen, then a line per grain. Positions are required; without
/// their columns grains are at rest, of the mean diameter, and free. Numbers in the units of the
/// scene, frozen 0 or 1. Throws InputError with file, line and column.
std::vector<dem::StartGrain> read_start(const std::filesystem::path& path, const Units& units);

}  // namespace grainlaw::io
