#include "apps/report/flow_json.h"

#include "apps/report/json_parts.h"

namespace grainlaw::report {
namespace {

json flags(const std::vector<continuum::RangeFlag>& all) {
  json result = json::array();
  for (const continuum::RangeFlag& flag : all) {
    result.push_back({{"quantity", flag.quantity},
                      {"range", {flag.lower, flag.upper}},
                      {"reached", {flag.reached_lowest, flag.reached_highest}},
                      {"fraction_outside", flag.fraction_outside}});
  }
  return result;
}

json residual(const dem::Estimate& measured, const calibration::LawResidual& r) {
  return {{"measured", estimate_json(measured)},
          {"law", estimate_json(r.law)},
          {"difference", r.difference},
          {"statistics", r.statistics},
          {"law_error", r.law_error},
          {"in_standard_errors", r.in_standard_errors}};
}

json states(const std::vector<calibration::StateComparison>& all) {
  json result = json::array();
  for (const calibration::StateComparison& state : all) {
    result.push_back(
        {{"name", state.point.name},
         {"inertial_number", estimate_json(state.point.inertial_number)},
         {"softness", estimate_json(state.point.softness)},
         {"bond_number", estimate_json(state.point.bond_number)},
         {"friction", residual(state.point.friction, state.friction)},
         {"volume_fraction", residual(state.point.volume_fraction, state.volume_fraction)},
         {"condition_number", state.condition_number},
         {"out_of_domain", flags(state.out_of_domain)}});
  }
  return result;
}

json budget(const calibration::ErrorBudget& part) {
  return {{"total", part.total},
          {"statistics", part.statistics},
          {"law", part.law},
          {"geometry", part.geometry},
          {"numerics", part.numerics},
          {"rest", part.rest()}};
}

json comparison(const calibration::BandComparison& c) {
  return {{"velocity", estimate_json(c.profile.velocity)},
          {"velocity_maximum", estimate_json(c.profile.velocity_maximum)},
          {"volume_fraction", estimate_json(c.profile.volume_fraction)},
          {"friction", estimate_json(c.profile.friction)},
          {"in_standard_errors", c.profile.in_standard_errors},
          {"width", estimate_json(c.width)},
          {"drive", estimate_json(c.drive)},
          {"drive_difference", estimate_json(c.drive_difference)},
          {"height", c.height},
          {"no_slip_heights", c.no_slip ? json{c.no_slip->lower, c.no_slip->upper} : json()},
          {"budget", budget(c.budget)}};
}

json profile(const continuum::Profile& predicted) {
  json rows = json::array();
  for (const continuum::ProfileRow& row : predicted.rows) {
    rows.push_back({{"z", row.z},
                    {"velocity", row.velocity},
                    {"shear_stress", row.shear_stress},
                    {"pressure", row.pressure},
                    {"volume_fraction", row.volume_fraction}});
  }
  return rows;
}

json band(const std::optional<BandPrediction>& prediction) {
  if (!prediction) return nullptr;
  const continuum::ShearBand& b = prediction->band;
  return {{"outcome", continuum::name(b.answer.outcome)},
          {"text", b.answer.text},
          {"condition_number", b.answer.condition_number},
          {"out_of_domain", flags(b.answer.out_of_domain)},
          {"driving_stress", b.driving_stress},
          {"driving_velocity", b.driving_velocity},
          {"sought_error", b.error},
          {"yielded_width", b.yielded_width},
          {"band_width", b.band_width},
          {"local_band_collapse", b.local_band_collapse},
          {"discretisation_error", b.discretisation_error},
          {"wall_seconds", b.wall_seconds},
          {"comparison", prediction->comparison ? comparison(*prediction->comparison) : json()},
          {"profile", profile(b.profile)}};
}

json split(const std::optional<continuum::SplitBottom>& cell) {
  if (!cell) return nullptr;
  return {{"outcome", continuum::name(cell->answer.outcome)},
          {"text", cell->answer.text},
          {"path_radius", cell->path_radius},
          {"experimental_radius", cell->measured_radius},
          {"surface_width", cell->surface_width}};
}

json ring(const std::optional<calibration::RingBand>& found) {
  if (!found) return nullptr;
  json rows = json::array();
  for (const calibration::RingBandRow& row : found->rows) {
    rows.push_back({{"z", row.z},
                    {"centre", estimate_json(row.centre)},
                    {"width", estimate_json(row.width)},
                    {"chi_squared", row.chi_squared},
                    {"cells", row.shares.size()},
                    {"shear_rate", row.shear_rate},
                    {"fitted_shear_rate", row.fitted_shear_rate}});
  }
  return {{"height", found->height}, {"rows", rows}};
}

json ring_prediction(const std::optional<RingPrediction>& prediction) {
  if (!prediction) return nullptr;
  const continuum::RingFlow& flow = prediction->flow;
  json result = {{"outcome", continuum::name(flow.answer.outcome)},
                 {"text", flow.answer.text},
                 {"out_of_domain", flags(flow.answer.out_of_domain)},
                 {"torque", flow.torque},
                 {"local_band_collapse", flow.local_band_collapse},
                 {"discretisation_error", flow.discretisation_error},
                 {"wall_seconds", flow.wall_seconds},
                 {"comparison", nullptr}};
  if (!prediction->comparison) return result;
  const calibration::RingComparison& c = *prediction->comparison;
  json rows = json::array();
  for (const calibration::BandShape& row : c.rows)
    rows.push_back({{"centre", row.centre}, {"width", row.width}});
  result["comparison"] = {{"velocity", estimate_json(c.velocity)},
                          {"velocity_maximum", estimate_json(c.velocity_maximum)},
                          {"in_standard_errors", c.in_standard_errors},
                          {"budget", budget(c.budget)},
                          {"rows", rows}};
  return result;
}

json measured_rows(const dem::LocalData& data) {
  json rows = json::array();
  for (const dem::LocalRow& row : data.rows) {
    rows.push_back({{"z", row.z},
                    {"velocity", estimate_json(row.velocity)},
                    {"volume_fraction", estimate_json(row.volume_fraction)},
                    {"friction", estimate_json(row.friction)},
                    {"inertial_number", estimate_json(row.inertial_number)},
                    {"normal_stress", estimate_json(row.normal_stress)}});
  }
  return rows;
}

json score(const Score& s) {
  return {{"run", s.run},
          {"flow", s.flow},
          {"quantity", s.quantity},
          {"kind", calibration::name(s.kind)},
          {"difference", estimate_json(s.difference)},
          {"in_standard_errors", s.in_standard_errors},
          {"condition_number", s.condition_number},
          {"budget", s.budget ? budget(*s.budget) : json()},
          {"remark", s.remark}};
}

}  // namespace

json flows_json(const Report& report) {
  json result = json::array();
  for (const FlowComparison& flow : report.flows) {
    json tables = json::array();
    for (std::size_t t = 0; t < flow.tables.size(); ++t) {
      const FlowPrediction& prediction = flow.tables[t];
      tables.push_back({{"table", report.tables.at(t).name},
                        {"kind", calibration::name(prediction.kind)},
                        {"states", states(prediction.states)},
                        {"local", band(prediction.local)},
                        {"nonlocal", band(prediction.nonlocal)},
                        {"split_bottom", split(prediction.split_bottom)},
                        {"ring_local", ring_prediction(prediction.ring_local)},
                        {"ring_nonlocal", ring_prediction(prediction.ring_nonlocal)}});
    }
    result.push_back({{"name", flow.data.name},
                      {"geometry", flow.data.conditions.geometry},
                      {"steady", flow.data.window.steady},
                      {"reason", flow.data.window.reason},
                      {"measured_rows", measured_rows(flow.data)},
                      {"ring", ring(flow.ring)},
                      {"tables", tables},
                      {"notes", flow.notes}});
  }
  return result;
}

json scores_json(const Report& report) {
  json result = json::array();
  for (const TableScores& table : report.tables) {
    json scores = json::array();
    for (const Score& s : table.scores) scores.push_back(score(s));
    result.push_back({{"table", table.name}, {"scores", scores}});
  }
  return result;
}

}  // namespace grainlaw::report
