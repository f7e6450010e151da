#pragma once

#include <string>

#include "apps/command_line.h"
#include "apps/exit_code.h"
#include "apps/io/case_input.h"
#include "continuum/rheology_table.h"

namespace grainlaw {

/// Predicts a flow that is no chute: a shear band or the band of a split-bottom cell. `output` may
/// be empty. Throws NoAnswer where there is no flow.
ExitCode predict_flow(const io::CaseFile& file,
                      const continuum::RheologyTable& table,
                      const std::string& output,
                      bool certificate,
                      const CommonOptions& options);

}  // namespace grainlaw
