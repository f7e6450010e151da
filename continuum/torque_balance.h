#pragma once

#include <array>
#include <span>
#include <vector>

#include "continuum/band_cholesky.h"
#include "continuum/ring_mesh.h"

namespace grainlaw::continuum {

/// Where what turns passes angular momentum on: div(r^3 eta grad omega) = 0 over the cross-section
/// of a ring cell, eta = tau / gd in every cell. Outer cylinder and bottom outside the split turn
/// (omega = 1), inner cylinder and the bottom inside rest, the node on the split has the mean of
/// both, no stress acts on the free surface. Bilinear elements: with eta that follows from gd by a
/// law, the state of least dissipation potential among all fields of that kind.
class TorqueBalance {
 public:
  TorqueBalance(const RingMesh& mesh, double split);

  std::size_t unknowns() const { return free_nodes_.size(); }
  std::vector<double> gather(std::span<const double> rotation) const;
  /// Of all nodes, from the unknowns.
  std::vector<double> scatter(std::span<const double> unknowns) const;

  /// The unknowns for a viscosity per cell. Throws SolverError where the matrix is not positive.
  void solve(std::span<const double> viscosity, std::span<double> unknowns);

  /// |gd| of every cell, root of the mean of r^2 |grad omega|^2.
  std::vector<double> shear_rates(std::span<const double> rotation) const;

 private:
  /// int r^3 grad N_a grad N_b of the cells of a column.
  using Stiffness = std::array<std::array<double, 4>, 4>;

  const RingMesh& mesh_;
  std::vector<Stiffness> stiffness_;
  std::vector<std::size_t> free_nodes_;  ///< up every column, for a narrow band
  std::vector<long> unknown_of_;         ///< of a node; -1: given
  std::vector<double> given_;            ///< of a node
  BandCholesky matrix_;
};

}  // namespace grainlaw::continuum
