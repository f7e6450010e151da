#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "dem/contact_law.h"
#include "dem/neighbour_list.h"
#include "dem/particles.h"

namespace grainlaw::dem {

/// What every contact of a run has in common.
struct ContactSetting {
  double diameter = 1.0;   ///< of all grains [length]
  double mass = 1.0;       ///< of a grain [mass]
  double time_step = 0.0;  ///< [time]
  std::array<Vec3, 27> shifts;
};

/// Sums over the contacts of one step.
struct ContactSums {
  double elastic_energy = 0.0;   ///< in the normal springs now [energy]
  double normal_dashpot = 0.0;   ///< dissipated in this step [energy]
  TangentialWork tangential;     ///< of this step
  double spring_lost = 0.0;      ///< by contacts that opened in this step [energy]
  double largest_overlap = 0.0;  ///< [length]
};

/// The pairs of the list that touch, and what they remember. History and touching flags are kept
/// per listed pair, only where the law has a history.
template <class Law>
struct ContactTable {
  struct Touching {
    std::uint32_t grain;
    std::uint32_t pair;
  };
  std::vector<Touching> touching;  ///< the first `count` are valid
  std::size_t count = 0;
  std::vector<typename Law::History> history;
  std::vector<std::uint8_t> remembers;

  void resize(std::size_t pairs) {
    touching.resize(pairs);
    if constexpr (Law::keeps_history) {
      history.assign(pairs, {});
      remembers.assign(pairs, 0);
    }
  }
};

/// Lists the touching pairs; a contact that opened forgets.
template <class Law>
void find_contacts(const Law& law,
                   const ContactSetting& setting,
                   const Particles& particles,
                   const NeighbourList& list,
                   ContactTable<Law>& table,
                   ContactSums& sums) {
  const double diameter2 = setting.diameter * setting.diameter;
  const Partner* partners = list.partners().data();
  const GrainState* state = particles.state.data();
  auto* next = table.touching.data();
  std::uint32_t pair = 0;
  for (std::uint32_t i = 0; i < particles.mobile; ++i) {
    const Vec3 position = state[i].position;
    for (const std::uint32_t end = list.row_begin(i + 1); pair < end; ++pair) {
      const Partner partner = partners[pair];
      const Vec3 branch =
          position - (state[partner.grain()].position + setting.shifts[partner.image()]);
      const bool touches = square(branch) < diameter2;
      *next = {i, pair};
      next += touches;
      if constexpr (Law::keeps_history) {
        if (table.remembers[pair] > touches) {
          sums.spring_lost += law.friction.energy_lost(table.history[pair].friction);
          table.history[pair] = {};
        }
        table.remembers[pair] = touches;
      }
    }
  }
  table.count = static_cast<std::size_t>(next - table.touching.data());
}

/// Adds the force of one touching pair to both grains. record(i, j, branch, force_on_i) sees it.
template <class Law, class Record>
void add_contact(const Law& law,
                 const ContactSetting& setting,
                 Particles& particles,
                 std::uint32_t i,
                 Partner partner,
                 [[maybe_unused]] typename Law::History* history,
                 ContactSums& sums,
                 Record&& record) {
  const std::uint32_t j = partner.grain();
  const GrainState& a = particles.state[i];
  const GrainState& b = particles.state[j];
  const Vec3 branch = a.position - (b.position + setting.shifts[partner.image()]);
  const Vec3 velocity = a.velocity - b.velocity;
  const double distance = length(branch);
  const double inverse_distance = 1.0 / distance;
  Contact contact;
  contact.normal = inverse_distance * branch;
  contact.distance = distance;
  contact.overlap = setting.diameter - distance;
  contact.normal_velocity = dot(velocity, contact.normal);
  contact.reduced_mass = j < particles.mobile ? 0.5 * setting.mass : setting.mass;

  const double normal_force = law.normal.force(contact);
  Vec3 force = normal_force * contact.normal;
  sums.elastic_energy += law.normal.elastic_energy(contact);
  sums.normal_dashpot += law.normal.dissipated_power(contact) * setting.time_step;
  sums.largest_overlap = std::max(sums.largest_overlap, contact.overlap);

  if constexpr (Law::rotates) {
    // The contact point halves the distance of the centres: arm r/2 in the surface velocity and in
    // the torque alike, so that angular momentum and energy are kept at any overlap.
    const double arm = distance / setting.diameter;  // [radius]
    const Vec3 sliding = velocity - contact.normal_velocity * contact.normal;
    const Vec3 spin = particles.spin[i] + particles.spin[j];
    const TangentialMotion motion{.surface_velocity = sliding - arm * cross(spin, contact.normal),
                                  .normal_rate = inverse_distance * sliding};
    const Vec3 friction = law.friction.force(
        contact, motion, normal_force, setting.time_step, history->friction, sums.tangential);
    force += friction;
    const Vec3 torque = -arm * cross(contact.normal, friction);
    particles.load[i].torque += torque;
    particles.load[j].torque += torque;
  }
  particles.load[i].force += force;
  particles.load[j].force -= force;
  record(i, j, branch, force);
}

/// Adds the forces of all contacts to the loads.
template <class Law, class Record>
ContactSums add_contact_forces(const Law& law,
                               const ContactSetting& setting,
                               Particles& particles,
                               const NeighbourList& list,
                               ContactTable<Law>& table,
                               Record&& record) {
  ContactSums sums;
  find_contacts(law, setting, particles, list, table, sums);
  for (std::size_t k = 0; k < table.count; ++k) {
    const auto [grain, pair] = table.touching[k];
    typename Law::History* history = nullptr;
    if constexpr (Law::keeps_history) history = &table.history[pair];
    add_contact(law, setting, particles, grain, list.partners()[pair], history, sums, record);
  }
  return sums;
}

}  // namespace grainlaw::dem
