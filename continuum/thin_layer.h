#pragma once

#include <optional>

#include "continuum/chute_1d.h"

namespace grainlaw::continuum {

/// A of the cooperativity length of glass beads  (Henann & Kamrin 2013).
inline constexpr double glass_bead_amplitude = 0.48;

/// Whether a steady layer is deep enough to flow at all: a local law lets every layer flow whose
/// tilt it lets flow, while grains on a rough base stand still below h_stop.
struct ThinLayer {
  double flowing_depth = 0.0;  ///< from the free surface to where u = 0 [length]
  double stop_depth = 0.0;     ///< estimated h_stop [length]; infinite where nonlocal flow ends

  bool thin() const { return flowing_depth < stop_depth; }
};

/// h_stop = pi/2 A sqrt((mu_2 - mu) / (Dmu (mu - mu_s))) d at mu = tan(theta) of the nonlocal
/// granular fluidity (Kamrin & Henann 2015) with A of glass beads, so an estimate; mu_s and mu_2
/// are mu0 and mu_inf of the law at the base, softness and cohesion there included (no mu_inf: its
/// limit, 1 / (mu - mu_s) under the root). Absent for laws other than mu(I) and without flow.
std::optional<ThinLayer> thin_layer(const RheologyTable& table,
                                    const ChuteCase& chute,
                                    const Profile& profile);

}  // namespace grainlaw::continuum
