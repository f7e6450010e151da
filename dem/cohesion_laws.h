#pragma once
#include <string_view>
namespace grainlaw::dem {
struct Cohesionless {
  static constexpr std::string_view name = "none";
};
}  // namespace grainlaw::dem
