#include "dem/neighbour_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace grainlaw::dem {
namespace {

/// Cells along one axis; at least as wide as the cutoff.
struct Axis {
  double begin = 0.0;
  double width = 1.0;
  int cells = 1;
  bool periodic = false;

  int cell(double x) const {
    return std::clamp(static_cast<int>(std::floor((x - begin) / width)), 0, cells - 1);
  }

  /// The cell itself and its neighbours, each once.
  int neighbours(int cell, std::array<int, 3>& found) const {
    int count = 0;
    for (int k = cell - 1; k <= cell + 1; ++k) {
      if (!periodic && (k < 0 || k >= cells)) continue;
      const int wrapped = (k + cells) % cells;
      if (std::find(found.begin(), found.begin() + count, wrapped) == found.begin() + count) {
        found[count++] = wrapped;
      }
    }
    return count;
  }
};

Axis axis(double period, double cutoff, double lowest, double highest, std::size_t grains) {
  const double extent = period > 0.0 ? period : highest - lowest;
  // More cells than grains are useless: what lies beyond shares the last one.
  const double wanted = std::min(std::floor(extent / cutoff), static_cast<double>(grains));
  const int cells = std::max(1, static_cast<int>(wanted));
  if (period > 0.0) return {0.0, period / cells, cells, true};
  return {lowest, cutoff, cells + 1, false};
}

}  // namespace

struct NeighbourList::Grid {
  Axis x, y, z;

  std::size_t size() const { return static_cast<std::size_t>(x.cells) * y.cells * z.cells; }
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * y.cells + j) * x.cells + i;
  }
  std::size_t cell(const Vec3& p) const { return index(x.cell(p.x), y.cell(p.y), z.cell(p.z)); }

  int neighbours(const Vec3& p, std::array<std::size_t, 27>& found) const {
    std::array<int, 3> xs, ys, zs;
    const int nx = x.neighbours(x.cell(p.x), xs);
    const int ny = y.neighbours(y.cell(p.y), ys);
    const int nz = z.neighbours(z.cell(p.z), zs);
    int count = 0;
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) found[count++] = index(xs[i], ys[j], zs[k]);
      }
    }
    return count;
  }

  /// First grain of every cell among sorted grains [begin, end).
  std::vector<std::uint32_t> first(const Particles& particles,
                                   std::size_t begin,
                                   std::size_t end) const {
    std::vector<std::uint32_t> first(size() + 1, 0);
    for (std::size_t i = begin; i < end; ++i) ++first[cell(particles.state[i].position) + 1];
    first[0] = static_cast<std::uint32_t>(begin);
    std::partial_sum(first.begin(), first.end(), first.begin());
    return first;
  }
};

NeighbourList::NeighbourList(const Box& box, double reach, double skin)
    : box_(box), cutoff_(reach + skin), skin_(skin) {}

NeighbourList::Grid NeighbourList::grid(const Particles& particles) const {
  Vec3 low = particles.state.front().position;
  Vec3 high = low;
  for (const GrainState& grain : particles.state) {
    const Vec3& p = grain.position;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const std::size_t n = particles.size();
  return {axis(box_.period.x, cutoff_, low.x, high.x, n),
          axis(box_.period.y, cutoff_, low.y, high.y, n),
          axis(box_.period.z, cutoff_, low.z, high.z, n)};
}

std::vector<std::uint32_t> NeighbourList::cell_order(const Particles& particles) const {
  if (particles.size() == 0) return {};
  const Grid cells = grid(particles);
  std::vector<std::size_t> cell(particles.size());
  for (std::size_t i = 0; i < cell.size(); ++i) cell[i] = cells.cell(particles.state[i].position);
  std::vector<std::uint32_t> order(particles.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto by_cell = [&](std::uint32_t a, std::uint32_t b) { return cell[a] < cell[b]; };
  const auto frozen = order.begin() + static_cast<std::ptrdiff_t>(particles.mobile);
  std::stable_sort(order.begin(), frozen, by_cell);
  std::stable_sort(frozen, order.end(), by_cell);
  return order;
}

void NeighbourList::build(const Particles& particles) {
  partners_.clear();
  row_begin_.assign(1, 0);
  if (particles.size() == 0) return;
  const Grid cells = grid(particles);
  const auto mobile = cells.first(particles, 0, particles.mobile);
  const auto frozen = cells.first(particles, particles.mobile, particles.size());
  const auto shifts = box_.image_shifts();
  const double cutoff2 = cutoff_ * cutoff_;
  std::array<std::size_t, 27> near{};
  for (std::uint32_t i = 0; i < particles.mobile; ++i) {
    const Vec3 position = particles.state[i].position;
    const auto add = [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t j = std::max(begin, i + 1); j < end; ++j) {
        const Vec3 difference = position - particles.state[j].position;
        const Image image = box_.nearest_image(difference);
        if (square(difference - shifts[image]) < cutoff2)
          partners_.push_back(Partner::of(j, image));
      }
    };
    const int count = cells.neighbours(position, near);
    for (int k = 0; k < count; ++k) add(mobile[near[k]], mobile[near[k] + 1]);
    for (int k = 0; k < count; ++k) add(frozen[near[k]], frozen[near[k] + 1]);
    row_begin_.push_back(static_cast<std::uint32_t>(partners_.size()));
  }
}

}  // namespace grainlaw::dem
