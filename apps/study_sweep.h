#pragma once

#include <string>
#include <vector>

#include "apps/io/study_input.h"
#include "apps/study_result.h"
#include "apps/study_runs.h"

namespace grainlaw::study {

/// One value of what is swept; several runs where there are several seeds.
struct Setting {
  std::string label;
  std::vector<io::SceneFile> scenes;
  std::string failure{};  ///< refused before it could run
};

/// Runs every setting and holds what is measured (chute: I, phi, a, b; simple shear: mu, phi)
/// against the last, finest setting; the energy residual needs no reference. Throws NoAnswer where
/// the finest has no result, Stopped.
Result compare_with_finest(const std::vector<Setting>& settings,
                           const io::StudyFile& file,
                           const Context& context);

}  // namespace grainlaw::study
