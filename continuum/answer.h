#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace grainlaw::continuum {

/// What a question to the continuum solver may end in; never a bare profile.
enum class Outcome {
  steady,          ///< steady flow, residual met
  plug,            ///< steady flow under an unsheared plug
  arrested,        ///< no motion: the yield stress holds the layer, or stopped it at Answer::time
  started,         ///< at rest until Answer::time, flowing since, not steady when the run ended
  accelerating,    ///< still gaining speed when the time ran out, no steady state ahead
  no_steady,       ///< the drive exceeds the largest friction: no steady flow exists
  no_dense_state,  ///< steady friction exists only beyond I_phi, where phi would vanish
  not_converged,   ///< neither steady nor excluded within the time or tolerance given
  time_reached,    ///< a transient was asked for and ran to its end
};

std::string_view name(Outcome outcome);  ///< STEADY, PLUG, ARRESTED, ...

/// A steady flow exists, with or without a plug.
constexpr bool flows(Outcome outcome) {
  return outcome == Outcome::steady || outcome == Outcome::plug;
}

/// The law was used outside the range of its data (never silent).
struct RangeFlag {
  std::string quantity;         ///< "I", "p*", "Bo", "phi", "inclination", "depth [d]"
  double lower = 0.0;           ///< range of the data, or that in which the law has a meaning
  double upper = 0.0;           ///< infinite for the depth
  double reached_lowest = 0.0;  ///< values met in this prediction
  double reached_highest = 0.0;
  double fraction_outside = 0.0;  ///< of the flowing mass
};

struct Answer {
  Outcome outcome = Outcome::not_converged;
  std::string text{};            ///< one sentence for a person, with the numbers that decide
  std::optional<double> time{};  ///< of ARRESTED and START in a time-dependent flow [time]
  std::vector<RangeFlag> out_of_domain{};
  /// d ln I / d ln mu at the base: by how many percent the shear rate is off when the friction is
  /// off by one, mu / (mu - mu0) for a linear mu(I), where mu = tan(theta) in a steady flow; 0
  /// where it has no meaning.
  double condition_number = 0.0;
};

/// A numerical method gave up; the message says where, when and in which unknown.
struct SolverError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace grainlaw::continuum
