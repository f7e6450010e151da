#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dem/estimate.h"
#include "dem/fields.h"
#include "dem/lifetime_statistics.h"
#include "dem/profile_frames.h"
#include "dem/ring_grid.h"
#include "dem/tilt_step.h"
#include "dem/time_scales.h"

namespace grainlaw::dem {

/// What is known of a chute before it runs: all a fit or a prediction may use beside the data.
/// In the units of the run.
struct ChuteConditions {
  std::string geometry = "chute";  ///< fits and predictions so far take chutes
  double inclination = 0.0;        ///< theta [rad]; of the rows, where it changed on the way
  double gravity = 1.0;            ///< g [length/time^2]
  double grain_diameter = 1.0;     ///< d [length]
  double grain_density = 0.0;      ///< rho_p [mass/length^3]
  double stiffness = 0.0;          ///< normal contact stiffness k_n [mass/time^2]
  double contact_friction = 0.0;   ///< mu_p
  double attraction = 0.0;         ///< f_a, the largest of a pair of mean grains [force]
  double mass_per_area = 0.0;      ///< of the flowing grains [mass/length^2]
  double shear_rate = 0.0;         ///< imposed on the whole box [1/time]; 0: none
  std::string base{};              ///< recipe of the base in words, equal for equal bases
  /// Every tilt of the run, the first at time 0, where it changed on the way; empty: it did not.
  std::vector<TiltStep> tilts{};
};

/// Fields of one row at the width of the kernel, averaged over the steady window, with standard
/// errors by block averaging (see FieldRow).
struct LocalRow {
  double z = 0.0;            ///< centre of the row [length], z = 0: highest base centre + d/2;
                             ///< boxes: y, ring cell: the radius
  double mass_above = 0.0;   ///< per unit area, averaged as the stress is [mass/length^2]
  Estimate velocity;         ///< v_x [length/time]
  Estimate shear_rate;       ///< d v_x / d z [1/time]
  Estimate volume_fraction;  ///< phi
  Estimate shear_stress;     ///< sigma_xz = contact + kinetic, positive down the slope [stress]
  Estimate normal_stress;    ///< sigma_zz = contact + kinetic, positive in compression [stress]
  Estimate pressure;         ///< a third of the trace of contact + kinetic stress [stress]
  Estimate temperature;      ///< mean square velocity fluctuation per component [(length/time)^2]
  Estimate inertial_number;  ///< I = gd d sqrt(rho_p / sigma_zz)  (Shi et al. 2020, eq. 10)
  Estimate softness;         ///< p* = sigma_zz d / k_n            (Shi et al. 2020, eq. 11)
  Estimate bond_number;      ///< Bo = f_a / (sigma_zz d^2)        (Shi et al. 2020, eq. 12);
                             ///< not a number without attraction
  Estimate scaled_temperature;     ///< T* = rho_p T / sigma_zz
  Estimate bulk_inertial_number;   ///< I sqrt(phi): with the density of the bulk (below eq. 10)
  Estimate friction;               ///< mu = sigma_xz / sigma_zz
  Estimate coordination;           ///< Z, every contact counted for both grains
  Estimate dissipation;            ///< of a contact [power]
  Estimate sliding_share;          ///< of contacts; not a number for grains without friction
  double effective_samples = 0.0;  ///< N_eff of the velocity (Flyvbjerg-Petersen)
};

/// Time scales of a row, and I, p*, Bo, T* with them (Shi et al. 2020, eqs. 5-12); p is sigma_zz.
TimeScales time_scales(const ChuteConditions& conditions, const LocalRow& row);
DimensionlessNumbers dimensionless_numbers(const ChuteConditions& conditions, const LocalRow& row);

/// What can be said of a field in all rows: the word of its row of fewest independent samples.
Convergence worst_convergence(const std::vector<LocalRow>& rows, Estimate LocalRow::*field);

/// The part of a run that is averaged.
struct SteadyWindow {
  bool steady = false;
  double begin = 0.0;    ///< [time]
  double end = 0.0;      ///< [time]
  std::string reason{};  ///< in words: why steady, or why not (accelerating, arrested, ...)
  std::optional<double> arrested_at{};  ///< when the layer came to rest, if it did [time]
};

/// What a run cost and how far it can be trusted.
struct RunSummary {
  double time_step = 0.0;     ///< [time]
  double contact_time = 0.0;  ///< shortest contact time [time]
  double restitution = 0.0;   ///< effective normal restitution at this step
  long steps = 0;
  int flowing_grains = 0;
  int base_grains = 0;
  double wall_seconds = 0.0;
  double startup_wall_seconds = 0.0;  ///< of it, before the steady window
  double largest_overlap = 0.0;       ///< [radius]
  double deep_overlap_share = 0.0;    ///< share of sampled contacts with overlap above 0.1 radius
  double energy_residual = 0.0;       ///< ledger residual over total dissipated energy
  double stepping_seconds = 0.0;      ///< of the wall time, in time steps of the flow
  double coordination = 0.0;          ///< Z, every contact counted for both grains, steady window
};

/// All fields at one width of the kernel, in rows that reach beyond walls as far as the kernel.
struct WidthFields {
  double width = 0.0;    ///< w [length]
  double z_begin = 0.0;  ///< lower end of the first row [length]
  double row_width = 1.0;
  std::vector<FieldRow> values;
  std::vector<FieldRow> errors;
};

/// Local data of one chute run: what the DEM hands to fits, comparisons and files.
struct LocalData {
  std::string name;
  ChuteConditions conditions;
  SteadyWindow window;
  std::vector<LocalRow> rows;  ///< bottom to top; empty bins above the surface are left out
  ProfileFrames frames;        ///< the whole run including the start, from which rows were averaged
  std::vector<WidthFields> fields{};  ///< at w/2, w, 2 w: how much they depend on it
  RunSummary summary;
  std::optional<LifetimeStatistics> lifetimes{};  ///< of contacts, where the scene asks for them
  std::optional<RingFields> ring{};               ///< over radius and height, of a ring cell
};

/// The frames that a window holds whole.
std::span<const ProfileFrame> frames_inside(const ProfileFrames& frames,
                                            const SteadyWindow& window);

/// Averages the frames inside the window into rows (field definitions in FieldRow), those in which
/// grains are found.
std::vector<LocalRow> average(const ProfileFrames& frames,
                              const ChuteConditions& conditions,
                              const SteadyWindow& window);

/// All fields of the frames inside the window at half, once and twice the width of the kernel; of a
/// homogeneous box, which has no kernel, once. Empty where the window holds no frame.
std::vector<WidthFields> fields_at_widths(const ProfileFrames& frames,
                                          const ChuteConditions& conditions,
                                          const SteadyWindow& window);

/// Velocity of every bin of `rows` in each block of the window, blocks long enough to be
/// independent where the window allows it: [block][row], at least 4 blocks. For covariances.
std::vector<std::vector<double>> block_velocities(const LocalData& data);

}  // namespace grainlaw::dem
