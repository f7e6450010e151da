#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace grainlaw::continuum {

/// The cross-section of a ring cell in rectangles; a node lies on the split.
class RingMesh {
 public:
  /// Cells about `cell_width` wide in both directions, at least four on either side of the split
  /// and over the depth.
  RingMesh(double inner, double split, double outer, double depth, double cell_width);

  const std::vector<double>& r() const { return r_; }  ///< of the nodes
  const std::vector<double>& z() const { return z_; }
  std::size_t columns() const { return r_.size() - 1; }  ///< of cells
  std::size_t rows() const { return z_.size() - 1; }
  std::size_t cells() const { return columns() * rows(); }
  std::size_t nodes() const { return r_.size() * z_.size(); }

  std::size_t cell(std::size_t column, std::size_t row) const { return row * columns() + column; }
  std::size_t node(std::size_t column, std::size_t row) const { return row * r_.size() + column; }
  /// Of a cell: below left, below right, above left, above right.
  std::array<std::size_t, 4> corners(std::size_t column, std::size_t row) const;

  double radius(std::size_t column) const { return 0.5 * (r_[column] + r_[column + 1]); }
  double height(std::size_t row) const { return 0.5 * (z_[row] + z_[row + 1]); }
  double width(std::size_t column) const { return r_[column + 1] - r_[column]; }
  double thickness() const { return z_[1] - z_[0]; }
  /// int r dr dz of a cell.
  double volume(std::size_t column) const { return radius(column) * width(column) * thickness(); }

 private:
  std::vector<double> r_;
  std::vector<double> z_;
};

/// Bilinear between nodes at r and z, values z by z; held at the edges.
double interpolate(const std::vector<double>& r,
                   const std::vector<double>& z,
                   std::span<const double> values,
                   double radius,
                   double height);

}  // namespace grainlaw::continuum
