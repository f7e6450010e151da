#include "apps/grain_scales.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "continuum/bracket.h"

namespace grainlaw {
namespace {

namespace is = io::dimension;

constexpr double tolerated = 0.01;  // change of the response that a DEM may make
constexpr double steps_per_contact = 50.0;

const continuum::ProfileRow& middle_row(const continuum::Profile& profile) {
  const double middle = 0.5 * (profile.rows.front().z + profile.rows.back().z);
  for (const continuum::ProfileRow& row : profile.rows)
    if (row.z >= middle) return row;
  return profile.rows.back();
}

bool knows_softness(const continuum::RheologyTable& table) {
  const auto* law = std::get_if<continuum::MuPhi>(&table.law);
  return law && (law->softness_friction || law->softness_volume_fraction);
}

double mass_of(const continuum::GrainProperties& grains) {
  return grains.density * std::numbers::pi / 6.0 * std::pow(grains.diameter, 3);
}

/// Half a period of two equal grains on the spring, without damping.
double contact_time(const continuum::GrainProperties& grains, double stiffness) {
  return std::numbers::pi * std::sqrt(mass_of(grains) / (2.0 * stiffness));
}

/// The least k_n whose response stays within `tolerated` of that of the grains; absent where even
/// very soft grains change nothing.
std::optional<double> softest(const FlowOfGrains& flow) {
  const auto near = [&](double softening) {
    continuum::GrainProperties grains = flow.grains;
    *grains.stiffness *= std::exp(-softening);
    const auto value = flow.with(grains);
    return value && std::abs(*value / flow.value - 1.0) < tolerated;
  };
  double far = 1.0;
  while (near(far)) {
    far *= 2.0;
    if (far > 60.0) return std::nullopt;
  }
  return *flow.grains.stiffness * std::exp(-continuum::split(near, 0.0, far, 1e-4).low);
}

void say_pressure_scales(Summary& summary, const FlowOfGrains& flow) {
  const auto& grains = flow.grains;
  const double base = flow.profile.rows.front().pressure;
  if (grains.stiffness)
    summary.add("softness_base", "p* " + flow.place, base * grains.diameter / *grains.stiffness);
  if (!grains.adhesion) return;
  const double unit = *grains.adhesion / (grains.diameter * grains.diameter);
  summary.add("bond_number_base", "Bo " + flow.place, unit / base);
  summary.add("bond_number_middle", "Bo at half depth", unit / middle_row(flow.profile).pressure);
}

/// What the comparison with rigid grains means for who asked.
std::string rigid_text(const FlowOfGrains& flow, const std::optional<double>& rigid, bool enough) {
  if (enough)
    return fmt::format("rigid grains have this {} within {:g} %: k_n hardly matters here",
                       flow.response,
                       100.0 * tolerated);
  const std::string they =
      rigid ? fmt::format("have another {} by more than {:g} %", flow.response, 100.0 * tolerated)
            : std::string("would not flow");
  return fmt::format(
      "rigid grains {}: k_n matters here, and neither rigid nor much softer grains may stand for "
      "these",
      they);
}

bool knows_cohesion(const continuum::RheologyTable& table) {
  if (const auto* law = std::get_if<continuum::GeneralisedBagnold>(&table.law))
    return law->tau_c > 0.0;
  const auto& law = std::get<continuum::MuPhi>(table.law);
  return law.cohesion_friction || law.cohesion_stress || !table.has_friction;
}

void say_rigid(Summary& summary, const FlowOfGrains& flow, const io::Units& units) {
  continuum::GrainProperties rigid = flow.grains;
  rigid.stiffness.reset();
  const auto value = flow.with(rigid);
  const bool enough = value && std::abs(*value / flow.value - 1.0) < tolerated;
  summary.add("stiff_enough", "stiff enough to be rigid", enough);
  summary.add("rigid_text", "  in words", rigid_text(flow, value, enough));
  if (!value) return;
  summary.add("rigid_response",
              "  rigid grains' " + flow.response,
              *value * units.size(flow.dimension),
              units.symbol(flow.dimension));
  summary.add("rigid_difference", "  which differs by", 100.0 * (*value / flow.value - 1.0), "%");
}

void say_time_step(Summary& summary,
                   const std::string& key,
                   const std::string& indent,
                   const continuum::GrainProperties& grains,
                   double stiffness,
                   const io::Units& units) {
  const double time = contact_time(grains, stiffness);
  const std::string symbol = units.symbol(is::time);
  summary.add(key + "contact_time", indent + "contact time", time * units.time, symbol);
  summary.add(key + "time_step",
              indent + fmt::format("time step, 1/{:.0f}", steps_per_contact),
              time / steps_per_contact * units.time,
              symbol);
}

void say_dem(Summary& summary, const FlowOfGrains& flow, bool softens, const io::Units& units) {
  const auto stiffness = [&](const char* key, const char* label, double value) {
    summary.add(key, label, value * units.size(is::stiffness), units.symbol(is::stiffness));
  };
  const double own = *flow.grains.stiffness;
  summary.heading("DEM of these grains");
  stiffness("stiffness", "k_n", own);
  say_time_step(summary, "", "  ", flow.grains, own, units);
  if (!softens) return;
  const auto soft = softest(flow);
  if (!soft) {
    summary.add(
        "softest_text", "softest k_n within 1 %", std::string("any: softness acts on nothing"));
    return;
  }
  stiffness("softest_stiffness", "softest k_n within 1 %", *soft);
  say_time_step(summary, "softest_", "  ", flow.grains, *soft, units);
  summary.add("softest_gain", "  fewer steps by", std::sqrt(own / *soft));
}

}  // namespace

std::optional<std::string> unknown_cohesion(const continuum::RheologyTable& table,
                                            bool grains_attract) {
  if (!grains_attract || knows_cohesion(table)) return std::nullopt;
  return "the friction law of this table knows no cohesion: the attraction of these grains holds "
         "nothing in this prediction; it takes a table of cohesive grains";
}

void say_unknown_cohesion(Summary& summary,
                          const continuum::RheologyTable& table,
                          bool grains_attract) {
  if (const auto text = unknown_cohesion(table, grains_attract))
    summary.add("cohesion_text", "cohesion", *text);
}

void say_grain_scales(Summary& summary,
                      const FlowOfGrains& flow,
                      const continuum::RheologyTable& table,
                      const io::Units& units) {
  const auto& grains = flow.grains;
  if (flow.profile.rows.empty() || (!grains.stiffness && !grains.adhesion)) return;
  const bool softens = knows_softness(table);
  summary.heading("Grains");
  say_pressure_scales(summary, flow);
  if (!grains.stiffness) return;
  if (softens)
    say_rigid(summary, flow, units);
  else
    summary.add("stiffness_text",
                "stiff enough",
                std::string("not known: this table has no law of softness"));
  say_dem(summary, flow, softens, units);
}

}  // namespace grainlaw
