#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "dem/run.h"

namespace grainlaw::io {

/// The grains of a run at many times, in files people can open: a folder beside the local data,
/// RUN.grains, with an HDF5 file for each snapshot, and RUN.xdmf, which ParaView opens as a series
/// in time. In Python:
///     grains = h5py.File("run.grains/00000012.h5")
///     z, v = grains["position"][:, 2], grains["velocity"][:]
///     time = grains.attrs["time"]
/// Every snapshot is written whole (memory image, rename): a kill costs no finished one. RUN.xdmf
/// follows at the latest when twice as many are there, and at the end.
class TrajectoryWriter {
 public:
  struct Options {
    bool xyz = false;  ///< also RUN.grains/00000012.xyz, extended XYZ, for OVITO
  };

  /// Snapshots that are there before belong to the run when it goes on; otherwise they are removed.
  /// Throws FileError, and ReadError for a folder with other files in it.
  TrajectoryWriter(const std::filesystem::path& run, bool goes_on, const Options& options);

  void add(const dem::Snapshot& snapshot);
  /// Brings RUN.xdmf up to date.
  void finish();

  const std::filesystem::path& sidecar() const { return sidecar_; }

 private:
  void take_over();

  std::filesystem::path folder_;
  std::filesystem::path sidecar_;
  Options options_;
  struct Entry {
    double time = 0.0;
    std::size_t grains = 0;
  };
  std::map<long, Entry> entries_;  ///< by the number of the snapshot
  std::size_t in_sidecar_ = 0;
};

/// One snapshot as extended XYZ, units m = d = g = 1: `Lattice` with the periods (an open direction
/// as long as its grains reach), `Properties` of position, radius, velocity and spin.
std::string extended_xyz(const dem::Snapshot& snapshot);

}  // namespace grainlaw::io
