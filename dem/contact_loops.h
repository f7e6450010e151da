#pragma once

#include <functional>

#include "dem/contact_forces.h"

namespace grainlaw::dem {

/// Is told of each acting pair: first, partner, branch, force on the first, what it dissipates.
using PairRecord =
    std::function<void(std::uint32_t, std::uint32_t, const Vec3&, const Vec3&, const ContactLoss&)>;

/// The work of every step on the pairs of one strip, compiled once for each law a scene can choose
/// (contact_loops_*.cpp) instead of in every file that simulates.
template <class Law>
struct ContactLoops {
  /// See search_near().
  static void search(double range,
                     double skin,
                     const ContactSetting& setting,
                     const Particles& particles,
                     const NeighbourList& list,
                     const std::vector<std::uint32_t>& load,
                     const PairMemory& memory,
                     Strip& strip);
  /// See add_contact_forces(); without a record nobody looks at the pairs.
  static void add_forces(const Law& law,
                         const ContactSetting& setting,
                         Particles& particles,
                         PairMemory& memory,
                         Strip& strip);
  static void add_forces(const Law& law,
                         const ContactSetting& setting,
                         Particles& particles,
                         PairMemory& memory,
                         Strip& strip,
                         const PairRecord& record);
};

template <class Law>
void ContactLoops<Law>::search(double range,
                               double skin,
                               const ContactSetting& setting,
                               const Particles& particles,
                               const NeighbourList& list,
                               const std::vector<std::uint32_t>& load,
                               const PairMemory& memory,
                               Strip& strip) {
  search_near<Law>(range, skin, setting, particles, list, load, memory, strip);
}

template <class Law>
void ContactLoops<Law>::add_forces(const Law& law,
                                   const ContactSetting& setting,
                                   Particles& particles,
                                   PairMemory& memory,
                                   Strip& strip) {
  add_contact_forces(law, setting, particles, memory, strip, NoRecord{});
}

template <class Law>
void ContactLoops<Law>::add_forces(const Law& law,
                                   const ContactSetting& setting,
                                   Particles& particles,
                                   PairMemory& memory,
                                   Strip& strip,
                                   const PairRecord& record) {
  add_contact_forces(law, setting, particles, memory, strip, record);
}

extern template struct ContactLoops<ContactLaw<Hooke, Cohesionless, Frictionless>>;
extern template struct ContactLoops<ContactLaw<Hooke, Cohesionless, Sliding>>;
extern template struct ContactLoops<ContactLaw<Hooke, Cohesionless, StickSlip>>;
extern template struct ContactLoops<ContactLaw<Hertz, Cohesionless, Frictionless>>;
extern template struct ContactLoops<ContactLaw<Hertz, Cohesionless, Sliding>>;
extern template struct ContactLoops<ContactLaw<Hertz, Cohesionless, StickSlip>>;
extern template struct ContactLoops<ContactLaw<Hooke, GaussianWell, Frictionless>>;
extern template struct ContactLoops<ContactLaw<Hooke, GaussianWell, Sliding>>;
extern template struct ContactLoops<ContactLaw<Hooke, GaussianWell, StickSlip>>;
extern template struct ContactLoops<ContactLaw<Hertz, GaussianWell, Frictionless>>;
extern template struct ContactLoops<ContactLaw<Hertz, GaussianWell, Sliding>>;
extern template struct ContactLoops<ContactLaw<Hertz, GaussianWell, StickSlip>>;
extern template struct ContactLoops<ContactLaw<Hooke, ReversibleAdhesion, Frictionless>>;
extern template struct ContactLoops<ContactLaw<Hooke, ReversibleAdhesion, Sliding>>;
extern template struct ContactLoops<ContactLaw<Hooke, ReversibleAdhesion, StickSlip>>;
extern template struct ContactLoops<ContactLaw<Hertz, ReversibleAdhesion, Frictionless>>;
extern template struct ContactLoops<ContactLaw<Hertz, ReversibleAdhesion, Sliding>>;
extern template struct ContactLoops<ContactLaw<Hertz, ReversibleAdhesion, StickSlip>>;
extern template struct ContactLoops<ContactLaw<Hooke, LiquidBridge, Frictionless>>;
extern template struct ContactLoops<ContactLaw<Hooke, LiquidBridge, Sliding>>;
extern template struct ContactLoops<ContactLaw<Hooke, LiquidBridge, StickSlip>>;
extern template struct ContactLoops<ContactLaw<Hertz, LiquidBridge, Frictionless>>;
extern template struct ContactLoops<ContactLaw<Hertz, LiquidBridge, Sliding>>;
extern template struct ContactLoops<ContactLaw<Hertz, LiquidBridge, StickSlip>>;

}  // namespace grainlaw::dem
