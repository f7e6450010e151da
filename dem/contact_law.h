#pragma once

#include <concepts>
#include <type_traits>

#include "dem/cohesion_laws.h"
#include "dem/contact.h"
#include "dem/friction_laws.h"
#include "dem/normal_laws.h"

namespace grainlaw::dem {

/// What a normal law must have.
template <class L>
concept NormalLaw = requires(const L law, const Contact& contact, double reduced_mass) {
  { law.force(contact) } -> std::same_as<double>;
  { law.elastic_energy(contact) } -> std::same_as<double>;
  { law.dissipated_power(contact) } -> std::same_as<double>;
  { law.contact_time(reduced_mass) } -> std::same_as<double>;
};

/// What a cohesion law must have; one that acts adds its force and range here.
template <class L>
concept CohesionLaw = requires {
  typename L::History;
};

/// What a friction law must have: a force only if it makes grains rotate.
template <class L>
concept FrictionLaw = requires {
  typename L::History;
}
&&(!L::rotates || requires(const L law,
                           const Contact& contact,
                           const TangentialMotion& motion,
                           typename L::History history,
                           TangentialWork work) {
  { law.force(contact, motion, 1.0, 1.0, history, work) } -> std::same_as<Vec3>;
  { law.energy_lost(history) } -> std::same_as<double>;
});

static_assert(NormalLaw<Hooke> && CohesionLaw<Cohesionless>);
static_assert(FrictionLaw<Frictionless> && FrictionLaw<Sliding>);

/// The law of one run, put together from three independent parts. What a part does not need takes
/// no space: the history of an empty law is empty.
template <NormalLaw N, CohesionLaw C, FrictionLaw F>
struct ContactLaw {
  N normal;
  [[no_unique_address]] C cohesion;
  [[no_unique_address]] F friction;

  struct History {
    [[no_unique_address]] typename C::History cohesion;
    [[no_unique_address]] typename F::History friction;
  };

  static constexpr bool rotates = F::rotates;
  static constexpr bool keeps_history = !std::is_empty_v<History>;
};
template <class N, class C, class F>
ContactLaw(N, C, F) -> ContactLaw<N, C, F>;

}  // namespace grainlaw::dem
