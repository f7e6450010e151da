#include "apps/report/report_json.h"

#include "apps/report/budget_json.h"
#include "apps/report/flow_json.h"
#include "apps/report/in_time_json.h"
#include "apps/report/json_parts.h"
#include "apps/report/law_curve.h"
#include "apps/report/material_json.h"
#include "apps/report/series_json.h"
#include "continuum/well_posedness.h"

namespace grainlaw::report {
namespace {

// Declared before the templates that convert their vectors and optionals.
json to_json(const dem::Estimate&);
json to_json(const continuum::Range&);
json to_json(const calibration::FittedCoefficient&);
json to_json(const calibration::FitSummary&);
json to_json(const calibration::FlowPoint&);
json to_json(const calibration::ProfileError&);
json to_json(const calibration::BagnoldFit&);
json to_json(const continuum::RangeFlag&);
json to_json(const continuum::Answer&);
json to_json(const continuum::ProfileRow&);
json to_json(const continuum::Profile&);
json to_json(const continuum::SolverStatistics&);
json to_json(const continuum::TransientChute&);
json to_json(const dem::LocalRow&);
json to_json(const dem::ChuteConditions&);
json to_json(const dem::SteadyWindow&);
json to_json(const dem::RunSummary&);
json to_json(const continuum::CertifiedConfinement&);
json to_json(const RunComparison&);
json to_json(const TimeErrorPoint&);
json to_json(const SeedScatter&);
json to_json(const StageCost&);
json to_json(const Coefficient&);
json to_json(const continuum::Covariance&);
json to_json(const continuum::EffectiveBase&);
json to_json(const continuum::RheologyTable&);
json to_json(const calibration::MuPhiFit&);

json to_json(const dem::Estimate& estimate) {
  return estimate_json(estimate);
}

template <class T>
json to_json(const std::optional<T>& value) {
  return value ? to_json(*value) : json(nullptr);
}

template <class T>
json to_json(const std::vector<T>& values) {
  json result = json::array();
  for (const T& value : values) result.push_back(to_json(value));
  return result;
}

json to_json(const continuum::Range& range) {
  return {range.lower, range.upper};
}

json to_json(const calibration::FittedCoefficient& coefficient) {
  return coefficient_json(coefficient);
}

json to_json(const calibration::FitSummary& fit) {
  return {{"coefficients", to_json(fit.coefficients)},
          {"correlation", fit.correlation},
          {"chi_squared", fit.chi_squared},
          {"data", fit.data},
          {"iterations", fit.iterations},
          {"converged", fit.converged},
          {"termination", fit.termination},
          {"not_identifiable", fit.not_identifiable},
          {"left_out", fit.left_out},
          {"notes", fit.notes},
          {"wall_seconds", fit.wall_seconds}};
}

json to_json(const calibration::FlowPoint& point) {
  return {{"name", point.name},
          {"inclination", point.inclination},
          {"inertial_number", to_json(point.inertial_number)},
          {"friction", to_json(point.friction)},
          {"volume_fraction", to_json(point.volume_fraction)},
          {"no_slip_height", to_json(point.no_slip_height)},
          {"mass_below", to_json(point.mass_below)},
          {"softness", {point.softness_lower, point.softness_upper}}};
}

json to_json(const calibration::ProfileError& error) {
  return {{"velocity", to_json(error.velocity)},
          {"velocity_maximum", to_json(error.velocity_maximum)},
          {"volume_fraction", to_json(error.volume_fraction)},
          {"friction", to_json(error.friction)},
          {"surface_velocity", to_json(error.surface_velocity)},
          {"flux", to_json(error.flux)},
          {"in_standard_errors", error.in_standard_errors},
          {"velocity_top", error.velocity_top},
          {"fraction_top", error.fraction_top}};
}

json to_json(const calibration::BagnoldFit& fit) {
  return {{"free_base", to_json(fit.summary)},
          {"fixed_base", to_json(fit.fixed_base_summary)},
          {"ratio_mid_depth", to_json(fit.ratio_mid_depth)},
          {"ratio_mid_depth_fixed", to_json(fit.ratio_mid_depth_fixed)}};
}

json to_json(const continuum::RangeFlag& flag) {
  return {{"quantity", flag.quantity},
          {"range", {flag.lower, flag.upper}},
          {"reached", {flag.reached_lowest, flag.reached_highest}},
          {"fraction_outside", flag.fraction_outside}};
}

json to_json(const continuum::Answer& answer) {
  return {{"outcome", continuum::name(answer.outcome)},
          {"text", answer.text},
          {"condition_number", answer.condition_number},
          {"out_of_domain", to_json(answer.out_of_domain)}};
}

json to_json(const continuum::ProfileRow& row) {
  return {{"z", row.z},
          {"mass_above", row.mass_above},
          {"velocity", row.velocity},
          {"velocity_error", row.velocity_error},
          {"shear_rate", row.shear_rate},
          {"shear_stress", row.shear_stress},
          {"pressure", row.pressure},
          {"volume_fraction", row.volume_fraction},
          {"volume_fraction_error", row.volume_fraction_error},
          {"inertial_number", row.inertial_number}};
}

json to_json(const continuum::Profile& profile) {
  return {{"height", profile.height},
          {"surface_velocity", profile.surface_velocity},
          {"flux", profile.flux},
          {"plug_mass", profile.plug_mass},
          {"rows", to_json(profile.rows)}};
}

json to_json(const continuum::SolverStatistics& statistics) {
  return {{"steps", statistics.steps},
          {"rhs_evaluations", statistics.rhs_evaluations},
          {"jacobian_evaluations", statistics.jacobian_evaluations},
          {"error_test_failures", statistics.error_test_failures},
          {"newton_failures", statistics.newton_failures},
          {"wall_seconds", statistics.wall_seconds}};
}

json to_json(const continuum::TransientChute& transient) {
  return {{"answer", to_json(transient.answer)},
          {"end_time", transient.end_time},
          {"residual", transient.residual},
          {"statistics", to_json(transient.statistics)}};
}

json to_json(const dem::LocalRow& row) {
  return {{"z", row.z},
          {"mass_above", row.mass_above},
          {"velocity", to_json(row.velocity)},
          {"shear_rate", to_json(row.shear_rate)},
          {"volume_fraction", to_json(row.volume_fraction)},
          {"shear_stress", to_json(row.shear_stress)},
          {"normal_stress", to_json(row.normal_stress)},
          {"temperature", to_json(row.temperature)},
          {"inertial_number", to_json(row.inertial_number)},
          {"softness", to_json(row.softness)},
          {"friction", to_json(row.friction)},
          {"effective_samples", row.effective_samples}};
}

json to_json(const dem::ChuteConditions& chute) {
  return {{"inclination", chute.inclination},
          {"gravity", chute.gravity},
          {"grain_diameter", chute.grain_diameter},
          {"grain_density", chute.grain_density},
          {"stiffness", chute.stiffness},
          {"contact_friction", chute.contact_friction},
          {"mass_per_area", chute.mass_per_area},
          {"base", chute.base}};
}

json to_json(const dem::SteadyWindow& window) {
  return {{"steady", window.steady},
          {"begin", window.begin},
          {"end", window.end},
          {"reason", window.reason}};
}

json to_json(const dem::RunSummary& run) {
  return {{"time_step", run.time_step},
          {"contact_time", run.contact_time},
          {"restitution", run.restitution},
          {"steps", run.steps},
          {"flowing_grains", run.flowing_grains},
          {"base_grains", run.base_grains},
          {"wall_seconds", run.wall_seconds},
          {"startup_wall_seconds", run.startup_wall_seconds},
          {"largest_overlap", run.largest_overlap},
          {"deep_overlap_share", run.deep_overlap_share},
          {"energy_residual", run.energy_residual},
          {"coordination", run.coordination}};
}

json to_json(const RunComparison& run) {
  return {{"name", run.data.name},
          {"kind", calibration::name(run.kind)},
          {"conditions", to_json(run.data.conditions)},
          {"window", to_json(run.data.window)},
          {"dem", to_json(run.data.summary)},
          {"error", to_json(run.error)},
          {"naive_error", to_json(run.naive_error)},
          {"naive_source", run.naive_source},
          {"answer", to_json(run.steady.answer)},
          {"point", to_json(run.point)},
          {"bagnold", to_json(run.own_bagnold)},
          {"bagnold_error", to_json(run.own_bagnold_error)},
          {"foreign_bagnold_error", to_json(run.foreign_bagnold_error)},
          {"foreign_bagnold_source", run.foreign_bagnold_source},
          {"transient", to_json(run.transient)},
          {"in_time", in_time_json(run)},
          {"steady_against_transient", run.steady_against_transient},
          {"predict_seconds", run.predict_seconds},
          {"measured_rows", to_json(run.data.rows)},
          {"predicted", to_json(run.steady.profile)}};
}

/// Ends of the search, 0 and infinity, are 0 and null.
json to_json(const continuum::CertifiedConfinement& at) {
  return {{"softness", at.softness},
          {"bond_number", at.bond_number},
          {"well_posed_inertial_numbers", to_json(at.intervals)}};
}

json to_json(const TimeErrorPoint& point) {
  return {{"averaging_time", point.averaging_time},
          {"dem_wall_seconds", point.dem_wall_seconds},
          {"mu0", to_json(point.mu0)},
          {"law_error", point.law_error},
          {"law_standard_error", point.law_standard_error},
          {"profile_error", point.profile_error},
          {"profile_standard_error", point.profile_standard_error},
          {"failure", point.failure}};
}

json to_json(const StageCost& cost) {
  const json cpu = cost.cpu_seconds > 0.0 ? json(cost.cpu_seconds) : json();
  return {{"stage", cost.stage}, {"wall_seconds", cost.wall_seconds}, {"cpu_seconds", cpu}};
}

json to_json(const Coefficient& coefficient) {
  return {{"name", coefficient.name},
          {"value", coefficient.estimate.value},
          {"error", coefficient.estimate.error}};
}

json to_json(const continuum::Covariance& covariance) {
  return {{"names", covariance.names}, {"matrix", covariance.matrix}};
}

json to_json(const continuum::EffectiveBase& base) {
  return {{"no_slip_height", base.no_slip_height},
          {"mass_below", base.mass_below},
          {"recipe", base.recipe}};
}

json to_json(const continuum::RheologyTable& table) {
  const bool bagnold = std::holds_alternative<continuum::GeneralisedBagnold>(table.law);
  return {{"closure", bagnold ? "generalised bagnold" : "mu(I), phi(I)"},
          {"units", table.units},
          {"contact_friction", table.contact_friction},
          {"coefficients", to_json(coefficients(table))},
          {"covariance", to_json(table.covariance)},
          {"base", to_json(table.base)},
          {"range",
           {{"inertial_number", to_json(table.range.inertial_number)},
            {"softness", to_json(table.range.softness)},
            {"bond_number", to_json(table.range.bond_number)}}},
          {"source", table.provenance.source},
          {"data", table.provenance.data},
          {"checked_against", table.provenance.checked_against}};
}

json to_json(const calibration::MuPhiFit& fit) {
  return {{"friction", to_json(fit.friction)},
          {"volume_fraction", to_json(fit.volume_fraction)},
          {"points", to_json(fit.points)}};
}

json to_json(const SeedScatter& one) {
  return {{"condition", one.condition},
          {"quantity", one.quantity},
          {"seeds", one.seeds},
          {"mean", to_json(one.mean)},
          {"scatter", one.scatter},
          {"expected_scatter", one.expected_scatter()}};
}

json head_json(const ReportHead& report) {
  return {{"title", report.title},
          {"command", report.command},
          {"machine", report.machine},
          {"warnings", report.warnings},
          {"costs", to_json(report.costs)}};
}

/// Names come from files: bytes that are no UTF-8 are replaced rather than refused.
std::string text_of(const json& document) {
  return document.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string report_json(const Report& report) {
  json document = head_json(report);
  document.update({{"table", to_json(report.table)},
                   {"certificate", to_json(continuum::well_posedness_map(report.table))},
                   {"fit", to_json(report.fit)},
                   {"runs", to_json(report.runs)},
                   {"flows", flows_json(report)},
                   {"scores", scores_json(report)},
                   {"error_against_time", to_json(report.error_against_time)}});
  if (!report.seeds.empty()) document["seeds"] = to_json(report.seeds);
  if (report.budget) document["budget"] = budget_json(*report.budget);
  if (report.material) document["material"] = material_json(*report.material);
  if (report.contact_friction) {
    document["contact_friction"] = contact_friction_json(*report.contact_friction);
  }
  return text_of(document);
}

std::string report_json(const SeriesReport& report) {
  json document = head_json(report);
  document["series"] = series_json(report);
  return text_of(document);
}

}  // namespace grainlaw::report
