#pragma once

#include <Eigen/SparseCholesky>
#include <array>
#include <span>
#include <vector>

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
  using Matrix = Eigen::SparseMatrix<double>;
  /// int r^3 grad N_a grad N_b of the cells of a column.
  using Stiffness = std::array<std::array<double, 4>, 4>;
  void prepare_pattern();

  const RingMesh& mesh_;
  std::vector<Stiffness> stiffness_;
  std::vector<std::size_t> free_nodes_;
  std::vector<long> unknown_of_;  ///< of a node; -1: given
  std::vector<double> given_;     ///< of a node
  Matrix matrix_;
  std::vector<std::array<double*, 16>> entries_;  ///< of a cell, in the lower half of the matrix
  Eigen::SimplicialLDLT<Matrix> factors_;
};

}  // namespace grainlaw::continuum
