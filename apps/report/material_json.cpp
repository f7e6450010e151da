#include "apps/report/material_json.h"

#include "apps/report/json_parts.h"
#include "apps/report/law_curve.h"
#include "apps/report/material_law.h"

namespace grainlaw::report {
namespace {

json with_interval(const calibration::FittedCoefficient& c) {
  json result = coefficient_json(c);
  result["interval"] = {c.interval.lower, c.interval.upper};
  result["by_profile"] = c.interval.by_profile;
  return result;
}

json summary_json(const calibration::FitSummary& fit) {
  return {{"coefficients", list_json(fit.coefficients, with_interval)},
          {"derived", list_json(fit.derived, with_interval)},
          {"correlation", fit.correlation},
          {"chi_squared", fit.chi_squared},
          {"data", fit.data},
          {"converged", fit.converged},
          {"not_identifiable", fit.not_identifiable},
          {"left_out", fit.left_out},
          {"notes", fit.notes}};
}

json score_json(const calibration::ModelScore& score) {
  return {{"name", score.name},
          {"coefficients", score.coefficients},
          {"chi_squared", score.chi_squared},
          {"aicc", score.aicc},
          {"chosen", score.chosen}};
}

json points_json(const MaterialReport& material) {
  json result = json::array();
  for (std::size_t i = 0; i < material.points.size(); ++i) {
    const calibration::StatePoint& point = material.points[i];
    const LawValue left = residual(material, point);
    result.push_back({{"name", point.name},
                      {"run", point.run},
                      {"inertial_number", estimate_json(point.inertial_number)},
                      {"softness", estimate_json(point.softness)},
                      {"bond_number", estimate_json(point.bond_number)},
                      {"friction", estimate_json(point.friction)},
                      {"volume_fraction", estimate_json(point.volume_fraction)},
                      {"correlation", point.correlation},
                      {"unfit", point.unfit},
                      {"friction_residual", left.friction},
                      {"volume_fraction_residual", left.volume_fraction},
                      {"friction_weight", material.fit.friction_weight[i]},
                      {"volume_fraction_weight", material.fit.fraction_weight[i]}});
  }
  return result;
}

json information_json(const calibration::LawInformation& information) {
  const auto run = [](const calibration::RunInformation& r) -> json {
    return {{"run", r.run},
            {"points", r.points},
            {"wall_seconds", r.wall_seconds},
            {"gain", r.gain},
            {"gain_per_second", r.gain_per_second},
            {"error_increase", r.error_increase}};
  };
  return {{"coefficients", information.coefficients}, {"runs", list_json(information.runs, run)}};
}

json cost_json(const calibration::CostPoint& point) {
  return {{"share", point.share},
          {"dem_wall_seconds", point.dem_wall_seconds},
          {"friction", list_json(point.friction, estimate_json)},
          {"volume_fraction", list_json(point.volume_fraction, estimate_json)},
          {"friction_scatter", point.friction_scatter},
          {"fraction_scatter", point.fraction_scatter},
          {"failure", point.failure}};
}

json values_json(const continuum::RheologyTable& table) {
  json result = json::object();
  for (const Coefficient& c : coefficients(table)) result[c.name] = estimate_json(c.estimate);
  return result;
}

json reference_json(const MaterialReport& material) {
  if (!material.reference) return nullptr;
  return {{"name", material.reference_name}, {"coefficients", values_json(*material.reference)}};
}

}  // namespace

json material_json(const MaterialReport& material) {
  const calibration::MaterialFit& fit = material.fit;
  return {{"friction", summary_json(fit.friction)},
          {"volume_fraction", summary_json(fit.volume_fraction)},
          {"families", list_json(fit.families, score_json)},
          {"friction_models", list_json(fit.friction_models, score_json)},
          {"fraction_models", list_json(fit.fraction_models, score_json)},
          {"points", points_json(material)},
          {"left_out", material.left_out},
          {"friction_information", information_json(material.friction_information)},
          {"fraction_information", information_json(material.fraction_information)},
          {"cost", list_json(material.cost, cost_json)},
          {"reference", reference_json(material)}};
}

json contact_friction_json(const ContactFrictionReport& report) {
  json curves = json::object();
  for (const auto& [name, curve] : report.curves.coefficients) {
    curves[name] = {{"at_infinity", curve.at_infinity},
                    {"at_zero", curve.at_zero},
                    {"scale", curve.scale},
                    {"rms", curve.rms},
                    {"interpolation_error", curve.interpolation_error},
                    {"deviation", curve.deviation}};
  }
  json result = {{"tables", report.table_names},
                 {"curves", curves},
                 {"left_out", report.curves.left_out},
                 {"interpolated", nullptr}};
  if (report.interpolated) {
    result["interpolated"] = {{"contact_friction", report.interpolated->contact_friction},
                              {"coefficients", values_json(*report.interpolated)}};
  }
  return result;
}

}  // namespace grainlaw::report
