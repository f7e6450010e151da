#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "dem/estimate.h"

namespace grainlaw::dem {

/// Ages of contacts in bins of an eighth of an octave, from 1/16 of a contact time to 2^18 of them;
/// the first and the last bin take what lies beyond. Two to any power is a number of bins.
struct LifetimeAxis {
  double contact_time = 1.0;  ///< begin of bin per_octave * octaves_below [time]

  static constexpr int per_octave = 8;
  static constexpr int octaves_below = 4;
  static constexpr std::size_t bins = std::size_t{per_octave} * (octaves_below + 18);

  double begin(std::size_t bin) const {
    return contact_time * std::exp2(static_cast<double>(bin) / per_octave - octaves_below);
  }
  double end(std::size_t bin) const { return begin(bin + 1); }
  std::size_t bin(double age) const;
};

/// What contacts of one bin of ages did. Counts are doubles: they are added and subtracted.
struct LifetimeCounts {
  double ended = 0.0;     ///< contacts that ended at such an age
  double entered = 0.0;   ///< that came under observation at such an age, less those that left it
  double lifetime = 0.0;  ///< sum over those that ended [time]
  double touches = 0.0;   ///< how often those that ended were met touching when fields were sampled
  double slides = 0.0;    ///< and slipping
  double shear = 0.0;     ///< sum of force times branch over those times, shear component [energy]
  double normal = 0.0;    ///< normal component [energy]
};

/// The contacts of one definition (d_c) during some stretch of time.
struct LifetimeTally {
  double begun = 0.0;       ///< contacts that began
  double unknown = 0.0;     ///< were met when they had begun already: of unknown age, not followed
  double unfinished = 0.0;  ///< left at the end of the stretch, of known age
  std::vector<LifetimeCounts> bins = std::vector<LifetimeCounts>(LifetimeAxis::bins);
};

/// A stretch of time, one tally for every d_c.
struct LifetimeBlock {
  double begin = 0.0;    ///< [time]
  double end = 0.0;      ///< [time]
  double samples = 0.0;  ///< number of times the grains were counted
  double grains = 0.0;   ///< of the slice, summed over these
  std::vector<LifetimeTally> distances;
};

/// One bin of a distribution of lifetimes t.
struct LifetimeRow {
  double begin = 0.0;         ///< of the bin [time]
  double end = 0.0;           ///< [time]
  double contacts = 0.0;      ///< that ended in it
  Estimate density;           ///< P(x), x = gd t: probability per unit of x, integral 1
  double shear_share = 0.0;   ///< of the shear component of the contact stress, carried by these
  double normal_share = 0.0;  ///< of its normal component
};

/// Lifetimes of contacts of one definition. Errors are standard errors.
struct LifetimeDistribution {
  /// Densities at which the long lifetime is read; Brewster et al. (2008), eq. 13, take 0.1.
  static constexpr std::array<double, 3> levels{0.3, 0.1, 0.03};
  /// With fewer contacts beyond a long lifetime than this its tail counts as not sampled: the
  /// number itself would be unsure by more than a tenth.
  static constexpr double enough_beyond = 100.0;

  double distance = 0.0;    ///< d_c for grains of mean diameter [length]
  double contacts = 0.0;    ///< followed from begin to end
  double unknown = 0.0;     ///< of unknown age, left out: had begun when they were first met
  double unfinished = 0.0;  ///< still closed at the end of the window (right-censored)
  double survivors = 0.0;   ///< share that outlives every age at which a contact was seen to end
  Estimate mean;            ///< lifetime [time]
  Estimate mode;            ///< most probable lifetime: mean of the bin of largest density [time]
  Estimate collision_rate;  ///< N_c: contacts begun, counted for both grains, per grain [1/time]
  std::array<Estimate, 3> long_lifetime;  ///< gd t on the tail side where P = levels
  std::array<double, 3> beyond{};         ///< contacts that lived longer than that
  double split = 0.0;      ///< twice the mode: shorter contacts count as binary, the others as long
                           ///< [time]
  Estimate long_share;     ///< of contacts that are long
  Estimate long_shear;     ///< share of the shear component of the contact stress they carry
  Estimate long_normal;    ///< of the normal component
  Estimate long_sliding;   ///< share of the time in touch that long contacts slip
  Estimate short_sliding;  ///< the same of binary ones
  std::vector<LifetimeRow> rows;  ///< of bins that hold contacts, and those between

  bool tail_sampled(std::size_t level) const {
    return std::isfinite(long_lifetime[level].value) && beyond[level] >= enough_beyond;
  }
};

/// Lifetimes of the contacts that begin in a slice of the flow.
struct LifetimeStatistics {
  double begin = 0.0;        ///< of the window, whole blocks inside the steady one [time]
  double end = 0.0;          ///< [time]
  double slice_begin = 0.0;  ///< along z [length]; infinite: the whole box
  double slice_end = 0.0;    ///< [length]
  double shear_rate = 0.0;   ///< gd, mean of the slice [1/time]
  double grains = 0.0;       ///< in the slice, mean
  std::vector<LifetimeDistribution> distances;
};

/// The statistics of one d_c from its tallies in consecutive blocks (life table: Cutler and Ederer,
/// J. Chronic Dis. 8 (1958) 699). Of n contacts that reach a bin of ages D end in it, e enter
/// observation in it and l leave: the hazard of the bin is D / (n + (e - l)/2), the survivor
/// function its product. So contacts that the window cuts count for the ages at which they were
/// seen, and nothing is biased toward short lives. Errors: jackknife over up to 20 groups of
/// blocks, NaN for fewer than 4 blocks; that of the shear rate is not in them.
LifetimeDistribution lifetime_distribution(const LifetimeAxis& axis,
                                           std::span<const LifetimeBlock> blocks,
                                           std::size_t distance,
                                           double shear_rate);

}  // namespace grainlaw::dem
