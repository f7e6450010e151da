#pragma once

#include <vector>

#include "apps/io/scene_input.h"
#include "apps/io/study_input.h"
#include "apps/study_result.h"
#include "apps/study_runs.h"

namespace grainlaw::study {

// One function per kind of study. Each throws InputError for input that does not fit together,
// NoAnswer where no reference could be made, Stopped.
Result run(const io::TimeStepStudy& study, const io::StudyFile& file, const Context& context);
Result run(const io::GrainsStudy& study, const io::StudyFile& file, const Context& context);
Result run(const io::BaseStudy& study, const io::StudyFile& file, const Context& context);
Result run(const io::AveragingTimeStudy& study, const io::StudyFile& file, const Context& context);
Result run(const io::KernelStudy& study, const io::StudyFile& file, const Context& context);
Result run(const io::SolverStudy& study, const io::StudyFile& file, const Context& context);
Result run(const io::LawStudy& study, const io::StudyFile& file, const Context& context);
Result run(const io::WholeStudy& study, const io::StudyFile& file, const Context& context);

/// What a study will do: DEM scenes, other work in words, and settings that are refused.
struct Plan {
  std::vector<io::SceneFile> scenes;
  std::vector<std::string> other;
};
Plan plan(const io::TimeStepStudy& study);
Plan plan(const io::GrainsStudy& study);
Plan plan(const io::BaseStudy& study);
Plan plan(const io::AveragingTimeStudy& study);
Plan plan(const io::KernelStudy& study);
Plan plan(const io::SolverStudy& study);
Plan plan(const io::LawStudy& study);
Plan plan(const io::WholeStudy& study);

}  // namespace grainlaw::study
