#include "calibration/material_laws.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainlaw::calibration {
namespace {

using continuum::SoftnessForm;

/// (1 + Bo) p*.
template <class T>
T effective_softness(const StateOf<T>& at) {
  return (1.0 + at.bond_number) * at.softness;
}

template <class T>
continuum::ConfinementOf<T> confinement(const StateOf<T>& at) {
  return {effective_softness(at), at.bond_number};
}

struct FrictionModel {
  FrictionForm form;

  template <class S, class T>
  continuum::Mixed<S, T> operator()(const Slots<S>& x, const StateOf<T>& at) const {
    namespace slot = friction_slot;
    using Number = continuum::Mixed<S, T>;
    continuum::laws::InertialFriction<S> inertial{x[slot::mu0], x[slot::beta], x[slot::kappa], {}};
    if (form.inertial == InertialForm::power) inertial.exponent = x[slot::exponent];
    const Number mu = continuum::friction(inertial, at.inertial_number) * softness(x, at);
    if (form.cohesion == CohesionForm::factor) {
      return mu * continuum::cohesion_friction(
                      x[slot::cohesion], x[slot::cohesion_exponent], at.bond_number);
    }
    continuum::laws::CohesionStress<S> cohesive{x[slot::cohesion], {}, {}};
    if (form.cohesion == CohesionForm::additive_power) {
      cohesive.bond_exponent = x[slot::cohesion_exponent];
      cohesive.softness_exponent = x[slot::cohesion_softness];
    }
    return mu + continuum::cohesion_friction(cohesive, confinement(at));
  }

  /// f_p of the slope s = 1/sqrt(p_mu), or 1/p_mu of the linear form: smooth through s = 0, rigid
  /// grains, where p_mu itself is infinite.
  template <class S, class T>
  continuum::Mixed<S, T> softness(const Slots<S>& x, const StateOf<T>& at) const {
    using std::sqrt;
    const T soft = effective_softness(at);
    if (!(soft > 0.0)) return continuum::Mixed<S, T>(1.0);
    const T depth = form.softness == SoftnessForm::linear ? soft : T(sqrt(soft));
    return 1.0 - x[friction_slot::softness] * depth;
  }
};

struct FractionModel {
  template <class S, class T>
  continuum::Mixed<S, T> operator()(const Slots<S>& x, const StateOf<T>& at) const {
    namespace slot = fraction_slot;
    const auto inertial = 1.0 - x[slot::inertia] * at.inertial_number;
    const auto soft = 1.0 + x[slot::softness] * effective_softness(at);
    return x[slot::phi0] * inertial * soft *
           continuum::cohesion_volume_fraction(
               x[slot::p1], x[slot::p1 + 1], x[slot::p1 + 2], x[slot::p4], at.bond_number);
  }
};

/// Hides the number types behind three functions.
template <class Model>
void attach(const Model& model, FittableLaw& law) {
  law.value = [model](const Slots<double>& x, const State& at) { return model(x, at); };
  law.by_slots = [model](const Slots<double>& x, const State& at, Slots<double>& slopes) {
    using Number = ceres::Jet<double, static_cast<int>(law_slots)>;
    Slots<Number> unknowns{};
    for (std::size_t j = 0; j < law_slots; ++j) unknowns[j] = Number(x[j], static_cast<int>(j));
    const Number y = model(unknowns, at);
    for (std::size_t j = 0; j < law_slots; ++j) slopes[j] = y.v[static_cast<int>(j)];
    return y.a;
  };
  law.by_state = [model](const Slots<double>& x, const State& at) {
    using Number = ceres::Jet<double, 3>;
    const Number y = model(
        x,
        StateOf<Number>{
            Number(at.inertial_number, 0), Number(at.softness, 1), Number(at.bond_number, 2)});
    return std::array<double, 3>{y.v[0], y.v[1], y.v[2]};
  };
}

/// Terms of the cohesion: its exponents go one at a time, all of it together.
void add_cohesion(const FrictionForm& form, FittableLaw& law) {
  namespace slot = friction_slot;
  const bool factor = form.cohesion == CohesionForm::factor;
  const bool power = form.cohesion == CohesionForm::additive_power;
  law.slots.insert(
      law.slots.end(),
      {{.name = factor ? "cohesion_alpha" : "cohesion_factor", .start = 0.3},
       {.name = power ? "cohesion_bond_exponent" : "cohesion_beta", .inactive = 1.0, .start = 1.3},
       {.name = "cohesion_softness_exponent", .start = 0.3}});
  law.possible.push_back(slot::cohesion);
  if (factor || power) {
    law.possible.push_back(slot::cohesion_exponent);
    law.terms.push_back({.name = "exponent of Bo", .slots = {slot::cohesion_exponent}});
  }
  if (power) {
    law.possible.push_back(slot::cohesion_softness);
    law.terms.push_back({.name = "exponent of p* (cohesion)", .slots = {slot::cohesion_softness}});
  }
  law.terms.push_back(
      {.name = factor ? "f_B (cohesion)" : "c0 (cohesion)",
       .slots = {slot::cohesion, slot::cohesion_exponent, slot::cohesion_softness}});
}

bool has(const std::vector<std::size_t>& active, std::size_t slot) {
  return std::find(active.begin(), active.end(), slot) != active.end();
}

std::string inertial_words(const continuum::InertialFriction& friction) {
  if (friction.exponent) return "mu0 + beta I^exponent";
  return friction.kappa > 0.0 ? "mu0 + beta I/(1 + kappa I)" : "mu0 + beta I";
}

std::string cohesion_words(const continuum::CohesionStress& stress) {
  if (!stress.bond_exponent && !stress.softness_exponent) return ", tau = c0 + mu p";
  return std::string(", + factor Bo") + (stress.bond_exponent ? "^b" : "") +
         (stress.softness_exponent ? " p*^g" : "");
}

/// The largest law of a family, at the values where its fit starts.
continuum::MuPhi with_all_terms(const FrictionForm& form, const FittableLaw& family) {
  Slots<double> x{};
  for (std::size_t j = 0; j < family.slots.size(); ++j) x[j] = family.slots[j].start;
  continuum::MuPhi law;
  set_friction(law, form, x, family.possible);
  return law;
}

}  // namespace

FittableLaw friction_law(const FrictionForm& form) {
  const bool power = form.inertial == InertialForm::power;
  FittableLaw law;
  law.slots = {
      {.name = "mu0", .start = 0.3},
      {.name = "beta", .start = 0.5},
      {.name = "kappa", .start = 1.0},
      {.name = "exponent", .inactive = 1.0, .start = 0.7},
      {.name = "p_mu", .start = 1.0, .power = form.softness == SoftnessForm::linear ? -1 : -2}};
  law.possible = {0, 1, power ? 3u : 2u, 4};
  if (power) {
    law.terms.push_back({.name = "exponent of I", .slots = {3}});
  } else {
    law.terms.push_back({.name = "kappa", .slots = {2}});
  }
  law.terms.push_back({.name = "f_p (softness)", .slots = {4}});
  add_cohesion(form, law);
  law.name = words(with_all_terms(form, law));
  attach(FrictionModel{form}, law);
  return law;
}

FrictionForm form_of(const continuum::MuPhi& law) {
  FrictionForm form;
  if (law.friction.exponent) form.inertial = InertialForm::power;
  if (law.softness_friction) form.softness = law.softness_friction->form;
  if (const auto& c = law.cohesion_stress) {
    const bool power = c->bond_exponent || c->softness_exponent;
    form.cohesion = power ? CohesionForm::additive_power : CohesionForm::additive_stress;
  }
  return form;
}

std::string words(const continuum::MuPhi& law) {
  std::string text = inertial_words(law.friction);
  if (const auto& soft = law.softness_friction) {
    text += soft->form == SoftnessForm::linear ? ", f_p linear" : ", f_p square root";
  }
  if (const auto& cohesion = law.cohesion_friction) {
    text += cohesion->beta == 1.0 ? ", f_B = 1 + alpha Bo" : ", f_B = 1 + alpha Bo^beta";
  }
  return law.cohesion_stress ? text + cohesion_words(*law.cohesion_stress) : text;
}

std::vector<FrictionForm> friction_forms() {
  std::vector<FrictionForm> forms;
  for (const InertialForm inertial : {InertialForm::saturating, InertialForm::power}) {
    for (const SoftnessForm softness : {SoftnessForm::square_root, SoftnessForm::linear}) {
      for (const CohesionForm cohesion :
           {CohesionForm::factor, CohesionForm::additive_stress, CohesionForm::additive_power}) {
        forms.push_back({inertial, softness, cohesion});
      }
    }
  }
  return forms;
}

FittableLaw volume_fraction_law() {
  constexpr double free = -std::numeric_limits<double>::infinity();
  FittableLaw law;
  law.name = "phi0 (1 - I/I_phi)(1 + (1 + Bo) p*/p_phi)(1 + p1 Bo + p2 Bo^2 + p3 Bo^3 + p4 Bo^4)";
  law.slots = {{.name = "phi0", .start = 0.6},
               {.name = "I_phi", .start = 0.3, .power = -1},
               {.name = "p_phi", .start = 3.0, .power = -1},
               {.name = "p1", .lower = free},
               {.name = "p2", .lower = free},
               {.name = "p3", .lower = free},
               {.name = "p4", .lower = free}};
  law.possible = {0, 1, 2, 3, 4, 5, 6};
  law.terms = {{.name = "g_I (inertia)", .slots = {1}},
               {.name = "g_p (softness)", .slots = {2}},
               {.name = "p4 of g_c", .slots = {6}},
               {.name = "p3 of g_c", .slots = {5}, .after = 6},
               {.name = "p2 of g_c", .slots = {4}, .after = 5},
               {.name = "p1 of g_c", .slots = {3}, .after = 4}};
  attach(FractionModel{}, law);
  return law;
}

void set_friction(continuum::MuPhi& law,
                  const FrictionForm& form,
                  const Slots<double>& x,
                  const std::vector<std::size_t>& active) {
  namespace slot = friction_slot;
  law.friction = {.mu0 = x[slot::mu0], .beta = x[slot::beta], .kappa = x[slot::kappa]};
  if (has(active, slot::exponent)) law.friction.exponent = x[slot::exponent];
  if (has(active, slot::softness) && x[slot::softness] > 0.0) {
    const double slope = x[slot::softness];
    const double p_mu = form.softness == SoftnessForm::linear ? 1.0 / slope : 1.0 / (slope * slope);
    law.softness_friction = continuum::SoftnessFriction{.p_mu = p_mu, .form = form.softness};
  }
  if (!has(active, slot::cohesion)) return;
  if (form.cohesion == CohesionForm::factor) {
    law.cohesion_friction =
        continuum::CohesionFriction{.alpha = x[slot::cohesion], .beta = x[slot::cohesion_exponent]};
    return;
  }
  auto& cohesive = law.cohesion_stress.emplace();
  cohesive.factor = x[slot::cohesion];
  const auto exponent = [&](std::size_t at) {
    return has(active, at) ? std::optional(x[at]) : std::nullopt;
  };
  cohesive.bond_exponent = exponent(slot::cohesion_exponent);
  cohesive.softness_exponent = exponent(slot::cohesion_softness);
}

void set_volume_fraction(continuum::MuPhi& law,
                         const Slots<double>& x,
                         const std::vector<std::size_t>& active) {
  namespace slot = fraction_slot;
  law.volume_fraction = {.phi0 = x[slot::phi0], .I_phi = 1.0 / x[slot::inertia]};
  if (!(x[slot::inertia] > 0.0)) {
    law.volume_fraction.I_phi = std::numeric_limits<double>::infinity();
  }
  if (has(active, slot::softness) && x[slot::softness] > 0.0) {
    law.softness_volume_fraction =
        continuum::SoftnessVolumeFraction{.p_phi = 1.0 / x[slot::softness]};
  }
  if (!has(active, slot::p1)) return;
  law.cohesion_volume_fraction = continuum::CohesionVolumeFraction{
      .p1 = x[slot::p1], .p2 = x[slot::p1 + 1], .p3 = x[slot::p1 + 2], .p4 = x[slot::p4]};
}

}  // namespace grainlaw::calibration
