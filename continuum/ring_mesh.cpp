#include "continuum/ring_mesh.h"

#include <algorithm>
#include <cmath>

namespace grainlaw::continuum {
namespace {

void append_parts(std::vector<double>& nodes, double end, double cell_width) {
  constexpr double fewest = 4.0;
  const double begin = nodes.back();
  const double parts = std::max(fewest, std::round((end - begin) / cell_width));
  for (int k = 1; k < static_cast<int>(parts); ++k)
    nodes.push_back(begin + (end - begin) * k / parts);
  nodes.push_back(end);
}

/// The cell of `nodes` in which x lies, and where in it.
struct Place {
  std::size_t cell = 0;
  double share = 0.0;
};

Place place(const std::vector<double>& nodes, double x) {
  const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, x);
  const auto cell = static_cast<std::size_t>(above - nodes.begin()) - 1;
  const double share = (x - nodes[cell]) / (nodes[cell + 1] - nodes[cell]);
  return {cell, std::clamp(share, 0.0, 1.0)};
}

}  // namespace

RingMesh::RingMesh(double inner, double split, double outer, double depth, double cell_width)
    : r_{inner}, z_{0.0} {
  append_parts(r_, split, cell_width);
  append_parts(r_, outer, cell_width);
  append_parts(z_, depth, cell_width);
}

std::array<std::size_t, 4> RingMesh::corners(std::size_t column, std::size_t row) const {
  return {
      node(column, row), node(column + 1, row), node(column, row + 1), node(column + 1, row + 1)};
}

double interpolate(const std::vector<double>& r,
                   const std::vector<double>& z,
                   std::span<const double> values,
                   double radius,
                   double height) {
  const Place i = place(r, radius);
  const Place k = place(z, height);
  const std::size_t corner = k.cell * r.size() + i.cell;
  const double below = std::lerp(values[corner], values[corner + 1], i.share);
  const double above = std::lerp(values[corner + r.size()], values[corner + r.size() + 1], i.share);
  return std::lerp(below, above, k.share);
}

}  // namespace grainlaw::continuum
