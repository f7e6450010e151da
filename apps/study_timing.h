#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

#include "apps/study_runs.h"

namespace grainlaw::study {

struct Seconds {
  double cpu = 0.0;
  double wall = 0.0;
};

/// Middle value, the upper one of two.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Time of one call, the median of several measurements. Calls too short for the clock are timed
/// together.
template <class Work>
Seconds median_seconds(int repeats, const Work& work) {
  constexpr double shortest = 2e-3;  // [s], a thousand ticks of the clock
  std::vector<double> cpu, wall;
  for (int k = 0; k < repeats; ++k) {
    const double cpu_start = process_cpu_seconds();
    const auto start = std::chrono::steady_clock::now();
    int calls = 0;
    do {
      work();
      ++calls;
    } while (process_cpu_seconds() - cpu_start < shortest);
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    cpu.push_back((process_cpu_seconds() - cpu_start) / calls);
    wall.push_back(passed.count() / calls);
  }
  return {median(cpu), median(wall)};
}

}  // namespace grainlaw::study
