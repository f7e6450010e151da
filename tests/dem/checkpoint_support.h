#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "dem/checkpoint.h"
#include "tests/dem/support.h"

namespace grainlaw::dem::test {

template <class T>
std::size_t differing_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return sizeof(T) * std::max(a.size(), b.size());
  std::size_t count = 0;
  const auto* bytes_of_a = reinterpret_cast<const unsigned char*>(a.data());
  const auto* bytes_of_b = reinterpret_cast<const unsigned char*>(b.data());
  for (std::size_t k = 0; k < sizeof(T) * a.size(); ++k) count += bytes_of_a[k] != bytes_of_b[k];
  return count;
}

/// Names every array in which two states differ, with the number of bytes.
inline std::string differences(const Checkpoint& a, const Checkpoint& b) {
  std::string found;
  const auto compare = [&](const auto& of_a, const auto& of_b) {
    if (of_a.size() != of_b.size()) found += "number of arrays; ";
    for (const auto& [name, values] : of_a) {
      if (name.starts_with("run/")) continue;
      const auto other = of_b.find(name);
      const std::size_t bytes = other == of_b.end() ? 1 : differing_bytes(values, other->second);
      if (bytes > 0) found += name + " (" + std::to_string(bytes) + " bytes); ";
    }
  };
  compare(a.numbers, b.numbers);
  compare(a.integers, b.integers);
  return found;
}

template <class Law>
Checkpoint state(Simulation<Law>& simulation) {
  Checkpoint checkpoint;
  simulation.save(checkpoint);
  return checkpoint;
}

/// N + M steps against N steps, a checkpoint, and M steps of a simulation made anew from the start.
template <class Law>
void expect_same_path(const Scene& scene, const Law& law, int before, int after, int threads = 1) {
  Simulation never_stopped = flow(scene, law);
  Simulation stopped = flow(scene, law);
  for (int k = 0; k < before; ++k) never_stopped.step(), stopped.step();
  const Checkpoint checkpoint = state(stopped);
  EXPECT_EQ(differences(checkpoint, state(never_stopped)), "");
  const long rebuilds = never_stopped.rebuilds();
  Simulation resumed = flow(scene, law, threads);
  resumed.restore(checkpoint);
  EXPECT_EQ(differences(checkpoint, state(resumed)), "") << "just restored";
  for (int k = 0; k < after; ++k) never_stopped.step(), resumed.step(), stopped.step();
  EXPECT_GT(never_stopped.rebuilds(), rebuilds) << "the path goes on across a rebuild";
  EXPECT_EQ(differences(state(never_stopped), state(resumed)), "") << kind(scene.geometry);
  EXPECT_EQ(differences(state(never_stopped), state(stopped)), "") << "saving changed the path";
}

}  // namespace grainlaw::dem::test
