#include "continuum/torque_balance.h"

#include <algorithm>
#include <cmath>

#include "continuum/answer.h"

namespace grainlaw::continuum {
namespace {

/// Gauss points of (0, 1), two per direction: exact for r^3 times products of slopes to O(h^4).
const double gauss[] = {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)};

}  // namespace

TorqueBalance::TorqueBalance(const RingMesh& mesh, double split)
    : mesh_(mesh),
      unknown_of_(mesh.nodes(), -1),
      given_(mesh.nodes(), 0.0),
      matrix_((mesh.columns() - 1) * mesh.rows(), mesh.rows() + 1) {
  const double h = mesh.thickness();
  for (std::size_t i = 0; i < mesh.columns(); ++i) {
    Stiffness K{};
    const double w = mesh.width(i);
    for (const double s : gauss) {
      for (const double t : gauss) {
        const double r = mesh.r()[i] + s * w;
        const double weight = 0.25 * w * h * r * r * r;
        const double by_r[] = {-(1.0 - t) / w, (1.0 - t) / w, -t / w, t / w};
        const double by_z[] = {-(1.0 - s) / h, -s / h, (1.0 - s) / h, s / h};
        for (std::size_t a = 0; a < 4; ++a)
          for (std::size_t b = 0; b < 4; ++b)
            K[a][b] += weight * (by_r[a] * by_r[b] + by_z[a] * by_z[b]);
      }
    }
    stiffness_.push_back(K);
  }
  const std::size_t last = mesh.r().size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    for (std::size_t k = 0; k < mesh.z().size(); ++k) {
      const std::size_t node = mesh.node(i, k);
      if (k > 0 && i > 0 && i < last) {
        unknown_of_[node] = static_cast<long>(free_nodes_.size());
        free_nodes_.push_back(node);
      } else if (i == last || (i > 0 && mesh.r()[i] > split)) {
        given_[node] = 1.0;
      } else if (i > 0 && mesh.r()[i] == split) {
        given_[node] = 0.5;
      }
    }
  }
}

std::vector<double> TorqueBalance::gather(std::span<const double> rotation) const {
  std::vector<double> unknowns;
  for (const std::size_t node : free_nodes_) unknowns.push_back(rotation[node]);
  return unknowns;
}

std::vector<double> TorqueBalance::scatter(std::span<const double> unknowns) const {
  std::vector<double> rotation = given_;
  for (std::size_t i = 0; i < free_nodes_.size(); ++i) rotation[free_nodes_[i]] = unknowns[i];
  return rotation;
}

void TorqueBalance::solve(std::span<const double> viscosity, std::span<double> unknowns) {
  matrix_.clear();
  std::ranges::fill(unknowns, 0.0);  // the right side first, the solution in the end
  for (std::size_t k = 0; k < mesh_.rows(); ++k) {
    for (std::size_t i = 0; i < mesh_.columns(); ++i) {
      const double eta = viscosity[mesh_.cell(i, k)];
      const auto corner = mesh_.corners(i, k);
      for (std::size_t a = 0; a < 4; ++a) {
        const long row = unknown_of_[corner[a]];
        if (row < 0) continue;
        const auto at = static_cast<std::size_t>(row);
        for (std::size_t b = 0; b < 4; ++b) {
          const long column = unknown_of_[corner[b]];
          const double value = eta * stiffness_[i][a][b];
          if (column < 0) unknowns[at] -= value * given_[corner[b]];
          if (column >= 0 && column <= row) matrix_(at, static_cast<std::size_t>(column)) += value;
        }
      }
    }
  }
  if (!matrix_.factorise())
    throw SolverError(
        "the torque balance of the ring cell has no solution: its matrix is singular");
  matrix_.solve(unknowns);
}

std::vector<double> TorqueBalance::shear_rates(std::span<const double> rotation) const {
  std::vector<double> rates;
  for (std::size_t k = 0; k < mesh_.rows(); ++k) {
    for (std::size_t i = 0; i < mesh_.columns(); ++i) {
      const auto corner = mesh_.corners(i, k);
      // less the first corner: what turns as a whole is not sheared by rounding
      double from_first[4] = {};
      for (std::size_t a = 0; a < 4; ++a) from_first[a] = rotation[corner[a]] - rotation[corner[0]];
      double square = 0.0;
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = 0; b < 4; ++b)
          square += stiffness_[i][a][b] * from_first[a] * from_first[b];
      rates.push_back(std::sqrt(std::max(0.0, square) / mesh_.volume(i)));
    }
  }
  return rates;
}

}  // namespace grainlaw::continuum
