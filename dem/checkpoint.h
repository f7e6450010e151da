#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace grainlaw::dem {

/// Everything that shapes the further path of a run and what it has measured so far, as named
/// arrays. A run that goes on from it does not differ in any bit from one that was never stopped,
/// apart from the wall times under "run/".
struct Checkpoint {
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, std::vector<std::int64_t>> integers;
  std::map<std::string, std::string> texts;

  bool operator==(const Checkpoint&) const = default;
};

/// A checkpoint that belongs to another scene, or is not complete.
struct CheckpointError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The entry of that name; `size` elements, where given. Throws CheckpointError.
template <class T>
const std::vector<T>& entry(const std::map<std::string, std::vector<T>>& entries,
                            const std::string& name,
                            std::size_t size = static_cast<std::size_t>(-1)) {
  const auto found = entries.find(name);
  if (found == entries.end()) throw CheckpointError("the checkpoint has no '" + name + "'");
  if (size != static_cast<std::size_t>(-1) && found->second.size() != size) {
    throw CheckpointError("the checkpoint has '" + name + "' of another size");
  }
  return found->second;
}

}  // namespace grainlaw::dem
