#pragma once

#include <string>
#include <vector>

#include "calibration/comparison.h"
#include "calibration/material_fit.h"
#include "continuum/answer.h"

namespace grainlaw::calibration {

/// A law beside one measured number: law / measured - 1 and what may explain it, all relative to
/// the measured number.
struct LawResidual {
  dem::Estimate law;        ///< at the measured state; error: covariance of the table
  double difference = 0.0;  ///< law / measured - 1
  double statistics =
      0.0;                 ///< of the measured number, and of I and p* through the slope of the law
  double law_error = 0.0;  ///< of the table; 0: it states none
  double in_standard_errors = 0.0;  ///< difference over both together
};

/// A measured state beside the law there.
struct StateComparison {
  StatePoint point;
  SampleKind kind = SampleKind::independent;
  LawResidual friction;           ///< NaN where the table has no friction, or none there
  LawResidual volume_fraction;    ///< NaN where the law has left physics
  double condition_number = 0.0;  ///< d ln I / d ln mu of the law; 0: none
  std::vector<continuum::RangeFlag> out_of_domain;
};

/// I, p*, mu and phi of one row of fields, Bo = f_a / (sigma d^2) with sigma the normal stress of
/// the row; mu is that of the friction against the shear, positive.
StatePoint state_of(const dem::LocalRow& row,
                    const dem::ChuteConditions& conditions,
                    const std::string& name);

/// Throws continuum::TableError for a table without mu(I).
StateComparison compare_state(const StatePoint& point, const continuum::RheologyTable& table);

/// Root mean square of the differences of friction or volume fraction, those that are numbers.
double rms_difference(const std::vector<StateComparison>& states,
                      LawResidual StateComparison::*quantity);

}  // namespace grainlaw::calibration
