#pragma once

#include <optional>
#include <vector>

#include "continuum/rheology_table.h"

namespace grainlaw::continuum {

/// What a table says of a homogeneous steady shear: the law itself, point by point, without any
/// flow to solve. Curves of a published table are made of these.
struct HomogeneousState {
  double inertial_number = 0.0;  ///< I
  double softness = 0.0;         ///< p*
  double bond_number = 0.0;      ///< Bo
  /// mu(I, p*, Bo); absent where the table has phi only, or where softness takes all friction.
  std::optional<double> friction{};
  /// phi(I, p*, Bo); absent beyond I_phi or above 1, where the law has left physics.
  std::optional<double> volume_fraction{};
  bool in_range = true;  ///< inside the data of the table
};

/// Every combination of the three lists, the last one running fastest. Throws TableError for a
/// generalised Bagnold table, which has no I.
std::vector<HomogeneousState> homogeneous_shear(const RheologyTable& table,
                                                const std::vector<double>& inertial_numbers,
                                                const std::vector<double>& softnesses,
                                                const std::vector<double>& bond_numbers);

}  // namespace grainlaw::continuum
