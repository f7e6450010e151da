#include "apps/io/homogeneous_csv.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace grainlaw::io {

std::string homogeneous_csv(const std::vector<continuum::HomogeneousState>& states) {
  const auto text = [](const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string();
  };
  std::string out = "inertial_number,softness,bond_number,friction,volume_fraction,in_range\n";
  for (const auto& s : states)
    out += fmt::format("{},{},{},{},{},{}\n",
                       s.inertial_number,
                       s.softness,
                       s.bond_number,
                       text(s.friction),
                       text(s.volume_fraction),
                       s.in_range ? 1 : 0);
  return out;
}

std::string homogeneous_json(const std::vector<continuum::HomogeneousState>& states) {
  const auto value = [](const std::optional<double>& number) {
    return number ? nlohmann::ordered_json(*number) : nlohmann::ordered_json();
  };
  nlohmann::ordered_json out;
  for (const auto& s : states) {
    out["inertial_number"].push_back(s.inertial_number);
    out["softness"].push_back(s.softness);
    out["bond_number"].push_back(s.bond_number);
    out["friction"].push_back(value(s.friction));
    out["volume_fraction"].push_back(value(s.volume_fraction));
    out["in_range"].push_back(s.in_range);
  }
  return out.dump(1) + "\n";
}

}  // namespace grainlaw::io
