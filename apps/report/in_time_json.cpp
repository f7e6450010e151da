#include "apps/report/in_time_json.h"

#include "apps/report/json_parts.h"

namespace grainlaw::report {
namespace {

json to_steady(const std::optional<calibration::TimeToSteady>& times) {
  if (!times) return nullptr;
  return {{"measured", estimate_json(times->measured)},
          {"predicted", estimate_json(times->predicted)},
          {"share", times->share}};
}

json stop(const std::optional<calibration::StoppingTime>& time) {
  if (!time) return nullptr;
  return {{"measured", time->measured ? estimate_json(*time->measured) : json(nullptr)},
          {"predicted", time->predicted ? json(*time->predicted) : json(nullptr)}};
}

json moments(const std::vector<calibration::Moment>& all) {
  json result = json::array();
  for (const calibration::Moment& moment : all) {
    result.push_back({{"time", moment.time},
                      {"measured_mean", moment.measured_mean},
                      {"predicted_mean", moment.predicted_mean},
                      {"velocity_error", moment.velocity_error}});
  }
  return result;
}

}  // namespace

nlohmann::ordered_json in_time_json(const RunComparison& run) {
  json result = json::array();
  for (const calibration::Stretch& stretch : run.in_time) {
    const auto& before = stretch.inclination_before;
    result.push_back({{"change", calibration::name(stretch.change)},
                      {"begin", stretch.begin},
                      {"end", stretch.end},
                      {"inclination", stretch.inclination},
                      {"inclination_before", before ? json(*before) : json(nullptr)},
                      {"velocity_norm", stretch.velocity_norm},
                      {"error", stretch.error},
                      {"to_steady", to_steady(stretch.to_steady)},
                      {"stop", stop(stretch.stop)},
                      {"moments", moments(stretch.moments)}});
  }
  return result;
}

}  // namespace grainlaw::report
