#include "dem/neighbour_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "dem/simd.h"

namespace grainlaw::dem {
namespace {

/// Cells along one axis; at least as wide as the longest reach.
struct Axis {
  double begin = 0.0;
  double per_length = 1.0;  // cells
  int cells = 1;
  bool periodic = false;

  /// Of a point anywhere; outside the box where a Lees-Edwards image is.
  int cell(double x) const {
    const int k = static_cast<int>(std::floor((x - begin) * per_length));
    return periodic ? k : std::clamp(k, 0, cells - 1);
  }
};

Axis axis(double period, double reach, double lowest, double highest, std::size_t grains) {
  const double extent = period > 0.0 ? period : highest - lowest;
  // More cells than grains are useless: what lies beyond shares the last one.
  const double wanted = std::min(std::floor(extent / reach), static_cast<double>(grains));
  const int cells = std::max(1, static_cast<int>(wanted));
  if (period > 0.0) return {0.0, cells / period, cells, true};
  return {lowest, 1.0 / reach, cells + 1, false};
}

/// A neighbouring cell along an axis: where it is, and through which face it was reached (-1, 0,
/// 1).
struct Step {
  int cell;
  int face;
};

/// Of the three cells around `cell`; the number found goes to `count`.
std::array<Step, 3> steps(const Axis& axis, int cell, int& count) {
  std::array<Step, 3> found{};
  count = 0;
  for (int k = cell - 1; k <= cell + 1; ++k) {
    if (axis.periodic) {
      const int face = k < 0 ? -1 : k >= axis.cells ? 1 : 0;
      const int inside = k - face * axis.cells;
      // A whole period beyond the face: too far, for a point displaced by half a period at most.
      if (inside >= 0 && inside < axis.cells) found[count++] = {inside, face};
    } else if (k >= 0 && k < axis.cells) {
      found[count++] = {k, 0};
    }
  }
  return found;
}

struct Grid {
  Axis x, y, z;

  std::size_t size() const { return static_cast<std::size_t>(x.cells) * y.cells * z.cells; }
  std::size_t row(int j, int k) const {
    return (static_cast<std::size_t>(k) * y.cells + j) * x.cells;
  }
  std::size_t cell(const Vec3& p) const {
    // A point on the upper face of a periodic axis, by rounding, belongs to the last cell.
    const auto inside = [](const Axis& axis, double at) {
      return std::clamp(axis.cell(at), 0, axis.cells - 1);
    };
    return row(inside(y, p.y), inside(z, p.z)) + inside(x, p.x);
  }
};

Grid grid(const Particles& particles, const Box& box, double reach) {
  Vec3 low = particles.state.front().position;
  Vec3 high = low;
  for (const GrainState& grain : particles.state) {
    const Vec3& p = grain.position;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const std::size_t n = particles.size();
  return {axis(box.period.x, reach, low.x, high.x, n),
          axis(box.period.y, reach, low.y, high.y, n),
          axis(box.period.z, reach, low.z, high.z, n)};
}

double largest_radius(const Particles& particles) {
  double largest = 0.0;
  for (const GrainState& grain : particles.state) largest = std::max(largest, grain.radius);
  return largest;
}

/// Grains of every cell: first[c] to first[c + 1] of `order`, ascending within a cell.
struct Cells {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> order;

  Cells(const Grid& grid, const Particles& particles, std::size_t begin, std::size_t end)
      : first(grid.size() + 1, 0), order(end - begin) {
    std::vector<std::uint32_t> cell(end - begin);
    for (std::size_t i = begin; i < end; ++i) {
      cell[i - begin] = static_cast<std::uint32_t>(grid.cell(particles.state[i].position));
      ++first[cell[i - begin] + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::size_t i = begin; i < end; ++i) {
      order[next[cell[i - begin]]++] = static_cast<std::uint32_t>(i);
    }
  }
};

/// Calls visit(begin, end, image) for every stretch of cells around p: neighbours along x lie one
/// behind the other unless a face is between them.
template <class Visit>
void for_stretches(const Grid& grid, const Box& box, const Vec3& p, Visit&& visit) {
  int ny, nz, nx;
  const auto zs = steps(grid.z, grid.z.cell(p.z), nz);
  const auto ys = steps(grid.y, grid.y.cell(p.y), ny);
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      const std::size_t row = grid.row(ys[j].cell, zs[k].cell);
      const Image image = own_image + 3 * ys[j].face + 9 * zs[k].face;
      const double x = p.x - ys[j].face * box.offset;
      const int cell = grid.x.cell(x);
      const auto xs = steps(grid.x, cell, nx);
      if (nx > 0 && xs[0].face == xs[nx - 1].face) {
        visit(row + xs[0].cell, row + xs[nx - 1].cell + 1, image + xs[0].face);
      } else {
        for (int i = 0; i < nx; ++i)
          visit(row + xs[i].cell, row + xs[i].cell + 1, image + xs[i].face);
      }
    }
  }
}

}  // namespace

std::vector<std::uint32_t> NeighbourList::cell_order(const Particles& particles,
                                                     const Box& box) const {
  if (particles.size() == 0) return {};
  const Grid cells = grid(particles, box, reach(2.0 * largest_radius(particles)));
  std::vector<std::uint32_t> order = Cells(cells, particles, 0, particles.mobile).order;
  const auto frozen = Cells(cells, particles, particles.mobile, particles.real).order;
  order.insert(order.end(), frozen.begin(), frozen.end());
  return order;
}

void NeighbourList::build(const Particles& particles,
                          const Box& box,
                          std::span<const std::uint32_t> foot_of) {
  partners_.clear();
  first_.clear();
  row_begin_.assign(1, 0);
  if (particles.size() == 0) return close();
  const Grid cells = grid(particles, box, reach(2.0 * largest_radius(particles)));
  const std::size_t first_foot = particles.size() - foot_of.size();
  const Cells mobile(cells, particles, 0, particles.mobile);
  const Cells others(cells, particles, particles.mobile, first_foot);
  const auto shifts = box.image_shifts();
  std::size_t foot = 0;
  for (std::uint32_t i = 0; i < particles.mobile; ++i) {
    const GrainState& grain = particles.state[i];
    const double reach_of_i = reach(grain.radius);
    const auto add = [&](const Cells& candidates, std::size_t begin, std::size_t end, Image image) {
      const Vec3 seen = grain.position - shifts[image].position;
      for (std::uint32_t k = candidates.first[begin]; k < candidates.first[end]; ++k) {
        const std::uint32_t j = candidates.order[k];
        const GrainState& other = particles.state[j];
        const double near = reach_of_i + other.radius;
        if (j > i && square(seen - other.position) < near * near) {
          partners_.push_back(Partner::of(j, image));
        }
      }
    };
    for_stretches(cells, box, grain.position, [&](std::size_t begin, std::size_t end, Image image) {
      add(mobile, begin, end, image);
    });
    for_stretches(cells, box, grain.position, [&](std::size_t begin, std::size_t end, Image image) {
      add(others, begin, end, image);
    });
    for (; foot < foot_of.size() && foot_of[foot] == i; ++foot) {
      partners_.push_back(Partner::of(first_foot + foot, own_image));
    }
    row_begin_.push_back(static_cast<std::uint32_t>(partners_.size()));
    first_.resize(partners_.size(), i);
  }
  close();
}

/// Room behind the last pair for loops that take several at once.
void NeighbourList::close() {
  first_.resize(row_begin_.back() + pack_width, 0u);
  partners_.resize(row_begin_.back() + pack_width, Partner::of(0, own_image));
}

void NeighbourList::restore(std::vector<std::uint32_t> row_begin, std::vector<Partner> partners) {
  row_begin_ = std::move(row_begin);
  partners_ = std::move(partners);
  first_.clear();
  for (std::uint32_t i = 0; i + 1 < row_begin_.size(); ++i) first_.resize(row_begin_[i + 1], i);
  close();
}

}  // namespace grainlaw::dem
