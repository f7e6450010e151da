#include "continuum/answer.h"

namespace grainlaw::continuum {

std::string_view name(Outcome outcome) {
  switch (outcome) {
    case Outcome::steady:
      return "STEADY";
    case Outcome::plug:
      return "PLUG";
    case Outcome::arrested:
      return "ARRESTED";
    case Outcome::started:
      return "START";
    case Outcome::accelerating:
      return "ACCELERATING";
    case Outcome::no_steady:
      return "NO_STEADY";
    case Outcome::no_dense_state:
      return "NO_DENSE_STATE";
    case Outcome::not_converged:
      return "NOT_CONVERGED";
    case Outcome::time_reached:
      return "TIME_REACHED";
  }
  return "UNKNOWN";
}

}  // namespace grainlaw::continuum
