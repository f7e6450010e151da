#include "apps/io/profile_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace grainlaw::io {
namespace {

using continuum::Profile;
using continuum::ProfileRow;

/// One column of a profile.
struct Column {
  const char* name;
  double ProfileRow::*member;
  Dimension dimension;
  bool error = false;
};
constexpr auto columns = std::to_array<Column>({
    {"z", &ProfileRow::z, dimension::length},
    {"mass_above", &ProfileRow::mass_above, dimension::mass_per_area},
    {"velocity", &ProfileRow::velocity, dimension::velocity},
    {"shear_rate", &ProfileRow::shear_rate, dimension::rate},
    {"shear_stress", &ProfileRow::shear_stress, dimension::stress},
    {"pressure", &ProfileRow::pressure, dimension::stress},
    {"volume_fraction", &ProfileRow::volume_fraction, dimension::number},
    {"inertial_number", &ProfileRow::inertial_number, dimension::number},
    {"velocity_error", &ProfileRow::velocity_error, dimension::velocity, true},
    {"volume_fraction_error", &ProfileRow::volume_fraction_error, dimension::number, true},
});

/// An error that is 0 everywhere was never stated; a column of zeros would claim exactness.
std::vector<Column> columns_of(const Profile& profile, const std::string& coordinate) {
  const auto says_something = [&](const Column& column) {
    return !column.error || std::ranges::any_of(profile.rows, [&](const ProfileRow& row) {
      return row.*column.member != 0.0;
    });
  };
  std::vector<Column> out;
  std::ranges::copy_if(columns, std::back_inserter(out), says_something);
  out.front().name = coordinate.c_str();
  return out;
}

/// One number that holds for the whole profile.
struct Total {
  const char* name;
  double Profile::*member;
  Dimension dimension;
};
constexpr auto totals = std::to_array<Total>({
    {"height", &Profile::height, dimension::length},
    {"surface_velocity", &Profile::surface_velocity, dimension::velocity},
    {"flux", &Profile::flux, dimension::flux},
    {"plug_mass", &Profile::plug_mass, dimension::mass_per_area},
});

}  // namespace

std::string flag_text(const continuum::RangeFlag& flag) {
  if (std::isinf(flag.upper))
    return fmt::format("{} is {:.3g}, a continuum law needs at least about {:.3g}",
                       flag.quantity,
                       flag.reached_lowest,
                       flag.lower);
  return fmt::format(
      "{} reaches {:.3g} to {:.3g}, data {:.3g} to {:.3g} ({:.0f} % of the flowing mass outside)",
      flag.quantity,
      flag.reached_lowest,
      flag.reached_highest,
      flag.lower,
      flag.upper,
      100.0 * flag.fraction_outside);
}

std::string profile_csv(const Profile& profile,
                        const continuum::Answer& answer,
                        const Units& units,
                        const std::string& coordinate) {
  std::string out = fmt::format(
      "# {}: {}\n# units {}\n", continuum::name(answer.outcome), answer.text, units.symbols());
  for (const auto& flag : answer.out_of_domain) out += "# OUT_OF_DOMAIN: " + flag_text(flag) + "\n";
  for (const Total& total : totals) {
    out += fmt::format("# {} = {} {}\n",
                       total.name,
                       profile.*total.member * units.size(total.dimension),
                       units.symbol(total.dimension));
  }
  const std::vector<Column> shown = columns_of(profile, coordinate);
  const char* separator = "";
  for (const Column& column : shown) {
    out += fmt::format("{}{} [{}]", separator, column.name, units.symbol(column.dimension));
    separator = ",";
  }
  for (const ProfileRow& row : profile.rows) {
    separator = "\n";
    for (const Column& column : shown) {
      out += fmt::format("{}{}", separator, row.*column.member * units.size(column.dimension));
      separator = ",";
    }
  }
  return out + "\n";
}

std::string profile_json(const Profile& profile,
                         const continuum::Answer& answer,
                         const Units& units,
                         const std::string& coordinate) {
  nlohmann::ordered_json out;
  out["outcome"] = continuum::name(answer.outcome);
  out["text"] = answer.text;
  out["condition_number"] = answer.condition_number;
  out["out_of_domain"] = nlohmann::ordered_json::array();
  for (const auto& flag : answer.out_of_domain) {
    out["out_of_domain"].push_back({{"quantity", flag.quantity},
                                    {"data", {flag.lower, flag.upper}},
                                    {"reached", {flag.reached_lowest, flag.reached_highest}},
                                    {"fraction_outside", flag.fraction_outside}});
  }
  out["units"]["set"] = units.symbols();
  for (const Total& total : totals) {
    out[total.name] = profile.*total.member * units.size(total.dimension);
    out["units"][total.name] = units.symbol(total.dimension);
  }
  for (const Column& column : columns_of(profile, coordinate)) {
    nlohmann::ordered_json& values = out["profile"][column.name] = nlohmann::ordered_json::array();
    for (const ProfileRow& row : profile.rows) {
      values.push_back(row.*column.member * units.size(column.dimension));
    }
    out["units"][column.name] = units.symbol(column.dimension);
  }
  return out.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace grainlaw::io
