#include "dem/random_packing.h"

#include <Random123/philox.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "dem/scene.h"

namespace grainlaw::dem {
namespace {

struct Sphere {
  Vec3 position;
  double radius = 0.0;
  double mobility = 0.0;  ///< inverse volume but for a factor, 0 when glued
};

/// Spheres sorted into cubes, to find the centres within one edge of a place.
class CellGrid {
 public:
  CellGrid(std::span<const Sphere> spheres, double edge);

  /// Calls visit(k) for every sphere k in the cell of `p` and its neighbours, in a fixed order.
  template <class Visit>
  void around(const Vec3& p, Visit visit) const {
    const std::array<int, 3> centre = cell(p);
    for (int z = centre[2] - 1; z <= centre[2] + 1; ++z) {
      for (int y = centre[1] - 1; y <= centre[1] + 1; ++y) {
        // The margin of empty cells around all of them keeps the row inside the grid.
        const std::size_t row = index({centre[0] - 1, y, z});
        for (std::size_t k = first_[row]; k < first_[row + 3]; ++k) visit(sorted_[k]);
      }
    }
  }

 private:
  std::array<int, 3> cell(const Vec3& p) const {
    const Vec3 offset = (1.0 / edge_) * (p - origin_);
    return {static_cast<int>(offset.x), static_cast<int>(offset.y), static_cast<int>(offset.z)};
  }
  std::size_t index(const std::array<int, 3>& c) const {
    return (static_cast<std::size_t>(c[2]) * size_[1] + c[1]) * size_[0] + c[0];
  }

  double edge_;
  Vec3 origin_;
  std::array<std::size_t, 3> size_{};
  std::vector<std::size_t> first_;  // of every cell, in sorted_
  std::vector<std::uint32_t> sorted_;
};

CellGrid::CellGrid(std::span<const Sphere> spheres, double edge) : edge_(edge) {
  Vec3 least = spheres.front().position;
  Vec3 most = least;
  for (const auto& [p, radius, mobility] : spheres) {
    least = {std::min(least.x, p.x), std::min(least.y, p.y), std::min(least.z, p.z)};
    most = {std::max(most.x, p.x), std::max(most.y, p.y), std::max(most.z, p.z)};
  }
  origin_ = least - Vec3{edge, edge, edge};
  const std::array<int, 3> last = cell(most);
  for (std::size_t axis = 0; axis < 3; ++axis)
    size_[axis] = static_cast<std::size_t>(last[axis]) + 2;
  first_.assign(size_[0] * size_[1] * size_[2] + 1, 0);
  for (const Sphere& sphere : spheres) ++first_[index(cell(sphere.position)) + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  sorted_.resize(spheres.size());
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    sorted_[next[index(cell(spheres[k].position))]++] = static_cast<std::uint32_t>(k);
  }
}

/// Grains are moved apart with a margin around them of this share of their size, until no margin is
/// used up: what is left has no overlap at all, which in stiff grains would be an explosion.
constexpr double margin = 1e-3;

/// Grains on their way apart. Images of grains near a periodic face follow the grains themselves,
/// so a sweep knows nothing of periods.
class Relaxation {
 public:
  Relaxation(const Region& region, std::span<const InitialGrain> grains);

  /// Pushes every pair whose margins overlap apart once, unless no grains overlap any more. Returns
  /// the largest overlap of margins before [mean diameter of the pair].
  double sweep();

  Vec3 position(std::size_t grain) const { return region_.wrapped(spheres_[grain].position); }

 private:
  struct Ghost {
    std::uint32_t grain;
    std::uint32_t repeat;
  };

  void list_neighbours();
  void add_ghosts();
  void follow();
  Vec3 push(std::size_t grain, double& largest) const;

  Region region_;
  std::vector<Repeat> repeats_;
  std::size_t grains_;
  double largest_radius_ = 0.0;
  double skin_;
  double travelled_ = std::numeric_limits<double>::infinity();
  std::vector<Sphere> spheres_;  // the grains, then the ghosts
  std::vector<Vec3> next_;
  std::vector<Ghost> ghosts_;
  std::vector<std::size_t> first_;  // of a grain's row of neighbours
  std::vector<std::uint32_t> neighbours_;
};

Relaxation::Relaxation(const Region& region, std::span<const InitialGrain> grains)
    : region_(region), repeats_(repeats(region)), grains_(grains.size()), next_(grains.size()) {
  double sum = 0.0;
  for (const InitialGrain& grain : grains) {
    const double radius = 0.5 * grain.diameter / (1.0 - margin);
    const bool mobile = grain.body == Body::none;
    spheres_.push_back({mobile ? region.held(grain.position, radius) : grain.position,
                        radius,
                        mobile ? 1.0 / (radius * radius * radius) : 0.0});
    largest_radius_ = std::max(largest_radius_, radius);
    sum += radius;
  }
  skin_ = 0.5 * sum / static_cast<double>(grains_);  // a quarter of the mean diameter
  const double reach = 2.0 * largest_radius_ + skin_;
  if (region_.shortest_repeat() < reach) {
    throw SceneError(fmt::format("the packing repeats after {:.4g}: must be at least {:.4g}, else "
                                 "a grain meets its own image; enlarge the box",
                                 region_.shortest_repeat(),
                                 reach),
                     "geometry",
                     "");
  }
}

void Relaxation::add_ghosts() {
  ghosts_.clear();
  const double reach = 2.0 * largest_radius_ + skin_;
  for (std::size_t i = 0; i < grains_; ++i) {
    const Coordinates c = region_.coordinates(spheres_[i].position);
    for (std::size_t k = 0; k < repeats_.size(); ++k) {
      if (!repeats_[k].meets(region_, c, reach)) continue;
      ghosts_.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k)});
    }
  }
  for (const Ghost& ghost : ghosts_) spheres_.push_back(spheres_[ghost.grain]);
}

void Relaxation::follow() {
  for (std::size_t g = 0; g < ghosts_.size(); ++g) {
    const Vec3& original = spheres_[ghosts_[g].grain].position;
    spheres_[grains_ + g].position = repeats_[ghosts_[g].repeat].of(original);
  }
}

void Relaxation::list_neighbours() {
  spheres_.resize(grains_);
  for (Sphere& sphere : spheres_) sphere.position = region_.wrapped(sphere.position);
  add_ghosts();
  follow();
  const CellGrid grid(spheres_, 2.0 * largest_radius_ + skin_);
  first_.assign(1, 0);
  neighbours_.clear();
  for (std::size_t i = 0; i < grains_; ++i) {
    const Sphere& sphere = spheres_[i];
    const auto list_if_near = [&](std::uint32_t j) {
      const double reach = sphere.radius + spheres_[j].radius + skin_;
      const bool near = square(sphere.position - spheres_[j].position) < reach * reach;
      if (near && j != i) neighbours_.push_back(j);
    };
    if (sphere.mobility > 0.0) grid.around(sphere.position, list_if_near);
    first_.push_back(neighbours_.size());
  }
  travelled_ = 0.0;
}

/// Half of every overlap for equal grains. Shares go by volume, so that the many small grains
/// around a large one do not add up to a leap of it.
Vec3 Relaxation::push(std::size_t i, double& largest) const {
  const Sphere& sphere = spheres_[i];
  Vec3 move;
  for (std::size_t k = first_[i]; k < first_[i + 1]; ++k) {
    const Sphere& other = spheres_[neighbours_[k]];
    const Vec3 branch = sphere.position - other.position;
    const double touching = sphere.radius + other.radius;
    const double squared = square(branch);
    if (squared >= touching * touching || squared == 0.0) continue;
    const double distance = std::sqrt(squared);
    const double share = sphere.mobility / (sphere.mobility + other.mobility);
    largest = std::max(largest, (touching - distance) / touching);
    move += (share * (touching - distance) / distance) * branch;
  }
  return move;
}

double Relaxation::sweep() {
  if (2.0 * travelled_ > skin_) {
    list_neighbours();
  } else {
    follow();
  }
  double largest = 0.0;
  double farthest = 0.0;
  for (std::size_t i = 0; i < grains_; ++i) {
    const auto& [position, radius, mobility] = spheres_[i];
    next_[i] = mobility > 0.0 ? region_.held(position + push(i, largest), radius) : position;
    farthest = std::max(farthest, square(next_[i] - position));
  }
  if (largest <= margin) return largest;
  for (std::size_t i = 0; i < grains_; ++i) spheres_[i].position = next_[i];
  travelled_ += std::sqrt(farthest);
  return largest;
}

}  // namespace

std::array<double, 4> random_numbers(std::uint64_t seed, std::uint32_t k) {
  const r123::Philox4x32::key_type key{
      {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}};
  const auto bits = r123::Philox4x32{}({{k, 0, 0, 0}}, key);
  const auto unit = [](std::uint32_t b) { return (b + 0.5) * 0x1p-32; };
  return {unit(bits[0]), unit(bits[1]), unit(bits[2]), unit(bits[3])};
}

Region region_of(const Box& box) {
  const auto axis = [](double period) { return Extent{0.0, period, period > 0.0}; };
  return {{axis(box.period.x), axis(box.period.y), axis(box.period.z)}};
}

std::vector<Vec3> scatter(const Region& region, std::size_t count, std::uint64_t seed) {
  const auto& [first, second, third] = region.axes;
  const auto between = [](double a, double b, double share) { return a + (b - a) * share; };
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < count; ++k) {
    const auto random = random_numbers(seed, static_cast<std::uint32_t>(k));
    const double along =
        region.polar
            ? std::sqrt(between(first.least * first.least, first.most * first.most, random[0]))
            : between(first.least, first.most, random[0]);
    points.push_back(region.position({along,
                                      between(second.least, second.most, random[1]),
                                      between(third.least, third.most, random[2])}));
  }
  return points;
}

void come_apart(const Region& region,
                std::vector<InitialGrain>& grains,
                const KeepGoing& keep_going) {
  constexpr int most_sweeps = 20000;
  if (grains.empty()) return;
  Relaxation relaxation(region, grains);
  double overlap = relaxation.sweep();
  for (int sweep = 1; overlap > margin && sweep < most_sweeps; ++sweep) {
    stop_unless(keep_going);
    overlap = relaxation.sweep();
  }
  if (overlap > margin) {
    throw SceneError(fmt::format("{} grains still overlap by {:.2g} of their diameter after {} "
                                 "sweeps, packed too densely; lower the volume fraction",
                                 grains.size(),
                                 overlap - margin,
                                 most_sweeps),
                     "geometry",
                     "");
  }
  for (std::size_t i = 0; i < grains.size(); ++i) {
    if (grains[i].body == Body::none) grains[i].position = relaxation.position(i);
  }
}

std::vector<Vec3> random_packing(const Box& box,
                                 std::span<const double> diameters,
                                 std::uint64_t seed) {
  const Region region = region_of(box);
  std::vector<Vec3> points = scatter(region, diameters.size(), seed);
  std::vector<InitialGrain> grains(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    grains[k].position = points[k];
    grains[k].diameter = diameters[k];
  }
  come_apart(region, grains);
  std::transform(grains.begin(), grains.end(), points.begin(), [](const InitialGrain& g) {
    return g.position;
  });
  return points;
}

}  // namespace grainlaw::dem
