#include "apps/report/report_json.h"

#include <nlohmann/json.hpp>

#include "apps/report/flow_json.h"
#include "apps/report/in_time_json.h"
#include "apps/report/law_curve.h"
#include "apps/report/material_json.h"
#include "continuum/well_posedness.h"

namespace grainlaw::report {
namespace {

using json = nlohmann::ordered_json;

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
json to_json(const BudgetRound&);
json to_json(const BudgetReport&);
json to_json(const StageCost&);
json to_json(const Coefficient&);
json to_json(const continuum::Covariance&);
json to_json(const continuum::EffectiveBase&);
json to_json(const continuum::RheologyTable&);
json to_json(const calibration::MuPhiFit&);
json to_json(const calibration::ContactPoint&);
json to_json(const calibration::RatioLaw&);
json to_json(const calibration::StiffnessLaws&);
json to_json(const calibration::RankCorrelation&);
json to_json(const calibration::CohesivePoint&);
json to_json(const calibration::PooledCohesion&);
json to_json(const calibration::CohesionSeries&);
json to_json(const SeriesReport&);

json to_json(const dem::Estimate& estimate) {
  return {{"value", estimate.value}, {"error", estimate.error}};
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
  return {{"name", coefficient.name},
          {"value", coefficient.value},
          {"error", coefficient.error},
          {"at_bound", coefficient.at_bound},
          {"identifiable", coefficient.identifiable}};
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
  return {{"stage", cost.stage},
          {"wall_seconds", cost.wall_seconds},
          {"cpu_seconds", cost.cpu_seconds}};
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

json to_json(const calibration::ContactPoint& point) {
  return {{"name", point.name},
          {"series", point.series},
          {"stiffness", point.stiffness},
          {"attraction", point.attraction},
          {"shear_rate", point.shear_rate},
          {"Xi", to_json(std::vector(point.ratio.begin(), point.ratio.end()))},
          {"Xi_of_law", point.ratio_of_law ? json(*point.ratio_of_law) : json(nullptr)},
          {"scaled_mean", to_json(point.mean)},
          {"scaled_mode", to_json(point.mode)},
          {"scaled_long_lifetime", to_json(point.long_lifetime)},
          {"collision_rate", to_json(point.collision_rate)},
          {"coordination", to_json(point.coordination)},
          {"contacts", point.contacts},
          {"tail_sampled", point.tail_sampled}};
}

json to_json(const calibration::RatioLaw& law) {
  return {{"factor", to_json(law.factor)},
          {"rate", to_json(law.rate)},
          {"left_out", law.summary.left_out}};
}

json to_json(const calibration::StiffnessLaws& laws) {
  return {{"series", laws.series},
          {"Xi", to_json(std::vector(laws.ratio.begin(), laws.ratio.end()))},
          {"collision_rate", to_json(laws.collision_rate)},
          {"mean_lifetime", to_json(laws.mean_lifetime)}};
}

json to_json(const calibration::RankCorrelation& correlation) {
  return {{"with", correlation.with}, {"value", correlation.value}, {"runs", correlation.runs}};
}

json to_json(const calibration::CohesivePoint& point) {
  const auto& plug = point.plug;
  return {{"name", point.name},
          {"series", point.series},
          {"attraction", point.attraction},
          {"inclination", point.inclination},
          {"layer_height", point.layer_height},
          {"flowing_height", point.flowing_height()},
          {"plug_thickness", plug ? json(plug->thickness) : json(nullptr)},
          {"tau_c_weight", plug ? to_json(plug->yield_stress_from_weight) : json(nullptr)},
          {"tau_c_pairs", to_json(point.yield_stress)},
          {"tau_c_at_bound", point.at_bound},
          {"c0", to_json(point.cohesion)}};
}

json to_json(const calibration::PooledCohesion& one) {
  return {{"attraction", one.attraction},
          {"c0", to_json(one.cohesion)},
          {"tilts", one.tilts},
          {"chance", one.chance}};
}

json to_json(const calibration::CohesionSeries& cohesion) {
  return {{"mu0", to_json(cohesion.mu0)},
          {"points", to_json(cohesion.points)},
          {"pooled", to_json(cohesion.pooled)},
          {"left_out", cohesion.left_out}};
}

json to_json(const SeriesReport& series) {
  const calibration::ContactSeries& contacts = series.contacts;
  return {{"points", to_json(contacts.points)},
          {"stiffness", to_json(contacts.stiffness)},
          {"lifetime_law", to_json(contacts.lifetime_law)},
          {"rank_correlations", to_json(contacts.correlations)},
          {"left_out", contacts.left_out},
          {"cohesion", to_json(series.cohesion)},
          {"law", series.law_name}};
}

json to_json(const SeedScatter& one) {
  return {{"condition", one.condition},
          {"quantity", one.quantity},
          {"seeds", one.seeds},
          {"mean", to_json(one.mean)},
          {"scatter", one.scatter},
          {"expected_scatter", one.expected_scatter()}};
}

json to_json(const BudgetRound& round) {
  return {{"runs", round.runs},
          {"wall_seconds", round.wall_seconds},
          {"cpu_seconds", round.cpu_seconds},
          {"surface_velocity", to_json(round.surface_velocity)},
          {"reached", round.reached},
          {"failure", round.failure}};
}

json to_json(const BudgetReport& budget) {
  return {{"seconds", budget.seconds},
          {"spent_seconds", budget.spent_seconds},
          {"processes", budget.processes},
          {"targets", budget.targets},
          {"rounds", to_json(budget.rounds)},
          {"notes", budget.notes}};
}

}  // namespace

std::string report_json(const Report& report) {
  json document = {{"title", report.title},
                   {"command", report.command},
                   {"machine", report.machine},
                   {"warnings", report.warnings},
                   {"table", nullptr},
                   {"certificate", nullptr},
                   {"fit", to_json(report.fit)},
                   {"runs", to_json(report.runs)},
                   {"flows", flows_json(report)},
                   {"scores", scores_json(report)},
                   {"error_against_time", to_json(report.error_against_time)},
                   {"costs", to_json(report.costs)}};
  if (!report.seeds.empty()) document["seeds"] = to_json(report.seeds);
  if (report.budget) document["budget"] = to_json(*report.budget);
  if (report.series) {
    document["series"] = to_json(*report.series);
  } else {  // a law was given or fitted
    document["table"] = to_json(report.table);
    document["certificate"] = to_json(continuum::well_posedness_map(report.table));
  }
  if (report.material) document["material"] = material_json(*report.material);
  if (report.contact_friction) {
    document["contact_friction"] = contact_friction_json(*report.contact_friction);
  }
  // Names come from files: bytes that are no UTF-8 are replaced rather than refused.
  return document.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace grainlaw::report
