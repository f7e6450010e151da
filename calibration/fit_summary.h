#pragma once

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace grainlaw::calibration {

/// Where the truth lies with 95 %; infinite, or the physical bound, where the data set no limit.
struct Interval {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool by_profile = false;  ///< profile likelihood; otherwise value and error of the covariance
};

/// One fitted coefficient.
struct FittedCoefficient {
  std::string name;
  double value = 0.0;
  double error = 0.0;     ///< standard error, same unit
  bool at_bound = false;  ///< the data push it against its physical bound (error is one-sided)
  bool identifiable = true;
  Interval interval = {};
};

/// What a fit found and how far it can be trusted.
struct FitSummary {
  std::vector<FittedCoefficient> coefficients;
  std::vector<double> correlation;         ///< row-major, order of coefficients
  std::vector<FittedCoefficient> derived;  ///< what follows from them, e.g. mu_inf
  double chi_squared = 0.0;
  int data = 0;  ///< number of residuals
  int iterations = 0;
  bool converged = false;
  std::string termination;                    ///< of the minimiser, in words
  std::vector<std::string> not_identifiable;  ///< sentences: which combination, why, what was done
  std::vector<std::string> left_out;          ///< points and terms that were left out, with reason
  double wall_seconds = 0.0;
  std::vector<std::string> notes;  ///< sentences: how errors were made, what a reader must know

  const FittedCoefficient& operator[](const std::string& name) const;
};

/// Data that cannot be fitted; the message says which, why and what would help.
struct FitError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace grainlaw::calibration
