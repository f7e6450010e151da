#pragma once

#include <string>

#include "continuum/answer.h"
#include "continuum/rheology_table.h"

namespace grainlaw {

/// The one line of trust that ends every prediction: range of the data, condition number, band, and
/// everything the table says it was checked against. `with_errors`: the covariance of the table, if
/// it has one, went into the prediction.
std::string trust(const continuum::Answer& answer,
                  const continuum::RheologyTable& table,
                  bool with_errors = true);

/// "; checked against ...": all that the table says, or nothing.
std::string checks_text(const continuum::RheologyTable& table);

}  // namespace grainlaw
