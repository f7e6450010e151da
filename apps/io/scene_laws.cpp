#include "apps/io/scene_laws.h"

namespace grainlaw::io {
namespace {

Key damping_rate(std::string_view meaning, const Units& units) {
  return {"damping_rate", meaning, units[dimension::rate], not_negative};
}
Key dashpot(std::string_view meaning, const Units& units) {
  return {"dashpot", meaning, units[dimension::dashpot], not_negative};
}

/// How a contact dissipates.
struct Damping {
  double rate = 0.0;     ///< times the reduced mass
  double dashpot = 0.0;  ///< for all pairs
  double root = 0.0;     ///< times the root of the reduced mass
};

/// Exactly one of three ways to say it; a Hertz contact has two of them.
Damping read_damping(Section& section, const Units& units, double stiffness, bool hertz) {
  const auto rate = section.find<double>(
      damping_rate("gamma_n, times the reduced mass (Brewster et al. 2008)", units));
  const auto viscosity = section.find<double>(
      dashpot("gamma_n, times the velocity, the same for all pairs (Shi et al. 2020)", units));
  const auto restitution =
      section.find<double>({"restitution",
                            "normal restitution, the same for all pairs; refused for \"hertz\"",
                            {},
                            {0.0, 1.0, false, true}});
  if (restitution && hertz) {
    section.problem("restitution",
                    "'restitution' has no meaning with law = \"hertz\", where it depends on the "
                    "speed: give damping_rate or dashpot");
  }
  section.exactly_one_of({"damping_rate", "dashpot", "restitution"});
  const double root = restitution ? dem::root_damping_for(*restitution, stiffness) : 0.0;
  return {rate.value_or(0.0), viscosity.value_or(0.0), root};
}

/// Returns k_n.
double read_normal(InputFile& in, const Units& units, dem::Scene& scene) {
  Section section = in.section("contact.normal", "Normal force between two grains");
  const bool hertz =
      section.choice({"law",
                      "spring and dashpot: \"hooke\" linear in overlap and velocity, \"hertz\" "
                      "both times sqrt(overlap/(R_i + R_j)) (Brewster et al. 2008, eq. 2)"},
                     {"hooke", "hertz"}) == "hertz";
  const double stiffness = read_stiffness(section, units);
  const Damping damping = read_damping(section, units, stiffness, hertz);
  const bool clip = section.read_or<bool>(
      {"clip_attraction", "no negative force between touching grains at the end of a contact"},
      false);
  if (hertz) {
    scene.normal = dem::Hertz{stiffness, damping.rate, clip, damping.dashpot};
  } else {
    scene.normal = dem::Hooke{stiffness, damping.rate, clip, damping.dashpot, damping.root};
  }
  return stiffness;
}

dem::CoulombReference read_reference(Section& section, dem::CoulombReference otherwise) {
  const std::string word = section.choice(
      {"coulomb_reference",
       "friction is bounded by mu_p times the total normal force (Brewster et al. 2008), or the "
       "contact force without cohesion (Shi et al. 2020)"},
      {"total", "repulsive"},
      otherwise == dem::CoulombReference::total ? "total" : "repulsive");
  return word == "total" ? dem::CoulombReference::total : dem::CoulombReference::repulsive;
}

dem::GaussianWell read_gaussian_well(Section section, const Units& units) {
  dem::GaussianWell law;
  law.strength = section.read<double>(
      {"strength", "A, depth of the well", units[dimension::energy], positive});
  law.width = section.read_or<double>(
      {"width", "l; the well reaches 2 l beyond contact", units[dimension::length], positive},
      0.01,
      "d");
  law.reference = read_reference(section, law.reference);
  return law;
}

dem::ReversibleAdhesion read_reversible(Section section, const Units& units, double stiffness) {
  dem::ReversibleAdhesion law;
  law.largest_force = section.read<double>(
      {"largest_force", "f_a,max, in contact", units[dimension::force], positive});
  const Key slope{
      "slope", "k_ca, by which it falls with the gap", units[dimension::stiffness], positive};
  law.slope = section.find<double>(slope, "the normal stiffness").value_or(stiffness);
  law.reference = read_reference(section, law.reference);
  return law;
}

dem::LiquidBridge read_liquid_bridge(Section section, const Units& units) {
  dem::LiquidBridge law;
  law.surface_tension = section.read<double>(
      {"surface_tension", "gamma_s, force/length", units[dimension::tension], positive});
  law.contact_angle = radians(section.read_or<double>(
      {"contact_angle", "theta", {"degrees"}, {0.0, dem::limits::contact_angle, true, false}},
      0.0));
  law.volume =
      section.read<double>({"volume",
                            "V of one bridge, which ruptures at the gap (1 + theta/2) V^(1/3)",
                            units[dimension::volume],
                            positive});
  law.reference = read_reference(section, law.reference);
  return law;
}

void read_cohesion(InputFile& in, const Units& units, double stiffness, dem::Scene& scene) {
  Section section = in.optional_section(
      "contact.cohesion", "Attraction; without this section pairs act in contact only");
  if (!section.given()) return;
  const std::string law = section.choice({"law", "see below"},
                                         {"gaussian_well", "reversible_adhesion", "liquid_bridge"});
  if (section.applies(law == "gaussian_well")) {
    scene.cohesion = read_gaussian_well(
        section.when(
            "law", "gaussian_well", "A narrow well at contact (Brewster et al. 2008, eq. 5)"),
        units);
  }
  if (section.applies(law == "reversible_adhesion")) {
    scene.cohesion = read_reversible(
        section.when("law", "reversible_adhesion", "Dry adhesion, linear (Shi et al. 2020, eq. 3)"),
        units,
        stiffness);
  }
  if (section.applies(law == "liquid_bridge")) {
    scene.cohesion = read_liquid_bridge(
        section.when("law",
                     "liquid_bridge",
                     "Liquid bridges that form at touch and rupture (Shi et al. 2020, eq. 4)"),
        units);
  }
}

/// Both papers list such coefficients and run with none.
void refuse_resistance(Section& section, std::string_view name, std::string_view what) {
  const auto coefficient = section.find<double>(
      {name, "accepted as 0 only: there is no such resistance", {}, not_negative}, "0");
  if (coefficient.value_or(0.0) == 0.0) return;
  section.problem(name,
                  std::string(what) +
                      " resistance is left out of the engine, as neither Brewster et al. (2008) "
                      "nor Shi et al. (2020) run with it: leave the key out or set it to 0");
}

Damping read_tangential_damping(Section& section, const Units& units) {
  const auto rate = section.find<double>(damping_rate("gamma_t, times the reduced mass", units),
                                         "0, unless dashpot is given");
  const auto viscosity = section.find<double>(
      dashpot("gamma_t, times the tangential velocity (Shi et al. 2020)", units),
      "0, unless damping_rate is given");
  section.at_most_one_of({"damping_rate", "dashpot"});
  return {rate.value_or(0.0), viscosity.value_or(0.0)};
}

void read_friction(InputFile& in, const Units& units, double normal_stiffness, dem::Scene& scene) {
  Section section = in.optional_section(
      "contact.friction", "Tangential force; without this section grains are frictionless");
  if (!section.given()) return;
  const std::string law =
      section.choice({"law",
                      "tangential spring, cut at the Coulomb limit: \"sliding\" with one "
                      "coefficient, \"stick_slip\" with a static one above the dynamic one"},
                     {"sliding", "stick_slip"});
  dem::StickSlip read;
  read.coefficient =
      section.read<double>({"coefficient",
                            "mu_p, static and dynamic, or dynamic; for 0 leave the section out",
                            {},
                            positive});
  if (section.applies(law == "stick_slip")) {
    const Key key{"static_coefficient", "mu_s, above coefficient", {}, positive};
    const auto value = section.find<double>(key, "required with \"stick_slip\"");
    if (!value) section.report_missing(key);
    read.static_coefficient = value.value_or(0.0);
  }
  const Key stiffness{"stiffness", "k_t", units[dimension::stiffness], positive};
  read.stiffness = section.find<double>(stiffness, "2/7 of the normal stiffness")
                       .value_or(2.0 / 7.0 * normal_stiffness);
  const Damping damping = read_tangential_damping(section, units);
  read.damping = damping.rate;
  read.dashpot = damping.dashpot;
  refuse_resistance(section, "rolling_coefficient", "rolling");
  refuse_resistance(section, "torsion_coefficient", "torsion");
  if (law == "stick_slip") {
    scene.friction = read;
  } else {
    scene.friction = dem::Sliding{read.coefficient, read.stiffness, read.damping, read.dashpot};
  }
}

}  // namespace

void read_laws(InputFile& in, const Units& units, dem::Scene& scene) {
  const double stiffness = read_normal(in, units, scene);
  read_cohesion(in, units, stiffness, scene);
  read_friction(in, units, stiffness, scene);
}

}  // namespace grainlaw::io
