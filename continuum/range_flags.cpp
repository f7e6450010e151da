#include "continuum/range_flags.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainlaw::continuum {
namespace {

/// Share of a bound by which rounding may miss it.
constexpr double rounding = 1e-9;

bool outside(double value, const Range& range) {
  return value < range.lower - rounding * std::abs(range.lower) ||
         value > range.upper + rounding * std::abs(range.upper);
}

struct Met {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
  double mass = 0.0;
  double mass_outside = 0.0;

  void add(double value, double weight, const Range& range) {
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
    mass += weight;
    if (outside(value, range)) mass_outside += weight;
  }
};

/// Half of the mass to the rows on either side.
double row_mass(const std::vector<ProfileRow>& rows, std::size_t i) {
  const double below = i == 0 ? rows[i].mass_above : rows[i - 1].mass_above;
  const double above = i + 1 == rows.size() ? rows[i].mass_above : rows[i + 1].mass_above;
  return 0.5 * (below - above);
}

/// Compares value(row) with the range over the sheared rows; no flag when all are inside.
template <class Value>
void flag(std::vector<RangeFlag>& flags,
          const char* quantity,
          const Range& range,
          const Profile& profile,
          Value value) {
  Met met;
  for (std::size_t i = 0; i < profile.rows.size(); ++i) {
    const ProfileRow& row = profile.rows[i];
    if (row.mass_above <= profile.plug_mass || row.pressure <= 0.0 || row.shear_rate == 0.0)
      continue;  // neither plug nor what rests at the base shears
    met.add(value(row), row_mass(profile.rows, i), range);
  }
  if (met.mass_outside > 0.0)
    flags.push_back(
        {quantity, range.lower, range.upper, met.lowest, met.highest, met.mass_outside / met.mass});
}

void flag_inclination(std::vector<RangeFlag>& flags, const Layer& layer) {
  const auto* law = std::get_if<GeneralisedBagnold>(&layer.law);
  // tilts given in degrees agree in radians only up to rounding
  if (!law || std::abs(law->inclination - layer.inclination) < 1e-9) return;
  flags.push_back({"inclination",
                   law->inclination,
                   law->inclination,
                   layer.inclination,
                   layer.inclination,
                   1.0});
}

/// A continuum law has no meaning in a layer of a few grains, whatever its data.
void flag_depth(std::vector<RangeFlag>& flags, const Profile& profile) {
  constexpr double shallowest = 5.0;
  if (profile.rows.empty() || profile.height >= shallowest) return;
  constexpr double unbounded = std::numeric_limits<double>::infinity();
  flags.push_back({"depth [d]", shallowest, unbounded, profile.height, profile.height, 1.0});
}

/// Cohesion that fades with p*: grains stiffer than those of the data lose it.
bool cohesion_needs_softness(const Layer& layer) {
  const auto* law = std::get_if<MuPhi>(&layer.law);
  return law && layer.grains.adhesion && law->cohesion_stress &&
         law->cohesion_stress->softness_exponent;
}

void flag_softness(std::vector<RangeFlag>& flags,
                   const Layer& layer,
                   const std::optional<Range>& range,
                   const Profile& profile) {
  const bool needed = cohesion_needs_softness(layer);
  if (!range || !(layer.grains.stiffness || needed)) return;
  // towards p* = 0 softness drops out of the other laws, so only the upper end can be left
  flag(flags, "p*", {needed ? range->lower : 0.0, range->upper}, profile, [&](const auto& row) {
    return layer.grains.stiffness ? row.pressure / *layer.grains.stiffness : 0.0;
  });
}

/// Bond numbers a table covers; cohesive grains on a law without cohesion are outside at once, and
/// a power of Bo without stated data is trusted up to where its guard begins.
std::optional<Range> bond_range(const Layer& layer, const RheologyTable& table) {
  if (table.range.bond_number) return table.range.bond_number;
  const auto* law = std::get_if<MuPhi>(&layer.law);
  if (!law || law->cohesion_friction || !layer.grains.adhesion) return std::nullopt;
  if (!law->cohesion_stress) return Range{0.0, 0.0};
  if (law->cohesion_stress->bond_exponent) return Range{0.0, largest_fitted_bond_number};
  return std::nullopt;
}

}  // namespace

std::vector<RangeFlag> range_flags(const Layer& layer,
                                   const RheologyTable& table,
                                   const Profile& profile) {
  std::vector<RangeFlag> flags;
  flag_inclination(flags, layer);
  flag_depth(flags, profile);
  if (const auto& range = table.range.inertial_number)
    flag(flags, "I", *range, profile, [](const ProfileRow& row) { return row.inertial_number; });
  flag_softness(flags, layer, table.range.softness, profile);
  if (const auto range = bond_range(layer, table))
    flag(flags, "Bo", *range, profile, [&](const ProfileRow& row) {
      return layer.grains.adhesion.value_or(0.0) / row.pressure;
    });
  // below 0.5 the flow is no longer dense; above, equal spheres cannot be packed without overlap
  constexpr Range dense{0.5, 0.7405};
  flag(flags, "phi", dense, profile, [](const ProfileRow& row) { return row.volume_fraction; });
  return flags;
}

}  // namespace grainlaw::continuum
