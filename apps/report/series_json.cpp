#include "apps/report/series_json.h"

#include "apps/report/json_parts.h"

namespace grainlaw::report {
namespace {

json point_json(const calibration::ContactPoint& point) {
  return {{"name", point.name},
          {"series", point.series},
          {"stiffness", point.stiffness},
          {"attraction", point.attraction},
          {"shear_rate", point.shear_rate},
          {"Xi", list_json(point.ratio, coefficient_json)},
          {"Xi_of_law", point.ratio_of_law ? json(*point.ratio_of_law) : json(nullptr)},
          {"scaled_mean", estimate_json(point.mean)},
          {"scaled_mode", estimate_json(point.mode)},
          {"scaled_long_lifetime", estimate_json(point.long_lifetime)},
          {"collision_rate", estimate_json(point.collision_rate)},
          {"coordination", estimate_json(point.coordination)},
          {"contacts", point.contacts},
          {"tail_sampled", point.tail_sampled}};
}

json law_json(const calibration::RatioLaw& law) {
  return {{"factor", coefficient_json(law.factor)},
          {"rate", coefficient_json(law.rate)},
          {"left_out", law.summary.left_out}};
}

json law_or_null(const std::optional<calibration::RatioLaw>& law) {
  return law ? law_json(*law) : json(nullptr);
}

json stiffness_json(const calibration::StiffnessLaws& laws) {
  return {{"series", laws.series},
          {"Xi", list_json(laws.ratio, law_or_null)},
          {"collision_rate", law_or_null(laws.collision_rate)},
          {"mean_lifetime", law_or_null(laws.mean_lifetime)}};
}

json correlation_json(const calibration::RankCorrelation& correlation) {
  return {{"with", correlation.with}, {"value", correlation.value}, {"runs", correlation.runs}};
}

json cohesive_point_json(const calibration::CohesivePoint& point) {
  const auto& plug = point.plug;
  return {{"name", point.name},
          {"series", point.series},
          {"attraction", point.attraction},
          {"inclination", point.inclination},
          {"layer_height", point.layer_height},
          {"flowing_height", point.flowing_height()},
          {"plug_thickness", plug ? json(plug->thickness) : json(nullptr)},
          {"tau_c_weight", plug ? estimate_json(plug->yield_stress_from_weight) : json(nullptr)},
          {"tau_c_pairs", estimate_json(point.yield_stress)},
          {"tau_c_at_bound", point.at_bound},
          {"c0", estimate_json(point.cohesion)}};
}

json pooled_json(const calibration::PooledCohesion& one) {
  return {{"series", one.series},
          {"attraction", one.attraction},
          {"c0", estimate_json(one.cohesion)},
          {"tilts", one.tilts},
          {"chance", one.chance}};
}

json cohesion_json(const calibration::CohesionSeries& cohesion) {
  return {{"mu0", cohesion.mu0 ? estimate_json(*cohesion.mu0) : json(nullptr)},
          {"points", list_json(cohesion.points, cohesive_point_json)},
          {"pooled", list_json(cohesion.pooled, pooled_json)},
          {"left_out", cohesion.left_out}};
}

}  // namespace

json series_json(const SeriesReport& series) {
  const calibration::ContactSeries& contacts = series.contacts;
  return {{"points", list_json(contacts.points, point_json)},
          {"stiffness", list_json(contacts.stiffness, stiffness_json)},
          {"lifetime_law", law_or_null(contacts.lifetime_law)},
          {"rank_correlations", list_json(contacts.correlations, correlation_json)},
          {"left_out", contacts.left_out},
          {"cohesion", series.cohesion ? cohesion_json(*series.cohesion) : json(nullptr)},
          {"law", series.law_name}};
}

}  // namespace grainlaw::report
