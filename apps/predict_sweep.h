#pragma once

#include <string>

#include "apps/command_line.h"
#include "apps/exit_code.h"
#include "apps/io/case_input.h"

namespace grainlaw {

/// Steady chutes at every combination of a [sweep]: one CSV row each, with its outcome, in `output`
/// or, where that is empty, on stdout. Answered when at least one of them flows.
ExitCode predict_sweep(const io::CaseFile& file,
                       const std::string& table_path,
                       const std::string& output,
                       const CommonOptions& options);

}  // namespace grainlaw
