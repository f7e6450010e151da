#pragma once

#include <vector>

#include "calibration/fittable_law.h"
#include "continuum/rheology.h"

namespace grainlaw::calibration {

/// How the parts of mu(I, p*, Bo) may look.
enum class InertialForm { saturating, power };  ///< mu0 + beta I/(1 + kappa I), mu0 + A I^alpha
/// mu(I) f_p (1 + alpha Bo^beta), tau = c0 + mu p, or mu(I) f_p + factor Bo^b p*^g.
enum class CohesionForm { factor, additive_stress, additive_power };
struct FrictionForm {
  InertialForm inertial = InertialForm::saturating;
  continuum::SoftnessForm softness = continuum::SoftnessForm::square_root;
  CohesionForm cohesion = CohesionForm::factor;
};

/// Slots of the friction law.
namespace friction_slot {
inline constexpr std::size_t mu0 = 0, beta = 1, kappa = 2, exponent = 3, softness = 4, cohesion = 5,
                             cohesion_exponent = 6, cohesion_softness = 7;
}
/// Slots of the volume fraction law; p1 to p4 follow each other.
namespace fraction_slot {
inline constexpr std::size_t phi0 = 0, inertia = 1, softness = 2, p1 = 3, p4 = 6;
}

/// mu(I, p*, Bo) = mu(I) f_p f_B of one family (Shi et al. 2020, eq. 1A and table 6, and its
/// relatives).
FittableLaw friction_law(const FrictionForm& form);

/// The family a law belongs to. Terms it does not have say nothing of it.
FrictionForm form_of(const continuum::MuPhi& law);

/// The terms the friction of a law has, and no other.
std::string words(const continuum::MuPhi& law);

/// Every family of the friction law: 2 x 2 x 3.
std::vector<FrictionForm> friction_forms();

/// phi(I, p*, Bo) = phi0 g_I g_p g_c (Shi et al. 2020, eq. 16).
FittableLaw volume_fraction_law();

/// The parts of a law that the active slots make up. A part without active slots is absent.
void set_friction(continuum::MuPhi& law,
                  const FrictionForm& form,
                  const Slots<double>& x,
                  const std::vector<std::size_t>& active);
void set_volume_fraction(continuum::MuPhi& law,
                         const Slots<double>& x,
                         const std::vector<std::size_t>& active);

}  // namespace grainlaw::calibration
