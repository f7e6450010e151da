#include "dem/packing.h"

#include <Random123/philox.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem/neighbour_list.h"
#include "dem/simulation.h"

namespace grainlaw::dem {
namespace {

/// Uniform in the box; grain k depends on the seed and k only.
Vec3 random_point(const Vec3& extent, std::uint64_t seed, std::uint32_t k) {
  const r123::Philox4x32::key_type key{
      {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}};
  const auto bits = r123::Philox4x32{}({{k, 0, 0, 0}}, key);
  const auto unit = [](std::uint32_t b) { return (b + 0.5) * 0x1p-32; };
  return {extent.x * unit(bits[0]), extent.y * unit(bits[1]), extent.z * unit(bits[2])};
}

/// Moves every overlapping pair apart by half its overlap each; returns the largest overlap seen
/// and adds the largest displacement to `travelled`.
double push_apart(Particles& particles,
                  const NeighbourList& list,
                  const Box& box,
                  double diameter,
                  double& travelled) {
  const auto shifts = box.image_shifts();
  std::vector<Vec3> move(particles.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    for (auto pair = list.row_begin(i); pair < list.row_begin(i + 1); ++pair) {
      const Partner partner = list.partners()[pair];
      const Vec3 branch = particles.state[i].position -
                          (particles.state[partner.grain()].position + shifts[partner.image()]);
      const double distance = length(branch);
      if (distance >= diameter || distance == 0.0) continue;
      largest = std::max(largest, diameter - distance);
      const Vec3 push = (0.5 * (diameter - distance) / distance) * branch;
      move[i] += push;
      move[partner.grain()] -= push;
    }
  }
  double fastest = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles.state[i].position += move[i];
    fastest = std::max(fastest, length(move[i]));
  }
  travelled += fastest;
  return largest;
}

}  // namespace

std::vector<Vec3> random_packing(
    const Box& box, std::size_t grains, double diameter, std::uint64_t seed, double overlap_bound) {
  constexpr int most_sweeps = 20000;
  InitialState initial;
  for (std::size_t k = 0; k < grains; ++k) {
    initial.position.push_back(random_point(box.period, seed, static_cast<std::uint32_t>(k)));
  }
  Particles particles = make_particles(initial, false);
  NeighbourList list(box, diameter, 0.25 * diameter);
  double travelled = INFINITY;
  int sweep = 0;
  for (double overlap = diameter; overlap > overlap_bound * diameter; ++sweep) {
    if (sweep == most_sweeps) {
      throw SceneError(
          fmt::format("{} grains in {:.4g} x {:.4g} x {:.4g} still overlap by {:.2g} d "
                      "after {} sweeps; lower the packing fraction of the base",
                      grains,
                      box.period.x,
                      box.period.y,
                      box.period.z,
                      overlap / diameter,
                      most_sweeps));
    }
    if (2.0 * travelled > list.skin()) {
      wrap(particles, box);
      reorder(particles, list.cell_order(particles));
      list.build(particles);
      travelled = 0.0;
    }
    overlap = push_apart(particles, list, box, diameter, travelled);
  }
  wrap(particles, box);
  std::vector<Vec3> positions(grains);
  for (std::size_t i = 0; i < grains; ++i) positions[particles.id[i]] = particles.state[i].position;
  return positions;
}

ChuteGrains pack_chute(const Scene& scene) {
  const Chute& chute = scene.geometry;
  const double d = scene.grains.diameter;
  const double fraction = chute.base.packing_fraction;
  const double grain_volume = std::numbers::pi / 6.0 * d * d * d;
  const double area = chute.length * chute.width;
  // Two diameters more than base and column need, so that the cut never runs short.
  const double height =
      (chute.base.thickness + 2.0) * d + chute.grains * grain_volume / (fraction * area);
  const Box packed{{chute.length, chute.width, height}};
  const auto count = static_cast<std::size_t>(fraction * area * height / grain_volume);
  std::vector<Vec3> grains = random_packing(packed, count, d, scene.seed);
  std::sort(grains.begin(), grains.end(), [](const Vec3& a, const Vec3& b) { return a.z < b.z; });

  ChuteGrains result{.box = {{chute.length, chute.width, 0.0}}, .base = {}, .column = {}};
  const auto above = std::find_if(
      grains.begin(), grains.end(), [&](const Vec3& p) { return p.z >= chute.base.thickness * d; });
  if (above == grains.begin() || grains.end() - above < chute.grains) {
    throw SceneError(
        fmt::format("a packing of {} grains leaves {} above a base of {}, {} are wanted; "
                    "enlarge length and width",
                    count,
                    grains.end() - above,
                    above - grains.begin(),
                    chute.grains));
  }
  const double top = std::prev(above)->z + 0.5 * d;
  for (auto p = grains.begin(); p != above + chute.grains; ++p) {
    (p < above ? result.base : result.column).push_back({p->x, p->y, p->z - top});
  }
  return result;
}

}  // namespace grainlaw::dem
