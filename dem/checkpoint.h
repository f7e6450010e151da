#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace grainlaw::dem {

/// Everything that shapes the further path of a run and what it has measured so far, as named
/// arrays. A run that goes on from it does not differ in any bit from one that was never stopped.
struct Checkpoint {
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, std::vector<std::int64_t>> integers;
  std::map<std::string, std::string> texts;

  bool operator==(const Checkpoint&) const = default;
};

}  // namespace grainlaw::dem
