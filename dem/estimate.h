#pragma once

#include <limits>
#include <string_view>

namespace grainlaw::dem {

/// How far a mean can be trusted, by the independent samples N_eff it rests on.
enum class Convergence {
  not_converged,  ///< N_eff < 20 or unknown: the standard error is itself unsure by a third and
                  ///< more
  few_samples,    ///< N_eff < 100: by a sixth and more; "short" in words
  converged,
};

constexpr Convergence convergence(double effective_samples) {
  if (effective_samples >= 100.0) return Convergence::converged;
  return effective_samples >= 20.0 ? Convergence::few_samples : Convergence::not_converged;
}

/// "not converged", "short" or "converged".
constexpr std::string_view name(Convergence convergence) {
  if (convergence == Convergence::converged) return "converged";
  return convergence == Convergence::few_samples ? "short" : "not converged";
}

/// A measured number and its standard error, both in the unit of the quantity. Both NaN where
/// nothing was measured.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();
  /// N_eff of a mean over time; NaN where the error is no such scatter
  double effective_samples = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace grainlaw::dem
