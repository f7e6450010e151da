#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "dem/acting_pairs.h"
#include "dem/contact_law.h"
#include "dem/neighbour_list.h"
#include "dem/particles.h"

namespace grainlaw::dem {

/// How far the centres of some pairs are apart.
struct Separations {
  Pack distance2;   ///< [length^2]
  Pack radius_sum;  ///< [length]

  /// Bits of the pairs whose surfaces are closer than `gap`.
  std::uint32_t closer_than(double gap) const {
    const Pack near = radius_sum + gap;
    return bits(distance2 < near * near);
  }
};

/// Of the pairs k to k + pack_width; `shifts` are those of the images.
[[gnu::always_inline]] inline Separations separations(const ImageShift* shifts,
                                                      const GrainState* state,
                                                      const std::uint32_t* first,
                                                      const Partner* partner) {
  alignas(32) static constexpr double sign[4] = {-1, -1, -1, 1};
  const Row4 minus = load_row4(sign);
  Row4 rows[pack_width];
  for (std::size_t k = 0; k < pack_width; ++k) {
    const Row4 there = load_row4(&state[partner[k].grain()].position.x) +
                       load_row4(&shifts[partner[k].image()].position.x);
    rows[k] = load_row4(&state[first[k]].position.x) + minus * there;
  }
  Pack column[4];
  columns_of(rows, column);
  return {square(Vector3<Pack>{column[0], column[1], column[2]}), column[3]};
}

/// Bits of the pairs k to k + pack_width whose surfaces are closer than `gap`.
[[gnu::always_inline]] inline std::uint32_t closer_than(double gap,
                                                        const ContactSetting& setting,
                                                        const GrainState* state,
                                                        const std::uint32_t* first,
                                                        const Partner* partner) {
  return separations(setting.shifts.data(), state, first, partner).closer_than(gap);
}

/// 2 R_i R_j / (R_i + R_j), or 2 R_i at a wall (R_j = 0) [length].
inline double harmonic_radius(double a, double b) {
  return b == 0.0 ? 2.0 * a : 2.0 * a * b / (a + b);
}

/// Chooses from the list the pairs of a strip that may come within `range` while surfaces approach
/// by less than `skin`, and those that acted at the last step.
template <class Law>
void search_near(double range,
                 double skin,
                 const ContactSetting& setting,
                 const Particles& particles,
                 const NeighbourList& list,
                 const std::vector<std::uint32_t>& load,
                 const PairMemory& memory,
                 Strip& strip) {
  const std::uint32_t begin = list.row_begin(strip.begin);
  const std::uint32_t end = list.row_begin(strip.end);
  PairArrays& near = strip.near;
  near.reserve(end - begin);
  near.count = 0;
  std::array<std::uint32_t, pack_width> pairs;
  for (std::uint32_t p = begin; p < end; p += pack_width) {
    const std::uint32_t lanes = std::min<std::uint32_t>(pack_width, end - p);
    std::uint32_t chosen = closer_than(
        range + skin, setting, particles.state.data(), list.first() + p, list.partners() + p);
    for (std::uint32_t k = 0; k < pack_width; ++k) pairs[k] = p + k;
    if constexpr (Law::keeps_history) {
      for (std::uint32_t k = 0; k < lanes; ++k) chosen |= std::uint32_t{memory.active[p + k]} << k;
    }
    chosen &= (1u << lanes) - 1u;
    const std::size_t n = near.count;
    compress(list.first() + p, chosen, near.first.data() + n);
    compress(&list.partners()[p].bits, chosen, near.partner.data() + n);
    compress(load.data() + p, chosen, near.load.data() + n);
    near.count += compress(pairs.data(), chosen, near.pair.data() + n);
  }
  for (std::size_t k = near.count; k < near.count + pack_width; ++k) {
    near.first[k] = 0;
    near.partner[k] = Partner::of(0, own_image).bits;
  }
  if constexpr (Law::keeps_history) {
    strip.near_active.assign(near.count / pack_width + 1, 0);
    for (std::size_t k = 0; k < near.count; ++k) {
      const auto bit = static_cast<std::uint8_t>(memory.active[near.pair[k]] << k % pack_width);
      strip.near_active[k / pack_width] =
          static_cast<std::uint8_t>(strip.near_active[k / pack_width] | bit);
    }
  }
}

/// A pair that no longer acts forgets; what its spring or bridge held is lost.
template <class Law>
void release(const Law& law,
             const Particles& particles,
             std::uint32_t first,
             Partner partner,
             std::uint32_t pair,
             PairMemory& memory,
             ContactSums& sums) {
  if constexpr (Law::rotates) {
    if constexpr (decltype(law.normal)::constant_prefactor) {
      sums.spring_lost += spring_energy(law.friction, memory.spring[pair].stretch, 1.0);
    }
    memory.spring[pair] = {};
  }
  if constexpr (Law::bridges) {
    if (memory.bridge[pair]) {
      const double radius =
          harmonic_radius(particles.state[first].radius, particles.state[partner.grain()].radius);
      sums.bridge_lost += law.cohesion.rupture_energy(radius);
      memory.bridge[pair] = 0;
    }
  }
}

/// Appends to `acting` those of the near pairs [begin, end) that act now; begin is a multiple of
/// pack_width.
template <class Law>
void find_acting(const Law& law,
                 const ContactSetting& setting,
                 const Particles& particles,
                 PairMemory& memory,
                 Strip& strip,
                 std::size_t begin,
                 std::size_t end) {
  const PairArrays& near = strip.near;
  PairArrays& acting = strip.acting;
  for (std::size_t k = begin; k < end; k += pack_width) {
    std::uint32_t act = closer_than(law.range(),
                                    setting,
                                    particles.state.data(),
                                    near.first.data() + k,
                                    reinterpret_cast<const Partner*>(&near.partner[k]));
    if (near.count - k < pack_width) act &= (1u << (near.count - k)) - 1u;
    if constexpr (Law::keeps_history) {
      std::uint8_t& active = strip.near_active[k / pack_width];
      for (std::uint32_t opened = active & ~act; opened != 0; opened &= opened - 1) {
        const std::size_t at = k + static_cast<std::size_t>(__builtin_ctz(opened));
        release(law,
                particles,
                near.first[at],
                Partner{near.partner[at]},
                near.pair[at],
                memory,
                strip.sums);
      }
      active = static_cast<std::uint8_t>(act);
    }
    const std::size_t n = acting.count;
    compress(&near.first[k], act, &acting.first[n]);
    compress(&near.partner[k], act, &acting.partner[n]);
    compress(&near.load[k], act, &acting.load[n]);
    acting.count += compress(&near.pair[k], act, &acting.pair[n]);
  }
}

}  // namespace grainlaw::dem
