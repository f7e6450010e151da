#include "apps/report/law_formula.h"

namespace grainlaw::report {
namespace {

/// mu(I), as far as the table has its terms.
Html inertial_friction(const continuum::InertialFriction& law) {
  if (law.tabulated) return "tabulated"_html;
  const Html x = law.exponent ? "<i>I<sup>n</sup></i>"_html : "<i>I</i>"_html;
  Html words = "<i>μ</i><sub>0</sub> + <i>β</i>"_html + x;
  if (law.kappa > 0.0) words += "/(1 + <i>κ</i>"_html + x + ")"_html;
  return words;
}

}  // namespace

Html friction_formula(const continuum::MuPhi& law) {
  const auto& softness = law.softness_friction;
  const bool cohesive = law.cohesion_friction || law.cohesion_stress;
  Html words = "<i>μ</i>(<i>I</i>"_html;
  if (softness) words += ", <i>p</i>*"_html;
  if (cohesive) words += ", Bo"_html;
  const Html base = inertial_friction(law.friction);
  words += ") = "_html + (softness || cohesive ? "("_html + base + ")"_html : base);
  const Html x = cohesive ? "(1 + Bo) <i>p</i>*"_html : "<i>p</i>*"_html;
  if (softness && softness->form == continuum::SoftnessForm::square_root)
    words += " (1 − √("_html + x + "/<i>p<sub>μ</sub></i>*))"_html;
  else if (softness)
    words += " (1 − "_html + x + "/<i>p<sub>μ</sub></i>*)"_html;
  if (law.cohesion_friction) words += " (1 + <i>α</i> Bo<sup><i>β</i></sup>)"_html;
  if (!law.cohesion_stress) return words;
  words += law.cohesion_stress->bond_exponent ? " + <i>C</i> Bo<sup><i>b</i></sup>"_html
                                              : " + <i>C</i> Bo"_html;
  if (law.cohesion_stress->softness_exponent) words += " <i>p</i>*<sup><i>g</i></sup>"_html;
  return words;
}

Html fraction_formula(const continuum::MuPhi& law) {
  Html words = "<i>φ</i> = <i>φ</i><sub>0</sub> (1 − <i>I</i>/<i>I<sub>φ</sub></i>)"_html;
  const Html x = law.cohesion_volume_fraction ? "(1 + Bo) <i>p</i>*"_html : "<i>p</i>*"_html;
  if (law.softness_volume_fraction) words += " (1 + "_html + x + "/<i>p<sub>φ</sub></i>*)"_html;
  if (law.cohesion_volume_fraction) words += " <i>g<sub>c</sub></i>(Bo)"_html;
  return words;
}

}  // namespace grainlaw::report
