#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>

#include "dem/acting_pairs.h"
#include "dem/contact_law.h"
#include "dem/neighbour_list.h"
#include "dem/pair_search.h"
#include "dem/particles.h"

namespace grainlaw::dem {

/// For steps that nobody looks at.
struct NoRecord {};

/// What a contact dissipates in a step, dashpots and sliding together, and of it by sliding
/// [energy]; 0 for one that does not slide.
struct ContactLoss {
  double all = 0.0;
  double sliding = 0.0;
};

namespace detail {

inline Row8 difference_sign() {  // positions, velocities: first - partner; the others: sum
  alignas(64) static constexpr double sign[8] = {-1, -1, -1, 1, -1, -1, -1, 1};
  return Row8::load(sign);
}
inline Row8 reaction_sign() {  // force: opposite on the partner; torque / radius: the same
  alignas(64) static constexpr double sign[8] = {-1, -1, -1, -1, 1, 1, 1, 1};
  return Row8::load(sign);
}
inline PackMask first_lanes(std::size_t lanes) {
  return mask_of((1u << lanes) - 1u);
}

}  // namespace detail

/// A pack of acting pairs as the laws see it; lanes without a pair repeat the first one, far apart.
struct PackOfPairs {
  std::array<std::uint32_t, pack_width> first;
  std::array<std::uint32_t, pack_width> second;
  std::array<std::uint32_t, pack_width> image;
  std::array<std::uint32_t, pack_width> pair;
  Vector3<Pack> branch;    ///< from the second to the first [length]
  Pack radius_sum;         ///< [length]
  Vector3<Pack> velocity;  ///< of the first against the second [length/time]
  Pack inverse_mass;       ///< sum of 1/m [1/mass]
  Vector3<Pack> spin;      ///< sum of R omega [length/time]
  Pack grip;               ///< sum of grips
  TangentialSpring<Pack> spring;
  Vector3<Pack> force;    ///< on the first, the result [force]
  Vector3<Pack> torque;   ///< on both, over their radius [force]
  Pack dissipated = 0.0;  ///< in this step, for records [energy]
  Pack slip = 0.0;        ///< of it, by sliding [energy]
};

/// Sums over packs, before the lanes are added up.
struct PackSums {
  Pack normal_dashpot = 0.0;
  Pack tangential_dashpot = 0.0;
  Pack slip = 0.0;
  Pack tangential_energy = 0.0;
  Pack spring_lost = 0.0;
  Pack prefactor_work = 0.0;
  Pack virial_yy = 0.0;
  Pack largest_overlap = 0.0;  ///< [length] for equal sizes, else of the smaller radius
};

/// The forces of acting pairs on both their grains. Everything is inlined into one loop, so that
/// what belongs to a pack stays in registers.
template <class Law>
class ForceLoop {
 public:
  ForceLoop(const Law& law, const ContactSetting& setting, Particles& particles, PairMemory& memory)
      : law_(law), setting_(setting), particles_(particles), memory_(memory) {}

  /// Adds the forces of acting pairs [begin, end) of the strip; record(first, partner, branch,
  /// force_on_first, loss) sees each of them.
  template <class Record>
  void add(Strip& strip, std::size_t begin, std::size_t end, Record&& record) {
    PackSums sums = sums_;
    std::size_t k = begin;
    for (; k + 2 * pack_width <= end; k += 2 * pack_width) {
      PackOfPairs a = load_pairs(strip.acting, k, pack_width);
      PackOfPairs b = load_pairs(strip.acting, k + pack_width, pack_width);
      compute(a, pack_width, sums);
      compute(b, pack_width, sums);
      scatter(strip, k, pack_width, a, record);
      scatter(strip, k + pack_width, pack_width, b, record);
    }
    for (; k < end; k += pack_width) {
      const std::size_t lanes = std::min(pack_width, end - k);
      PackOfPairs pairs = load_pairs(strip.acting, k, lanes);
      compute(pairs, lanes, sums);
      scatter(strip, k, lanes, pairs, record);
    }
    sums_ = sums;
  }

  /// Adds up the lanes, once for all pairs: sums must not depend on how many are taken at a time.
  void finish(Strip& strip) const { add_lanes(sums_, strip.sums); }

 private:
  PackOfPairs load_pairs(const PairArrays& acting, std::size_t k, std::size_t lanes) const;
  void compute(PackOfPairs& pairs, std::size_t lanes, PackSums& sums) const;
  ContactOf<Pack> contact(const PackOfPairs& pairs, const PackMask& valid) const;
  PackMask update_bridges(const PackOfPairs& pairs,
                          const PackMask& touches,
                          std::size_t lanes) const;
  Pack overlap_to_watch(const PackOfPairs& pairs, const ContactOf<Pack>& contact) const;
  template <class Record>
  void scatter(Strip& strip,
               std::size_t k,
               std::size_t lanes,
               const PackOfPairs& pairs,
               Record&& record) const;
  void add_lanes(const PackSums& from, ContactSums& to) const;

  const Law& law_;
  const ContactSetting& setting_;
  Particles& particles_;
  PairMemory& memory_;
  PackSums sums_;
};

template <class Law>
[[gnu::always_inline]] inline PackOfPairs ForceLoop<Law>::load_pairs(const PairArrays& acting,
                                                                     std::size_t k,
                                                                     std::size_t lanes) const {
  PackOfPairs pairs;
  Row8 rows[pack_width];
  Row4 spins[pack_width];
  Row4 springs[pack_width];
  for (std::size_t lane = 0; lane < pack_width; ++lane) {
    const std::size_t at = lane < lanes ? k + lane : k;
    const Partner partner{acting.partner[at]};
    pairs.first[lane] = acting.first[at];
    pairs.second[lane] = partner.grain();
    pairs.image[lane] = partner.image();
    pairs.pair[lane] = lane < lanes ? acting.pair[at] : memory_.pairs;
    const Row8 there = Row8::load(&particles_.state[pairs.second[lane]].position.x) +
                       Row8::load(&setting_.shifts[pairs.image[lane]].position.x);
    rows[lane] = add_scaled(Row8::load(&particles_.state[pairs.first[lane]].position.x),
                            detail::difference_sign(),
                            there);
    if constexpr (Law::rotates) {
      spins[lane] = load_row4(&particles_.spin[pairs.first[lane]].velocity.x) +
                    load_row4(&particles_.spin[pairs.second[lane]].velocity.x);
      springs[lane] = load_row4(&memory_.spring[pairs.pair[lane]].stretch.x);
    }
  }
  Pack column[8];
  columns_of(rows, column);
  pairs.branch = {column[0], column[1], column[2]};
  pairs.radius_sum = column[3];
  pairs.velocity = {column[4], column[5], column[6]};
  pairs.inverse_mass = column[7];
  if constexpr (Law::rotates) {
    Pack spin[4];
    columns_of(spins, spin);
    pairs.spin = {spin[0], spin[1], spin[2]};
    pairs.grip = spin[3];
    Pack spring[4];
    columns_of(springs, spring);
    pairs.spring = {{spring[0], spring[1], spring[2]}, spring[3]};
  }
  return pairs;
}

template <class Law>
[[gnu::always_inline]] inline ContactOf<Pack> ForceLoop<Law>::contact(const PackOfPairs& pairs,
                                                                      const PackMask& valid) const {
  const Pack distance2 = square(pairs.branch);
  const Pack inverse_distance = inverse_sqrt(distance2);
  ContactOf<Pack> contact;
  contact.normal = inverse_distance * pairs.branch;
  contact.distance = distance2 * inverse_distance;
  contact.overlap = select(valid, pairs.radius_sum - contact.distance, Pack(-1.0));
  contact.normal_velocity = dot(pairs.velocity, contact.normal);
  contact.reduced_mass = reciprocal(pairs.inverse_mass);
  contact.inverse_distance = inverse_distance;
  contact.radius_sum = pairs.radius_sum;
  if constexpr (Law::bridges) {
    contact.harmonic_radius = Pack([&](auto lane) {
      return harmonic_radius(particles_.state[pairs.first[lane]].radius,
                             particles_.state[pairs.second[lane]].radius);
    });
  }
  return contact;
}

/// A bridge forms at the first touch; pairs that leave the range are released elsewhere.
template <class Law>
PackMask ForceLoop<Law>::update_bridges(const PackOfPairs& pairs,
                                        const PackMask& touches,
                                        std::size_t lanes) const {
  std::uint32_t bridged = bits(touches);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    std::uint8_t& bridge = memory_.bridge[pairs.pair[lane]];
    bridged |= std::uint32_t{bridge} << lane;
    bridge = bridged >> lane & 1u;
  }
  return mask_of(bridged);
}

template <class Law>
[[gnu::always_inline]] inline Pack ForceLoop<Law>::overlap_to_watch(
    const PackOfPairs& pairs, const ContactOf<Pack>& contact) const {
  if (setting_.equal_sizes) return contact.overlap;
  const Pack first([&](auto lane) { return particles_.state[pairs.first[lane]].radius; });
  const Pack second = contact.radius_sum - first;
  const Pack smaller = select(second > 0.5 * setting_.smallest_radius, min(first, second), first);
  return contact.overlap * reciprocal(smaller);
}

template <class Law>
[[gnu::always_inline]] inline void ForceLoop<Law>::compute(PackOfPairs& pairs,
                                                           std::size_t lanes,
                                                           PackSums& sums) const {
  const PackMask valid = detail::first_lanes(lanes);
  const ContactOf<Pack> contact = this->contact(pairs, valid);
  TangentialMotion<Pack> motion;
  // The contact point divides the distance of the centres as the radii: arms R r / (R_i + R_j) in
  // the surface velocity and in the torque alike keep angular momentum and energy at any overlap.
  Pack arm = 0.0;  // [radius]
  if constexpr (Law::rotates) {
    arm = contact.distance * reciprocal(contact.radius_sum);
    const Vector3<Pack> sliding = pairs.velocity - contact.normal_velocity * contact.normal;
    motion = {.surface_velocity = sliding - arm * cross(pairs.spin, contact.normal),
              .normal_rate = contact.inverse_distance * sliding};
  }
  PackMask bridged(false);
  if constexpr (Law::bridges) bridged = update_bridges(pairs, contact.overlap >= 0.0, lanes);

  ContactForce<Pack> force =
      contact_force(law_, contact, motion, pairs.grip, bridged, setting_.time_step, pairs.spring);
  if constexpr (Law::attracts) force.normal = select(valid, force.normal, Pack(0.0));
  pairs.force = force.normal * contact.normal + force.tangential;
  sums.normal_dashpot += force.normal_dashpot;
  pairs.dissipated = force.normal_dashpot;
  if (setting_.moving_images) sums.virial_yy += pairs.force.y * pairs.branch.y;
  sums.largest_overlap = max(sums.largest_overlap, overlap_to_watch(pairs, contact));
  if constexpr (Law::rotates) {
    pairs.torque = -arm * cross(contact.normal, force.tangential);
    sums.tangential_dashpot += force.friction.dashpot;
    sums.slip += force.friction.slip;
    pairs.dissipated += force.friction.dashpot + force.friction.slip;
    pairs.slip = force.friction.slip;
    sums.tangential_energy += force.friction.elastic_energy;
    if constexpr (Law::attracts) sums.spring_lost += force.spring_lost;
    if constexpr (!decltype(law_.normal)::constant_prefactor) {
      sums.prefactor_work += force.prefactor_work;
    }
  }
}

template <class Law>
template <class Record>
[[gnu::always_inline]] inline void ForceLoop<Law>::scatter(Strip& strip,
                                                           std::size_t k,
                                                           std::size_t lanes,
                                                           const PackOfPairs& pairs,
                                                           Record&& record) const {
  Row8 rows[pack_width];
  Row4 springs[pack_width];
  rows_of({pairs.force.x,
           pairs.force.y,
           pairs.force.z,
           0.0,
           pairs.torque.x,
           pairs.torque.y,
           pairs.torque.z,
           0.0},
          rows);
  if constexpr (Law::rotates) {
    const TangentialSpring<Pack>& spring = pairs.spring;
    rows_of({spring.stretch.x, spring.stretch.y, spring.stretch.z, spring.slipping}, springs);
  }
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    double* on_first = &particles_.load[pairs.first[lane]].force.x;
    double* on_second = &particles_.load[strip.acting.load[k + lane]].force.x;
    (Row8::load(on_first) + rows[lane]).store(on_first);
    add_scaled(Row8::load(on_second), detail::reaction_sign(), rows[lane]).store(on_second);
    if constexpr (Law::rotates) {
      store(springs[lane], &memory_.spring[pairs.pair[lane]].stretch.x);
    }
    if (setting_.moving_images && pairs.image[lane] != own_image) {
      Row8& across = strip.image_load[pairs.image[lane]];
      across = across + rows[lane];
    }
    if constexpr (!std::is_same_v<std::decay_t<Record>, NoRecord>) {
      const auto element = [&](const Vector3<Pack>& v) {
        return Vec3{v.x[lane], v.y[lane], v.z[lane]};
      };
      record(pairs.first[lane],
             pairs.second[lane],
             element(pairs.branch),
             element(pairs.force),
             ContactLoss{pairs.dissipated[lane], pairs.slip[lane]});
    }
  }
}

template <class Law>
void ForceLoop<Law>::add_lanes(const PackSums& from, ContactSums& to) const {
  to.normal_dashpot += sum(from.normal_dashpot);
  to.tangential_dashpot += sum(from.tangential_dashpot);
  to.slip += sum(from.slip);
  to.tangential_energy += sum(from.tangential_energy);
  to.spring_lost += sum(from.spring_lost);
  to.prefactor_work += sum(from.prefactor_work);
  to.virial_yy += sum(from.virial_yy);
  const double unit = setting_.equal_sizes ? setting_.smallest_radius : 1.0;
  to.largest_overlap = std::max(to.largest_overlap, largest(from.largest_overlap) / unit);
}

/// One strip, one step: finds the acting pairs and adds their forces, a few hundred pairs at a time
/// so that the second look finds the grains of the first in the cache.
template <class Law, class Record>
void add_contact_forces(const Law& law,
                        const ContactSetting& setting,
                        Particles& particles,
                        PairMemory& memory,
                        Strip& strip,
                        Record&& record) {
  constexpr std::size_t tile = 256;
  strip.sums = {};
  if (setting.moving_images) strip.image_load.fill({});
  strip.acting.count = 0;
  strip.acting.reserve(strip.near.count);
  ForceLoop<Law> loop(law, setting, particles, memory);
  std::size_t done = 0;
  for (std::size_t k = 0; k < strip.near.count; k += tile) {
    const std::size_t end = std::min(k + tile, strip.near.count);
    find_acting(law, setting, particles, memory, strip, k, end);
    const std::size_t whole = strip.acting.count / pack_width * pack_width;
    const std::size_t ready = end == strip.near.count ? strip.acting.count : whole;
    loop.add(strip, done, ready, record);
    done = ready;
  }
  loop.finish(strip);
}

}  // namespace grainlaw::dem
