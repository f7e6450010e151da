#pragma once

#include <concepts>

#include "dem/cohesion_laws.h"
#include "dem/contact.h"
#include "dem/friction_laws.h"
#include "dem/normal_laws.h"

namespace grainlaw::dem {

/// What a normal law must have, for one contact and for a pack of them.
template <class L>
concept NormalLaw = requires(const L law, const Contact& contact, const ContactOf<Pack>& pack) {
  { law.force(contact) } -> std::same_as<double>;
  { law.force(pack) } -> std::same_as<Pack>;
  { law.elastic_force(pack) } -> std::same_as<Pack>;
  { law.prefactor(pack) } -> std::same_as<Pack>;
  { law.elastic_energy(contact) } -> std::same_as<double>;
};

/// What a cohesion law must have: a force and its range only if it attracts.
template <class L>
concept CohesionLaw =
    !L::attracts || requires(const L law, const Contact& contact, const ContactOf<Pack>& pack) {
  { law.force(contact, true) } -> std::same_as<double>;
  { law.force(pack, PackMask(true)) } -> std::same_as<Pack>;
  { law.energy(contact, true) } -> std::same_as<double>;
  { law.range() } -> std::same_as<double>;
  { law.largest_attraction(1.0) } -> std::same_as<double>;
  { law.steepest_slope(1.0) } -> std::same_as<double>;
  { law.reference } -> std::convertible_to<CoulombReference>;
};

/// What a friction law must have: a limit only if it makes grains rotate.
template <class L>
concept FrictionLaw = !L::rotates || requires(const L law,
                                              const NormalLoad<Pack>& load,
                                              const TangentialSpring<Pack>& spring,
                                              const Pack& trial2) {
  { law.limit(load, spring, trial2) } -> std::same_as<Pack>;
  { law.stiffness } -> std::convertible_to<double>;
  { law.damping } -> std::convertible_to<double>;
};

static_assert(NormalLaw<Hooke> && NormalLaw<Hertz>);
static_assert(CohesionLaw<Cohesionless> && CohesionLaw<GaussianWell> &&
              CohesionLaw<ReversibleAdhesion> && CohesionLaw<LiquidBridge>);
static_assert(FrictionLaw<Frictionless> && FrictionLaw<Sliding> && FrictionLaw<StickSlip>);

/// The law of one run, put together from three independent parts. What a part does not need is
/// neither stored nor computed.
template <NormalLaw N, CohesionLaw C, FrictionLaw F>
struct ContactLaw {
  N normal;
  [[no_unique_address]] C cohesion;
  [[no_unique_address]] F friction;

  static constexpr bool rotates = F::rotates;    ///< grains spin, contacts keep a spring
  static constexpr bool attracts = C::attracts;  ///< pairs act beyond contact
  static constexpr bool bridges = C::bridges;    ///< pairs remember a liquid bridge
  static constexpr bool keeps_history = rotates || bridges;

  double range() const {  ///< gap up to which a pair acts [length]
    if constexpr (attracts)
      return cohesion.range();
    else
      return 0.0;
  }
};
template <class N, class C, class F>
ContactLaw(N, C, F) -> ContactLaw<N, C, F>;

/// Force of one contact, or of a pack of them, on the first grain.
template <class S>
struct ContactForce {
  S normal = S(0.0);           ///< cohesion included [force]
  Vector3<S> tangential;       ///< [force]
  S normal_dashpot = S(0.0);   ///< dissipated in this step [energy]
  S prefactor_work = S(0.0);   ///< taken from tangential springs by a falling prefactor [energy]
  S spring_lost = S(0.0);      ///< with springs of grains that no longer touch [energy]
  TangentialWork<S> friction;  ///< of this step
};

/// Between grains that do not touch there is no friction and no spring.
template <class S>
[[gnu::always_inline]] inline void release_unless(const Mask<S>& touches,
                                                  TangentialSpring<S>& spring,
                                                  ContactForce<S>& force) {
  const auto keep = [&](S& value) { value = select(touches, value, S(0.0)); };
  keep(spring.stretch.x), keep(spring.stretch.y), keep(spring.stretch.z), keep(spring.slipping);
  keep(force.friction.dashpot), keep(force.friction.slip), keep(force.friction.elastic_energy);
  keep(force.prefactor_work);
}

/// The overlap that a linear spring is to push with. While a contact begins or ends, it lasts for a
/// part of a step only: less than a step's way from the point of touch, half of the force is left
/// out in proportion. Then the trapezoidal work of the spring over its first two steps, and over
/// its last two, is exactly the energy in it: k w^2 (1 + x)^2 / 2 for overlaps w x and w (1 + x)
/// one step apart. With the full force every collision loses k (v_n dt)^2 / 12 at its begin and
/// gains as much at its end, (pi dt / t_c)^2 / 6 of what it dissipates; see decision 0016.
template <class S>
[[gnu::always_inline]] inline S centred_overlap(const ContactOf<S>& contact, double time_step) {
  const S way = time_step * abs(contact.normal_velocity);
  const S in_part = 0.5 * contact.overlap * (1.0 + contact.overlap * reciprocal(way));
  return select(contact.overlap < way, in_part, contact.overlap);
}

/// The whole law of a contact: normal force and cohesion, then friction bounded by them. Between
/// grains that do not touch only cohesion acts, and the spring is let go. `grip` multiplies the
/// coefficient of friction: 1, or 0 at a smooth wall.
template <class Law, class S>
[[gnu::always_inline]] inline ContactForce<S> contact_force(const Law& law,
                                                            const ContactOf<S>& contact,
                                                            const TangentialMotion<S>& motion,
                                                            const S& grip,
                                                            const Mask<S>& bridged,
                                                            double time_step,
                                                            TangentialSpring<S>& spring) {
  ContactForce<S> result;
  const Mask<S> touches = contact.overlap > S(0.0);
  ContactOf<S> centred = contact;
  if constexpr (decltype(law.normal)::constant_prefactor) {
    centred.overlap = centred_overlap(contact, time_step);
  }
  const S repulsion = select(touches, law.normal.force(centred), S(0.0));
  const S elastic = select(touches, law.normal.elastic_force(centred), S(0.0));
  result.normal = repulsion;
  result.normal_dashpot = (elastic - repulsion) * contact.normal_velocity * time_step;
  NormalLoad<S> load{.coulomb_reference = abs(repulsion)};
  if constexpr (Law::attracts) {
    const S pull = law.cohesion.force(contact, bridged);
    result.normal += pull;
    load.coulomb_reference = coulomb_reference(law.cohesion.reference, repulsion, pull);
  }
  if constexpr (Law::rotates) {
    if constexpr (Law::attracts && decltype(law.normal)::constant_prefactor) {
      const S left = 0.5 * law.friction.stiffness * square(spring.stretch);
      result.spring_lost = select(touches, S(0.0), left);
    }
    if constexpr (!decltype(law.normal)::constant_prefactor) {
      load.prefactor = law.normal.prefactor(contact);
      load.inverse_prefactor = reciprocal(load.prefactor);
    }
    load.coulomb_reference *= grip;
    [[maybe_unused]] const S before = square(spring.stretch);
    const Vector3<S> force =
        friction_force(law.friction, contact, motion, load, time_step, spring, result.friction);
    result.tangential = {select(touches, force.x, S(0.0)),
                         select(touches, force.y, S(0.0)),
                         select(touches, force.z, S(0.0))};
    if constexpr (!decltype(law.normal)::constant_prefactor) {
      // d/dt sqrt(overlap) = -v_n / (2 overlap) sqrt(overlap). The spring at n is the mean of those
      // half a step before and after: what it is cut to at n would cost one order in the step.
      const S mean_square = 0.5 * (before + square(spring.stretch));
      const S energy = 0.5 * law.friction.stiffness * load.prefactor * mean_square;
      result.prefactor_work = 0.5 * time_step * energy * contact.normal_velocity / contact.overlap;
    }
    release_unless(touches, spring, result);
  }
  return result;
}

}  // namespace grainlaw::dem
