#pragma once

#include <stdexcept>

namespace grainlaw {

/// Exit codes of every program (the same meaning everywhere).
enum class ExitCode : int {
  answered = 0,   ///< the asked answer exists
  bad_input = 1,  ///< input or usage
  no_answer = 2,  ///< no steady state, not converged, a step or budget refused; the reason is said
  resource = 3,   ///< disk or memory
  stopped = 4,    ///< by signal or --max-wall; checkpoint and what was measured are written
};

/// The question was understood and has no answer; what() is the reason.
struct NoAnswer : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace grainlaw
