#pragma once

#include <nlohmann/json.hpp>

#include "calibration/fit_summary.h"
#include "dem/estimate.h"

namespace grainlaw::report {

using json = nlohmann::ordered_json;

inline json estimate_json(const dem::Estimate& estimate) {
  return {{"value", estimate.value}, {"error", estimate.error}};
}

inline json coefficient_json(const calibration::FittedCoefficient& coefficient) {
  return {{"name", coefficient.name},
          {"value", coefficient.value},
          {"error", coefficient.error},
          {"at_bound", coefficient.at_bound},
          {"identifiable", coefficient.identifiable}};
}

template <class Values, class Convert>
json list_json(const Values& values, Convert convert) {
  json result = json::array();
  for (const auto& value : values) result.push_back(convert(value));
  return result;
}

}  // namespace grainlaw::report
