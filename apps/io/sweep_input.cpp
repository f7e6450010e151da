#include "apps/io/sweep_input.h"

namespace grainlaw::io {
namespace {

using Kind = SweepAxis::Kind;

void add_axis(Section& section, Kind kind, const Key& key, std::vector<SweepAxis>& axes) {
  const auto values = section.find<std::vector<double>>(key, "as in the rest of the file");
  if (!section.has(key.name)) return;
  axes.push_back({kind, std::string(key.name), values.value_or(std::vector<double>{})});
  if (axes.back().values.empty())
    section.problem(key.name, "a list without values sweeps over nothing");
}

void read_coefficients(Section& section, std::vector<SweepAxis>& axes) {
  const auto names = section.find<std::vector<std::string>>(
      {"coefficients", "of the table that are varied, by name"}, "those of the table");
  const auto values = section.find<NumberRows>(
      {"coefficient_values", "one list of values for each of them, in the units of the table"},
      "required with coefficients");
  if (section.has("coefficients") && !names) return;  // a wrong value: said already
  if (section.has("coefficient_values") && !values) return;
  const std::size_t count = names ? names->size() : 0;
  if (count != (values ? values->size() : 0)) {
    section.problem(names ? "coefficients" : "coefficient_values",
                    "coefficients and coefficient_values must be equally long");
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if ((*values)[i].empty())
      section.problem("coefficient_values", "a list without values sweeps over nothing");
    axes.push_back({Kind::coefficient, (*names)[i], (*values)[i]});
  }
}

}  // namespace

void read_sweep(InputFile& in, CaseFile& file) {
  Section section = in.optional_section(
      "sweep", "Steady flows at every combination of these values, one row each in one table");
  if (!section.given()) return;
  const Units& units = file.units;
  std::vector<SweepAxis> axes;
  add_axis(section,
           Kind::inclination,
           {"inclination", "tilts of the base", {"degrees"}, between(-90.0, 90.0)},
           axes);
  add_axis(section,
           Kind::mass_per_area,
           {"mass_per_area", "flowing masses", units[dimension::mass_per_area], positive},
           axes);
  add_axis(section,
           Kind::depth,
           {"depth", "heights of the free surface", units[dimension::length], positive},
           axes);
  add_axis(section,
           Kind::stiffness,
           {"stiffness", "contact stiffnesses k_n", units[dimension::stiffness], positive},
           axes);
  add_axis(section,
           Kind::adhesion,
           {"adhesion", "largest attractions f_a", units[dimension::force], not_negative},
           axes);
  section.at_most_one_of({"mass_per_area", "depth"});
  if (units.name == "stiffness" && section.has("stiffness"))
    section.problem("stiffness", "the set \"stiffness\" fixes k_n: sweep in another set of units");
  read_coefficients(section, axes);
  if (axes.empty() && !section.has("coefficients"))
    section.problem("", "[sweep] names nothing to vary");
  if (file.question != Question::steady)
    section.problem("", "a sweep asks for steady flows: give answer = \"steady\"");
  for (SweepAxis& axis : axes)
    if (axis.kind == Kind::inclination)
      for (double& tilt : axis.values) tilt = radians(tilt);
  file.sweep = std::move(axes);
}

}  // namespace grainlaw::io
