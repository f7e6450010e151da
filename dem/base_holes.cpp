#include "dem/base_holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

namespace grainlaw::dem {
namespace {

using Cell = std::array<int, 3>;

/// Where the centre of a probe can be in and above a layer: cells of a grid, the lowest ones about
/// the plane of the lowest centre. Below it there is nothing any more to hold a probe.
/// A cell counts as open if any place in it may be: no passage is missed.
class ProbeGrid {
 public:
  ProbeGrid(const Region& ground, std::span<const InitialGrain> layer, double probe, double edge);

  /// The probe does not overlap the grain and its images.
  void close_around(const InitialGrain& grain);

  /// Where a probe from above reaches the lowest cells.
  std::optional<Vec3> hole() const;

 private:
  void close_about(const Vec3& centre, double reach);
  bool in_a_wall(const Cell& cell) const;
  std::optional<Cell> neighbour(Cell cell, std::size_t axis, int step) const;

  /// Cells of an axis whose middles lie within `half` of a coordinate.
  std::array<int, 2> range(std::size_t axis, double coordinate, double half) const {
    const double from = (coordinate - half - first_[axis]) / step_[axis];
    const double to = (coordinate + half - first_[axis]) / step_[axis];
    return {std::max(0, static_cast<int>(std::ceil(from))),
            std::min(count_[axis], static_cast<int>(std::floor(to)) + 1)};
  }
  std::size_t index(const Cell& c) const {
    const auto count = [&](std::size_t axis) { return static_cast<std::size_t>(count_[axis]); };
    const auto at = [&](std::size_t axis) { return static_cast<std::size_t>(c[axis]); };
    return (at(0) * count(1) + at(1)) * count(2) + at(2);
  }
  double middle(std::size_t axis, int k) const { return first_[axis] + k * step_[axis]; }
  Vec3 place(const Cell& c, double z) const {
    return ground_.position({middle(0, c[0]), middle(1, c[1]), z});
  }
  template <class Visit>
  void every_column(Visit visit) const {
    for (int a = 0; a < count_[0]; ++a) {
      for (int b = 0; b < count_[1]; ++b) visit(Cell{a, b, 0});
    }
  }

  Region ground_;
  std::vector<Repeat> repeats_;
  double probe_;         // diameter
  double slack_ = 0.0;   // half the diagonal of a cell
  Coordinates first_{};  // middle of the first cell
  Coordinates step_{};
  Cell count_{};
  std::vector<std::uint8_t> open_;
};

ProbeGrid::ProbeGrid(const Region& ground,
                     std::span<const InitialGrain> layer,
                     double probe,
                     double edge)
    : ground_(ground), probe_(probe) {
  ground_.axes[2].periodic = false;
  repeats_ = repeats(ground_);
  double lowest = layer.front().position.z;
  double highest = lowest;
  for (const auto& grain : layer) {
    lowest = std::min(lowest, grain.position.z);
    highest = std::max(highest, grain.position.z + 0.5 * (grain.diameter + probe));
  }
  const double arm = ground_.polar ? ground_.axes[0].most : 1.0;
  const std::array<double, 3> edges{edge, edge / arm, edge};
  const std::array<double, 3> lengths{
      ground_.axes[0].length(), ground_.axes[1].length(), highest - lowest + 2.0 * edge};
  for (std::size_t a = 0; a < 3; ++a) {
    count_[a] = static_cast<int>(std::ceil(lengths[a] / edges[a]));
    step_[a] = lengths[a] / count_[a];
    first_[a] = a == 2 ? lowest : ground_.axes[a].least + 0.5 * step_[a];
  }
  slack_ = 0.5 * std::hypot(step_[0], arm * step_[1], step_[2]);
  open_.assign(index({count_[0], 0, 0}), 1);
  every_column([&](const Cell& c) {
    const auto column = open_.begin() + static_cast<std::ptrdiff_t>(index(c));
    if (in_a_wall(c)) std::fill(column, column + count_[2], std::uint8_t{0});
  });
  for (const InitialGrain& grain : layer) close_around(grain);
}

bool ProbeGrid::in_a_wall(const Cell& cell) const {
  const double margin = 0.5 * probe_ - slack_;
  for (std::size_t a = 0; a < 2; ++a) {
    const Extent& extent = ground_.axes[a];
    const double at = middle(a, cell[a]);
    if (!extent.periodic && (at < extent.least + margin || at > extent.most - margin)) return true;
  }
  return false;
}

void ProbeGrid::close_around(const InitialGrain& grain) {
  const double reach = 0.5 * (grain.diameter + probe_) - slack_;
  close_about(grain.position, reach);
  const Coordinates at = ground_.coordinates(grain.position);
  for (const Repeat& repeat : repeats_) {
    if (repeat.meets(ground_, at, reach)) close_about(repeat.of(grain.position), reach);
  }
}

void ProbeGrid::close_about(const Vec3& centre, double reach) {
  const Coordinates at = ground_.coordinates(centre);
  const double angle = reach < at[0] ? std::asin(reach / at[0]) : std::numbers::pi;
  const auto [first_a, end_a] = range(0, at[0], reach);
  const auto [first_b, end_b] = range(1, at[1], ground_.polar ? angle : reach);
  for (int a = first_a; a < end_a; ++a) {
    for (int b = first_b; b < end_b; ++b) {
      const double left = reach * reach - square(place({a, b, 0}, centre.z) - centre);
      if (left <= 0.0) continue;
      const auto [bottom, top] = range(2, centre.z, std::sqrt(left));
      const auto column = open_.begin() + static_cast<std::ptrdiff_t>(index({a, b, 0}));
      if (bottom < top) std::fill(column + bottom, column + top, std::uint8_t{0});
    }
  }
}

std::optional<Cell> ProbeGrid::neighbour(Cell cell, std::size_t axis, int step) const {
  int& k = cell[axis];
  k += step;
  if (axis < 2 && ground_.axes[axis].periodic) k = (k + count_[axis]) % count_[axis];
  if (k < 0 || k >= count_[axis]) return std::nullopt;
  return cell;
}

std::optional<Vec3> ProbeGrid::hole() const {
  std::vector<std::uint8_t> unseen = open_;
  std::vector<Cell> reached;
  const auto reach = [&](const Cell& cell) {
    if (std::exchange(unseen[index(cell)], std::uint8_t{0})) reached.push_back(cell);
  };
  every_column([&](const Cell& column) { reach({column[0], column[1], count_[2] - 1}); });
  while (!reached.empty()) {
    const Cell from = reached.back();
    if (from[2] == 0) return place(from, middle(2, 0));
    reached.pop_back();
    for (const std::size_t axis : {0u, 1u, 2u}) {
      for (const int step : {1, -1}) {
        if (const auto next = neighbour(from, axis, step)) reach(*next);
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<InitialGrain> hole_plugs(const Region& ground,
                                     std::span<const InitialGrain> layer,
                                     double diameter) {
  // Nearly all layers are without holes already on the coarse grid, which costs an eighth.
  const double coarse = diameter / 20.0;
  if (!ProbeGrid(ground, layer, diameter, coarse).hole()) return {};
  ProbeGrid grid(ground, layer, diameter, 0.5 * coarse);
  std::vector<InitialGrain> plugs;
  while (const auto hole = grid.hole()) {
    plugs.push_back({.position = ground.held(*hole, 0.5 * diameter),
                     .velocity = {},
                     .rotation = {},
                     .diameter = diameter,
                     .body = Body::base});
    grid.close_around(plugs.back());
  }
  return plugs;
}

}  // namespace grainlaw::dem
