#pragma once

#include <string_view>

namespace grainlaw::dem {

/// No attraction: no force, no range beyond contact, nothing stored.
struct Cohesionless {
  static constexpr std::string_view name = "none";
  struct History {};
};

}  // namespace grainlaw::dem
