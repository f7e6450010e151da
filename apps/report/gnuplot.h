#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace grainlaw::report {

/// Runs gnuplot on a script inside `directory`. Empty when it succeeded, otherwise one sentence on
/// why there is no picture. Never throws for a missing or failing gnuplot.
std::optional<std::string> run_gnuplot(const std::filesystem::path& directory,
                                       const std::string& script);

}  // namespace grainlaw::report
