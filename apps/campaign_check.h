#pragma once

#include <string>
#include <vector>

#include "apps/command_line.h"
#include "apps/io/campaign_input.h"

namespace grainlaw {

// What a campaign would do (--check). Nothing is run and nothing written.

/// Every run with its time step, memory and run time.
void check_runs(const io::Campaign& campaign, const CommonOptions& options);

/// Which of the finished runs would be fitted, which are left out and which are missing. Throws
/// like gather.
void check_given(const io::Campaign& campaign,
                 const std::vector<std::string>& from,
                 const CommonOptions& options);

/// What a budget would choose from, and its first runs. Throws NoAnswer where it is too small or
/// there is too little to choose from, and like gather.
void check_budget(const io::Campaign& campaign,
                  const std::vector<std::string>& from,
                  double seconds,
                  const CommonOptions& options);

}  // namespace grainlaw
