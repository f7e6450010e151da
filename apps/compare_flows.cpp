#include "apps/compare_flows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/compare_cases.h"
#include "calibration/box_points.h"
#include "calibration/fit_summary.h"
#include "continuum/band_error.h"

namespace grainlaw {
namespace {

using calibration::SampleKind;
using calibration::StateComparison;
using calibration::StatePoint;
using continuum::RheologyTable;

/// Flow of the data of a table; one with a no-slip height was measured on a chute.
std::string geometry_of(const RheologyTable& table) {
  if (!table.provenance.geometry.empty() || !table.base) return table.provenance.geometry;
  return dem::ChuteConditions{}.geometry;
}

bool inside_range(const std::vector<StateComparison>& states) {
  return std::ranges::all_of(states, [](const auto& state) { return state.out_of_domain.empty(); });
}

SampleKind kind_of(const io::RunRecord& record,
                   const RheologyTable& table,
                   const std::vector<StateComparison>& states) {
  if (was_fitted(table, record)) return SampleKind::in_sample;
  const std::string geometry = geometry_of(table);
  if (geometry.empty()) return SampleKind::independent;
  if (geometry != record.data.conditions.geometry) return SampleKind::cross_geometry;
  return inside_range(states) ? SampleKind::interpolation : SampleKind::extrapolation;
}

std::vector<StatePoint> states_of(const dem::LocalData& data,
                                  const std::optional<calibration::RingBand>& ring) {
  if (!data.window.steady) return {};
  std::vector<StatePoint> states;
  if (is_band(data) && !data.rows.empty()) {
    states = calibration::profile_points(data).points;
  } else if (ring) {
    for (const calibration::RingBandRow& row : ring->rows) {
      states.push_back(row.state);
      states.back().name =
          fmt::format("{} at {:.3g} d", data.name, row.z / data.conditions.grain_diameter);
    }
  } else if (!data.rows.empty()) {
    states.push_back(calibration::state_of(data.rows.front(), data.conditions, data.name));
  }
  return states;
}

std::vector<StateComparison> compare_states(const std::vector<StatePoint>& points,
                                            const RheologyTable& table) {
  std::vector<StateComparison> states;
  for (const StatePoint& point : points) {
    states.push_back(calibration::compare_state(point, table));
  }
  return states;
}

void note(std::vector<std::string>& notes, const std::string& sentence) {
  if (std::ranges::find(notes, sentence) == notes.end()) notes.push_back(sentence);
}

report::BandPrediction predict_band(const dem::LocalData& data,
                                    const continuum::ShearBandCase& band,
                                    const RheologyTable& table,
                                    std::vector<std::string>& notes) {
  report::BandPrediction result{.band = continuum::shear_band(table, band), .comparison = {}};
  continuum::add_error(result.band, table, band);
  continuum::add_velocity_band(result.band, table, band);
  if (!data.window.steady || result.band.profile.rows.empty()) return result;
  try {
    result.comparison = calibration::compare_band(data, band, result.band);
  } catch (const calibration::FitError& error) {
    note(notes, error.what());
  }
  return result;
}

report::RingPrediction predict_ring(const dem::LocalData& data,
                                    const continuum::RingFlowCase& ring,
                                    const calibration::RingBand& measured,
                                    const RheologyTable& table,
                                    std::vector<std::string>& notes) {
  report::RingPrediction result{.flow = continuum::ring_flow(table, ring), .comparison = {}};
  if (!data.window.steady) return result;
  try {
    result.comparison = calibration::compare_ring(measured, result.flow, table, ring);
  } catch (const calibration::FitError& error) {
    note(notes, data.name + ": " + error.what());
  }
  return result;
}

void note_grains(report::FlowComparison& flow, const ComparedTable& compared) {
  const double own = flow.data.conditions.contact_friction;
  const double law = compared.table.contact_friction;
  if (own == law) return;
  note(flow.notes,
       fmt::format("{}: contact friction {} of the grains, {} of {}: the law is not that of these "
                   "grains",
                   flow.data.name,
                   own,
                   law,
                   compared.name));
}

std::optional<calibration::RingBand> find_ring(const dem::Scene& scene,
                                               const dem::LocalData& data,
                                               std::vector<std::string>& notes) {
  if (!data.ring) return std::nullopt;
  try {
    calibration::RingBand ring =
        calibration::ring_band(*data.ring, ring_cell(scene), data.conditions);
    for (const std::string& sentence : ring.notes) note(notes, data.name + ": " + sentence);
    return ring;
  } catch (const calibration::FitError& error) {
    note(notes, data.name + ": " + error.what());
    return std::nullopt;
  }
}

report::FlowPrediction predict(const io::RunRecord& record,
                               const dem::Scene& scene,
                               const RheologyTable& table,
                               const std::optional<report::NonlocalAmplitude>& nonlocal,
                               report::FlowComparison& flow) {
  report::FlowPrediction result;
  result.states = compare_states(states_of(record.data, flow.ring), table);
  result.kind = kind_of(record, table, result.states);
  if (is_band(record.data)) {
    continuum::ShearBandCase band = band_case(scene, record.data);
    result.local = predict_band(record.data, band, table, flow.notes);
    if (nonlocal) {
      band.nonlocal_amplitude = nonlocal->value;
      result.nonlocal = predict_band(record.data, band, table, flow.notes);
    }
  }
  if (flow.ring) {
    continuum::RingFlowCase ring = ring_flow_case(scene, record.data, *flow.ring);
    result.split_bottom = continuum::split_bottom(table, ring.cell);
    result.ring_local = predict_ring(record.data, ring, *flow.ring, table, flow.notes);
    if (nonlocal) {
      ring.nonlocal_amplitude = nonlocal->value;
      result.ring_nonlocal = predict_ring(record.data, ring, *flow.ring, table, flow.notes);
    }
  }
  return result;
}

calibration::NonlocalFit fit_to_band(const io::RunRecord& record, const RheologyTable& table) {
  continuum::ShearBandCase band = band_case(scene_of(record), record.data);
  band.nonlocal_amplitude = 0.5;  // where the fit starts too: for the height of the layer alone
  const continuum::ShearBand first = continuum::shear_band(table, band);
  if (first.profile.rows.empty())
    throw calibration::FitError(record.data.name + ": no amplitude can be fitted, " +
                                first.answer.text);
  const auto points = calibration::band_points(record.data, band, first.profile.height);
  if (points.size() < 4)
    throw calibration::FitError(
        fmt::format("--fit-nonlocal: {} has {} rows off the walls and twice the kernel apart, 4 "
                    "are needed: name "
                    "a thicker layer first",
                    record.data.name,
                    points.size()));
  return calibration::fit_nonlocal_amplitude(table, band, points);
}

calibration::NonlocalFit fit_to_ring(const io::RunRecord& record, const RheologyTable& table) {
  const dem::Scene scene = scene_of(record);
  const calibration::RingBand measured =
      calibration::ring_band(*record.data.ring, ring_cell(scene), record.data.conditions);
  return calibration::fit_nonlocal_amplitude(
      table, ring_flow_case(scene, record.data, measured), measured);
}

}  // namespace

bool was_fitted(const RheologyTable& table, const io::RunRecord& record) {
  const continuum::Provenance& provenance = table.provenance;
  const bool stated = !provenance.digests.empty();
  const auto& list = stated ? provenance.digests : provenance.data;
  return std::ranges::find(list, stated ? io::digest(record) : record.data.name) != list.end();
}

bool is_band(const dem::LocalData& data) {
  const std::string& geometry = data.conditions.geometry;
  return geometry == "plane_shear" || geometry == "body_force_box";
}

bool has_nonlocal_flow(const dem::LocalData& data) {
  return is_band(data) || data.ring;
}

report::NonlocalAmplitude fit_nonlocal(const io::RunRecord& record, const RheologyTable& table) {
  if (!record.data.window.steady)
    throw calibration::FitError(
        fmt::format("--fit-nonlocal: {} is not steady ({}): name another band "
                    "first",
                    record.data.name,
                    record.data.window.reason));
  const calibration::NonlocalFit fit =
      record.data.ring ? fit_to_ring(record, table) : fit_to_band(record, table);
  return {.value = fit.amplitude,
          .error = fit.error,
          .run = record.data.name,
          .local_chi_squared = fit.local_chi_squared,
          .chi_squared = fit.summary.chi_squared,
          .points = fit.points};
}

report::FlowComparison compare_flow(const io::RunRecord& record,
                                    std::span<const ComparedTable> tables,
                                    const std::optional<report::NonlocalAmplitude>& nonlocal) {
  const dem::Scene scene = scene_of(record);
  report::FlowComparison flow{.data = record.data, .ring = {}, .tables = {}, .notes = {}};
  if (!record.data.window.steady)
    note(flow.notes,
         record.data.name + " is not steady and is not scored: " + record.data.window.reason);
  flow.ring = find_ring(scene, record.data, flow.notes);
  if (record.data.ring) flow.split_radius = ring_cell(scene).split_radius;
  for (const ComparedTable& compared : tables) {
    note_grains(flow, compared);
    flow.tables.push_back(predict(record, scene, compared.table, nonlocal, flow));
  }
  return flow;
}

}  // namespace grainlaw
